"""Batches: many designs of one model in one call."""
