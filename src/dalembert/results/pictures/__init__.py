"""Drawings, plots and films of results."""
