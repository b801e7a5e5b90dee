"""Newmark family of integrators."""
