"""Optimisation: design problem, scaled program, verified optimum."""
