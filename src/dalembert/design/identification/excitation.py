"""D-optimal choice of further experiments."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.design.identification.information import Information
from dalembert.design.identification.misfit import Misfit
from dalembert.design.identification.unknowns import Unknowns
from dalembert.errors import AnalysisError


def advise(
    misfit: Misfit,
    before: Information,
    x: np.ndarray,
    factor: float,
    candidates: Mapping[str, Mapping[str, float]],
) -> list[dict[str, Any]]:
    """Rank candidate experiments; see ``Identification.advise``."""
    rows = []
    for name, parameters in candidates.items():
        jacobian = _candidate_jacobian(misfit, x, name, parameters)
        after = Information(before.labels, np.vstack([before.jacobian, jacobian]), before.sizes)
        deviation = np.sqrt(np.diag(after.covariance(factor)))
        rows.append(
            {
                "name": name,
                "gain": after.determinant() - before.determinant(),
                "deviation": dict(zip(before.labels, map(float, deviation), strict=True)),
            }
        )
    return sorted(rows, key=lambda row: -row["gain"])


def _candidate_jacobian(
    misfit: Misfit, x: np.ndarray, name: str, parameters: Mapping[str, float]
) -> np.ndarray:
    """(N, n) Jacobian of the first experiment repeated with other parameters."""
    first = misfit.observations[0]
    for parameter in parameters:
        if parameter in misfit.unknowns.where[0]:
            raise AnalysisError(
                f"candidate {name!r} sets {parameter!r}, which is unknown; leave it out"
            )
    all_parameters = {**first.experiment.parameters, **parameters}
    observation = replace(
        first, name=name, experiment=replace(first.experiment, parameters=all_parameters)
    )
    shared = misfit.unknowns
    unknowns = Unknowns(
        shared.labels, shared.start, shared.lower, shared.upper, shared.where[:1], shared.delays
    )
    single = Misfit(misfit.model, [observation], unknowns)
    single.noise = [misfit.noise[0]]
    return single.jacobian(x)
