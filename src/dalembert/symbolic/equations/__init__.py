"""Implicit functions, Newton's method and factorisations."""
