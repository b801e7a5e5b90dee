"""Optimisation methods, one per file; ``registry`` lists them."""
