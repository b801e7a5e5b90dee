"""Responses, load cases and design tasks of model files."""
