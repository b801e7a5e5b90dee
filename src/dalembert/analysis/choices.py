"""Choices that work badly together, told with the number that shows it."""

from __future__ import annotations

import numpy as np

from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator


def doubts(
    formulation: Formulation,
    stabilization: Stabilization,
    integrator: Integrator,
    step: float,
    freedom: int,
    exchanged: float,
) -> list[str]:
    """Warnings about one choice of strategies.

    The violation of a constraint that is fed back follows ``Φ̈ + c₁Φ̇ + c₀Φ = 0``; with roots ``s`` a
    step of length h multiplies it by ``R(hs)``, which must not exceed one.

    Parameters
    ----------
    step : length of the steps [s]
    freedom : degrees of freedom that the drivers leave
    exchanged : largest energy put in or dissipated during the run [J]
    """
    found = stabilization.warnings(freedom, exchanged)
    for name, feedback in (
        (_told(stabilization), stabilization.feedback),
        (_told(formulation), formulation.feedback),
    ):
        growth = None if feedback is None else _growth(feedback, integrator, step)
        if growth is not None and feedback is not None and growth > 1 + 1e-9:
            longest = _longest_stable(feedback, integrator, step)
            found.append(
                f"{name} with {integrator.name} and steps of {step:g} s multiplies violations by "
                f"{growth:.3g} in every step; use steps below {longest:.3g} s, or smaller gains"
            )
    return found


def _told(strategy: object) -> str:
    return type(strategy).__name__


def _growth(feedback: tuple[float, float], integrator: Integrator, step: float) -> float | None:
    """``max |R(hs)|`` over the roots of ``s² + c₁ s + c₀``."""
    if integrator.stability is None or integrator.adaptive:
        return None
    roots = np.roots([1.0, *feedback]).astype(complex)
    return float(np.max(np.abs(integrator.stability(step * roots))))


def _longest_stable(feedback: tuple[float, float], integrator: Integrator, step: float) -> float:
    low, high = 0.0, step
    for _ in range(60):
        middle = (low + high) / 2
        growth = _growth(feedback, integrator, middle)
        stable = growth is not None and growth <= 1 + 1e-9
        low, high = (middle, high) if stable else (low, middle)
    return low
