"""Multi-objective optimisation: Pareto fronts."""
