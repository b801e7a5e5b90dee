"""Loads on structures."""
