"""Gaps of rounded convex hulls."""
