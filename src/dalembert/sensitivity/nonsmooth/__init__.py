"""Gradients of nonsmooth time stepping."""
