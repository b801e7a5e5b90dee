"""Decisions out of gradients."""

from dalembert.design.optimization import Iterate, Limit, Optimum, optimize

__all__ = ["Iterate", "Limit", "Optimum", "optimize"]
