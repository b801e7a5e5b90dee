"""Finite elements and the expression graphs of their energies."""
