"""Meshes: readers and generators."""
