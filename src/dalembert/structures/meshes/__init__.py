"""Meshes, read and made."""
