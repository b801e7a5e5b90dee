"""Checks of runs with contacts, and their warnings."""
