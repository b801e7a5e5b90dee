"""Inputs of structures: load cases, declared inputs and other parameters."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.frequency.requested import requested_names
from dalembert.errors import AnalysisError
from dalembert.model.assembled.model import StructuralModel
from dalembert.text.wording import unknown


def structural_inputs(model: StructuralModel, inputs: Any, verb: str) -> list[str]:
    """Names of inputs: declared inputs and load cases, by default all of them.

    Raises
    ------
    AnalysisError
        Neither a load case nor a parameter, or no inputs at all.
    """
    named = [name for name in model.loads if name]
    known = [*model.inputs, *named, *model.parameters]
    if inputs is None:
        names = [*model.inputs, *named] or [""]
    else:
        names = requested_names(inputs, verb)
    for name in names:
        if name not in model.loads and name not in model.parameters:
            raise AnalysisError(f"{verb}: {unknown('input', name, known)}")
    if names == [""] and not np.any(model.loads[""].values(model.nominal)):
        raise AnalysisError(
            f"{verb}: no inputs; add loads, or declare inputs by structure.input(name, unit=…)"
        )
    return names
