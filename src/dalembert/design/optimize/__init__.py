"""Optimisation: a problem, its scaled form, its end."""
