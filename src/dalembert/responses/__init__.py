"""Responses: scalars computed from a result by a measure and a reduction over time."""
