"""All gaps of a model."""

from __future__ import annotations

from dalembert.analysis.nonsmooth.collision_gaps import CollisionGaps
from dalembert.analysis.nonsmooth.gap_source import FormulaGaps, GapSource
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.unilateral import Unilateral
from dalembert.model.model import Model
from dalembert.symbolic.once import once


@once
def gap_sources(model: Model) -> list[GapSource]:
    """Where gaps of a model come from."""
    elements = list(model.parts.elements.values())
    stated = [e for e in elements if isinstance(e, Unilateral) and e.impact() is not None]
    sources: list[GapSource] = [FormulaGaps(model, stated)] if stated else []
    return [*sources, *collision_gaps(model)]


@once
def collision_gaps(model: Model) -> list[CollisionGaps]:
    """Those of its balls and walls."""
    elements = model.parts.elements.values()
    return [CollisionGaps(model, e) for e in elements if isinstance(e, Collisions)]
