"""Warnings about combinations of strategies that are unstable for the chosen step."""

from __future__ import annotations

import numpy as np

from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator


def strategy_warnings(
    formulation: Formulation,
    stabilization: Stabilization,
    integrator: Integrator,
    step: float,
    freedom: int,
    exchanged: float,
) -> list[str]:
    """Warnings about one combination of strategies.

    With feedback, constraint violations follow ``Φ̈ + c₁Φ̇ + c₀Φ = 0``; with the roots ``s`` a
    step of length h multiplies them by ``R(hs)``, which must not exceed one.

    Parameters
    ----------
    step : length of the steps [s]
    freedom : degrees of freedom without those prescribed by drivers
    exchanged : largest energy supplied or dissipated during the run [J]
    """
    warnings = stabilization.warnings(freedom, exchanged)
    for name, feedback in (
        (_name(stabilization), stabilization.feedback),
        (_name(formulation), formulation.feedback),
    ):
        growth = None if feedback is None else _growth(feedback, integrator, step)
        if growth is not None and feedback is not None and growth > 1 + 1e-9:
            longest = _longest_stable(feedback, integrator, step)
            warnings.append(
                f"{name} with {integrator.name} and steps of {step:g} s multiplies violations by "
                f"{growth:.3g} in every step; use steps below {longest:.3g} s, or smaller gains"
            )
    return warnings


def _name(strategy: object) -> str:
    return type(strategy).__name__


def _growth(feedback: tuple[float, float], integrator: Integrator, step: float) -> float | None:
    """``max |R(hs)|`` over the roots of ``s² + c₁ s + c₀``."""
    if integrator.stability is None or integrator.adaptive:
        return None
    roots = np.roots([1.0, *feedback]).astype(complex)
    return float(np.max(np.abs(integrator.stability(step * roots))))


def _longest_stable(feedback: tuple[float, float], integrator: Integrator, step: float) -> float:
    lower, upper = 0.0, step
    for _ in range(60):
        middle = (lower + upper) / 2
        growth = _growth(feedback, integrator, middle)
        stable = growth is not None and growth <= 1 + 1e-9
        lower, upper = (middle, upper) if stable else (lower, middle)
    return lower
