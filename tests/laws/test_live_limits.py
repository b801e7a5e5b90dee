"""A page refuses values outside the limits of quantities with the message of Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from live_modules import Modules
from registry import CASES
from spatial_registry import SPATIAL_CASES, any_model_of
from structure_models import MODELS, model_of

import dalembert as da

FACTORS = (1.0, -1.0, 0.0, 1e150)
"""Values of each parameter, relative to its own."""


def cases_of(name: str, model: Any) -> list[tuple[str, list[dict], np.ndarray, str]]:
    """Label, limits, numbers, and message of Python or "" for changes of single parameters."""
    p, limits = model.value_limits()
    if not limits:
        return []
    values = ca.Function("values", [p], [ca.densify(ca.vertcat(*(x.graph for x in limits)))])
    rows, nominal = [limit.data() for limit in limits], model.values(None)
    cases = []
    for k, parameter in enumerate(model.parameters):
        for factor in FACTORS:
            changed = nominal.copy()
            changed[k] *= factor
            try:
                model.check_values(changed)
                message = ""
            except da.DalembertError as error:
                message = str(error)
            numbers = values(changed).full().ravel()
            cases.append((f"{name}, {factor:g} {parameter}", rows, numbers, message))
    return cases


@pytest.mark.parametrize("every", [6, pytest.param(1, marks=pytest.mark.thorough)])
def test_messages_equal_those_of_python(every: int, tmp_path: Path) -> None:
    mechanisms, structures = [*CASES, *SPATIAL_CASES][::every], [*MODELS][::every]
    cases = [case for name in mechanisms for case in cases_of(name, any_model_of(name))]
    cases += [case for name in structures for case in cases_of(name, model_of(name))]
    modules = Modules(tmp_path)
    modules.limits = [[rows, numbers] for _, rows, numbers, _ in cases]
    modules.run()
    for (label, _, _, expected), message in zip(cases, modules.messages, strict=True):
        assert message == expected, label
    refused = [message for *_, message in cases if message]
    for part in ("must be above 0", "must not be negative", "out of range"):
        assert any(part in message for message in refused), part
