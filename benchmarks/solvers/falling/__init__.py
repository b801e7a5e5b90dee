"""Solvers of falling bodies, one per file."""
