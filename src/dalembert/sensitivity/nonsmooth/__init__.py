"""Gradients of motions with many impacts."""
