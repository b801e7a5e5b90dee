"""Reasons why a page cannot repeat an analysis of a mechanism, common to all analyses."""

from __future__ import annotations

from typing import Any

from dalembert.analysis.times import follow_parameters
from dalembert.elements.blocks.sampled import Sampled
from dalembert.model.graph.model import Model


def common_obstacle(analysis: Any, model: Model) -> str:
    """The reason; empty if there is none."""
    if follow_parameters(analysis):
        return "times of the analysis follow parameters"
    if model.parts.space.computed:
        return "shapes of flexible bodies are computed by finite elements"
    if any(block.python_law is not None for block in _sampled(model)):
        return "a block calls a Python function"
    return ""


def march_obstacle(analysis: Any, model: Model) -> str:
    """The reason for analyses that start at the initial state; empty if there is none."""
    if reason := common_obstacle(analysis, model):
        return reason
    if model.closure.recipe.states.steady:
        return "states of first order start at steady values"
    return "blocks are sampled" if _sampled(model) else ""


def _sampled(model: Model) -> list[Sampled]:
    return [e for e in model.parts.elements.values() if isinstance(e, Sampled)]
