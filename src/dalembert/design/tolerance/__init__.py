"""Tolerance analysis and allocation."""
