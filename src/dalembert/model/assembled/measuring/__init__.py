"""Measures of structures."""
