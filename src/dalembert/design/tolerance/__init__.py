"""Tolerances of drawings."""
