"""Backward differentiation with steps and orders that vary."""
