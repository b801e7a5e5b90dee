"""Measures that a file names, as what the asked analysis can tell."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.errors import ModelError
from dalembert.io.structure_schema import StructureDocument
from dalembert.model.model import Model
from dalembert.results.mechanism_modes import mode_formula
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.buckling_modes import BucklingModes
from dalembert.results.structural.measured_states import MeasuredStates
from dalembert.results.structural.vibration_modes import VibrationModes
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.expression import Expression

MODES = {"Modal": VibrationModes, "Buckling": BucklingModes}
"""Analysis of a structure → its modes."""


def read_measure(model: Model, text: str) -> Expression:
    """A measure of a mechanism by its name, or a formula of measures.

    Raises
    ------
    ExpressionError
        Unknown names or a formula outside the grammar.
    """
    try:
        return model[text]
    except KeyError:
        return model.formula(text)


def measure_reader(document: Any) -> Callable[[Any, str], Expression]:
    """The function ``(model, text) → measure`` for the analysis of a document."""
    asked = document.analysis.type if document.analysis is not None else None
    if not isinstance(document, StructureDocument):
        return mode_formula if asked == "Linearization" else read_measure

    def read(model: StructuralModel, text: str) -> Expression:
        try:
            if asked not in MODES and model.measures.find(text) is not None:
                return model[text]
            return _states(model, asked).expression(text)
        except KeyError as error:
            raise ModelError(str(error.args[0])) from None

    return read


def _states(model: StructuralModel, asked: str | None) -> MeasuredStates:
    """No states, or no modes, of a structure: they know the measures all the same."""
    if asked not in MODES:
        states = MeasuredStates()
        states.model = model
        return states
    none, status = np.zeros(0), Status(Outcome.COMPLETED, "")
    shapes = np.zeros((len(model.degrees), 0))
    return MODES[asked](model, None, model.nominal, none, none, shapes, status, none)
