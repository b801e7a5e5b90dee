"""Sparse linear systems and eigenvalue utilities."""
