"""Synthesis: from what shall be done to the mechanism that does it."""
