"""Decisions out of gradients."""
