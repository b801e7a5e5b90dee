"""Gradients of what structures do."""
