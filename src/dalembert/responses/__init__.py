"""Responses: numbers drawn from a motion, each by one measure and one reduction."""
