"""Gradients through time: the steps that were taken, forwards and backwards."""
