"""Gradients of responses: finite differences, direct differentiation, adjoint."""
