"""Sparse linear systems: the one place that factors sparse matrices."""
