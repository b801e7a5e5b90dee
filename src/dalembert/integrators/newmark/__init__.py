"""Newmark's method and its relatives."""
