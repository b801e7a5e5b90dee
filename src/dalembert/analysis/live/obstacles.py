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
    if model.closure.recipe.states.steady:
        return "states of first order start at steady values"
    if any(isinstance(element, Sampled) for element in model.parts.elements.values()):
        return "blocks are sampled"
    return ""
