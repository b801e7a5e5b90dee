"""Evaluation of many equal elements, and assembly of their sums."""
