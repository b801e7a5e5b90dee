"""Runge–Kutta methods, explicit and implicit."""
