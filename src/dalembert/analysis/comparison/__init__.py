"""Comparison of formulations and integrators on one mechanism."""
