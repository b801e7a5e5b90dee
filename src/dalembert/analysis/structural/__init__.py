"""Transients of structures."""
