"""Modes: linearisation about a state, vibration, buckling."""
