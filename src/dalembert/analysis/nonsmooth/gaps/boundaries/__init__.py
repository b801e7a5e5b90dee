"""Gaps of boundaries that may be concave."""
