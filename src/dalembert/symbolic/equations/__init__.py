"""Equations inside of the graph, and their solution."""
