"""Gradients of structural analyses."""
