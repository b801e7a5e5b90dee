"""Which experiment would tell most about the unknowns: D-optimality."""

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
    """See ``Identification.advise``."""
    made = []
    for name, parameters in candidates.items():
        rows = _jacobian(misfit, x, name, parameters)
        after = Information(before.labels, np.vstack([before.jacobian, rows]), before.sizes)
        deviation = np.sqrt(np.diag(after.covariance(factor)))
        made.append(
            {
                "name": name,
                "gain": after.determinant() - before.determinant(),
                "deviation": dict(zip(before.labels, map(float, deviation), strict=True)),
            }
        )
    return sorted(made, key=lambda row: -row["gain"])


def _jacobian(
    misfit: Misfit, x: np.ndarray, name: str, parameters: Mapping[str, float]
) -> np.ndarray:
    """(N, n) of one more run of the first experiment with other parameters."""
    first = misfit.observations[0]
    for given in parameters:
        if given in misfit.unknowns.where[0]:
            raise AnalysisError(
                f"candidate {name!r} sets {given!r}, which is unknown; leave it out"
            )
    every = {**first.experiment.parameters, **parameters}
    again = replace(first, name=name, experiment=replace(first.experiment, parameters=every))
    u = misfit.unknowns
    alone = Unknowns(u.labels, u.start, u.lower, u.upper, u.where[:1], u.delays)
    run = Misfit(misfit.model, [again], alone)
    run.noise = [misfit.noise[0]]
    return run.jacobian(x)
