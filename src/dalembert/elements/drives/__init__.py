"""Drives and friction with states of first order: motors, cylinders, bristles."""
