"""Kinematics and inverse dynamics of driven mechanisms."""
