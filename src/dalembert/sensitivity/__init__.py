"""Gradients of responses: direct differentiation, adjoint method, finite differences."""
