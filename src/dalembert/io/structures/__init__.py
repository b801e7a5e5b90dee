"""Structures and their elements in files."""
