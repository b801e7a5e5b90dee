"""Measures named in a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dalembert.results.mechanism_modes import Modes
from dalembert.results.structural.buckling_modes import BucklingModes
from dalembert.results.structural.vibration_modes import VibrationModes
from dalembert.symbolic.formulas.expression import Expression

MODES: dict[str, Any] = {
    "Linearization": Modes,
    "Modal": VibrationModes,
    "Buckling": BucklingModes,
}
"""Analysis → its modes, which have measures of their own."""


def measure_reader(document: Any) -> Callable[[Any, str], Expression]:
    """The function ``(model, text) → measure`` for the analysis of a document."""
    kind = document.analysis.type if document.analysis is not None else None
    if kind in MODES:
        return MODES[kind].formula
    return lambda model, text: model.expression(text)
