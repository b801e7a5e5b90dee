"""Assembled models: sums over many alike elements, with sparse factors."""
