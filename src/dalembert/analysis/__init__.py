"""Analyses: every verb of the package that solves something."""
