"""Analyses of mechanisms and structures."""
