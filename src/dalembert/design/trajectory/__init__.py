"""Trajectory optimisation: controls, motion and dimensions at once."""
