"""Inverse problems: unknown forces and drives from measured motion, by regularised least squares.

``min |(m(t; f) − y)/σ|² + μ ∫ f̈² dt`` (Tikhonov), ``f`` splines with unknown values; or with
another derivative.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.design.identification.experiment import Measures
from dalembert.design.identification.identify import prepared, refuse_bad_start
from dalembert.design.identification.least_squares import Fit, LeastSquares
from dalembert.design.identification.misfit import Misfit
from dalembert.design.inverse.history import History
from dalembert.design.inverse.inverted import Inversion
from dalembert.design.inverse.smoothing import Curve, chosen, curve
from dalembert.errors import AnalysisError
from dalembert.interrupts import defer_ctrl_c, interruptible
from dalembert.results.result import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled

ROUNDS = 6
"""Most solutions until the smoothing that is chosen stays."""


@spelled
@interruptible
def invert(
    model: ParametricModel,
    data: Any,
    measures: Measures = None,
    histories: Sequence[History] = (),
    *,
    vary: Sequence[str] = (),
    analysis: Analysis | None = None,
    smoothing: str | float = "l-curve",
    order: int = 2,
    time: str | None = None,
    noise: Mapping[str, float | str] | None = None,
    start: Mapping[str, float] | None = None,
    max_iterations: int = 50,
    tolerance: float = 1e-8,
    progress: bool | Callable[[int, float], None] = False,
) -> Inversion:
    """Unknown histories that explain measured motion; Ctrl-C ends it with the best so far.

    Parameters
    ----------
    model : Model or StructuralModel with the parameters of the histories
    data, measures, analysis, time, noise, start : as of ``identify``
    histories : made by ``da.history``
    vary : further unknown parameters, such as initial values
    smoothing : ``"l-curve"``, ``"cross-validation"``, ``"discrepancy"`` (needs noise), or ``μ``
    order : of the derivative that is to be small; 3 for drives whose accelerations matter
    max_iterations, tolerance : at which the search ends
    progress : True prints each iteration, or a function of its number and misfit

    Raises
    ------
    AnalysisError
        Data that cannot be used, or a run that fails at the start.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pushed mass")
    >>> mass = system.add(planar.Particle("mass", mass=2.0))
    >>> push = da.history(system, "push", np.linspace(0, 1, 5), unit="N")
    >>> force = system.add(planar.Force("push", mass.center, (push.value, 0)))
    >>> t = np.linspace(0, 1, 21)
    >>> seen = {"time": t, "mass.x": 0.75 * t**2}  # under a force of 3 N
    >>> found = da.invert(system.build(), seen, histories=[push], smoothing=1e-6)
    >>> found.values["push"].round(3)
    array([3., 3., 3., 3., 3.])
    """
    if not histories:
        raise AnalysisError("nothing to find; give histories=[da.history(system, ...)]")
    if not isinstance(smoothing, str) and not smoothing > 0:
        raise AnalysisError(f"smoothing is {smoothing!r}; it must be above zero")
    if order not in (1, 2, 3):
        raise AnalysisError(f"order is {order!r}; it must be 1, 2 or 3")
    names = [name for h in histories for name in h.names]
    misfit = prepared(
        *(model, data, measures, [*names, *vary], analysis, time, noise, None, start),
        regularised=True,
    )
    solver = LeastSquares(misfit, "linear", tolerance, max_iterations, progress=progress)
    given = solver.use_given_noise()
    if smoothing == "discrepancy" and not given:
        raise AnalysisError(
            "smoothing by discrepancy needs noise={column: deviation} of all columns"
        )
    x = misfit.unknowns.start
    refuse_bad_start(misfit, x)
    rows = _rows(histories, misfit, order)
    fit, mu, seen = _solved(solver, x, rows, smoothing)
    defer_ctrl_c()
    found = _inversion(misfit, histories, fit, mu, seen, rows, given)
    found.interrupted = solver.interrupted
    return found


def _solved(
    solver: LeastSquares, x: np.ndarray, rows: np.ndarray, smoothing: str | float
) -> tuple[Fit, float, Curve]:
    """Solution and smoothing in turn until the smoothing stays; a smooth one comes first."""
    seen = _linear(solver.misfit, x, rows)
    mu = float(np.median(seen.smoothing)) if isinstance(smoothing, str) else smoothing
    for _ in range(ROUNDS):
        solver.penalty = np.sqrt(mu) * rows, np.zeros(len(rows))
        fit = solver.solve(x)
        x, before = fit.x, mu
        seen = _linear(solver.misfit, x, rows)
        mu = chosen(smoothing, seen)
        if solver.interrupted or abs(mu - before) <= 0.3 * before:
            break
    return fit, before, seen


def _rows(histories: Sequence[History], misfit: Misfit, order: int) -> np.ndarray:
    """Rows of the roughness of all histories."""
    labels = misfit.unknowns.labels
    blocks = []
    for history in histories:
        rough = history.roughness(order)
        block = np.zeros((len(rough), len(labels)))
        block[:, [labels.index(name) for name in history.names]] = rough
        blocks.append(block)
    return np.vstack(blocks)


def _linear(misfit: Misfit, x: np.ndarray, rows: np.ndarray) -> Curve:
    """The curve of the problem linearised at a solution."""
    jacobian = misfit.jacobian(x)
    return curve(jacobian, jacobian @ x - misfit.residual(x), rows)


def _inversion(
    misfit: Misfit,
    histories: Sequence[History],
    fit: Fit,
    mu: float,
    seen: Curve,
    rows: np.ndarray,
    given: bool,
) -> Inversion:
    x, labels = fit.x, misfit.unknowns.labels
    jacobian, residual = misfit.jacobian(x), misfit.residual(x)
    inverse = np.linalg.pinv(jacobian.T @ jacobian + mu * rows.T @ rows, hermitian=True)
    influence = inverse @ jacobian.T
    left = max(residual.size - float(np.trace(jacobian @ influence)), 1.0)
    level = 1.0 if given else float(residual @ residual) / left
    spread = np.sqrt(level * np.sum(influence**2, axis=1))
    motions = misfit.motions(x)
    assert motions is not None
    places = {h.name: [labels.index(name) for name in h.names] for h in histories}
    return Inversion(
        values={name: x[place] for name, place in places.items()},
        deviation={name: spread[place] for name, place in places.items()},
        x=dict(zip(labels, map(float, x), strict=True)),
        success=fit.success,
        message=fit.message,
        smoothing=mu,
        curve=seen,
        misfit_norm=float(np.linalg.norm(residual)),
        roughness_norm=float(np.linalg.norm(rows @ x)),
        motions=motions,
        predicted=misfit.predicted(x),
        histories=list(histories),
        misfit=misfit,
    )
