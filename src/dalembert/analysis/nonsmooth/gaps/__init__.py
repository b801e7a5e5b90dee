"""Gaps of shapes that may touch."""
