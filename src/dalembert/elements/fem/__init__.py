"""Finite elements: what they are, and their energies as functions of the graph."""
