"""Inverse problems: unknown forces and drives from measured motion, by regularised least squares.

``min |(m(t; f) − y)/σ|² + μ ∫ f̈² dt`` (Tikhonov) for splines ``f`` with unknown values; the
order of the derivative is an option.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.design.identification.experiment import Measures
from dalembert.design.identification.identify import check_start, make_misfit
from dalembert.design.identification.least_squares import Fit, LeastSquaresSolver
from dalembert.design.identification.misfit import Misfit
from dalembert.design.inverse.input_history import InputHistory
from dalembert.design.inverse.inversion_result import InversionResult
from dalembert.design.inverse.smoothing import (
    Curve,
    curve,
    history_weights,
    pseudo_inverse,
    select_smoothing,
)
from dalembert.errors import AnalysisError
from dalembert.interrupts import defer_ctrl_c, interruptible
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments

MAX_ROUNDS = 6
"""Upper limit of solutions until the selected smoothing no longer changes."""


@check_arguments
@interruptible
def invert(
    model: ParametricModel,
    data: Any,
    measures: Measures = None,
    histories: Sequence[InputHistory] = (),
    *,
    vary: Sequence[str] = (),
    analysis: Analysis | None = None,
    smoothing: str | float = "likelihood",
    order: int = 2,
    time: str | None = None,
    noise: Mapping[str, float | str] | None = None,
    start: Mapping[str, float] | None = None,
    max_iterations: int = 50,
    tolerance: float = 1e-8,
    progress: bool | Callable[[int, float], None] = False,
) -> InversionResult:
    """Identify unknown histories from measured motion; Ctrl-C returns the best so far.

    Parameters
    ----------
    model : Model or StructuralModel with the parameters of the histories
    data, measures, analysis, time, noise, start : as in ``identify``
    histories : created by ``da.input_history``
    vary : further unknown parameters, such as initial values
    smoothing : ``"likelihood"``, ``"cross-validation"``, ``"l-curve"``, ``"discrepancy"`` (needs
        noise), or ``μ``; by likelihood, each history has its own smoothing
    order : of the derivative that is penalised; 1 for discontinuous forces, 3 for drives whose
        accelerations matter
    max_iterations, tolerance : stopping criteria of the search
    progress : True prints each iteration, or a function of its number and misfit

    Raises
    ------
    AnalysisError
        The data cannot be used, or the run at the initial values fails.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pushed mass")
    >>> mass = system.add(planar.Particle("mass", mass=2.0))
    >>> push = da.input_history(system, "push", np.linspace(0, 1, 5), unit="N")
    >>> force = system.add(planar.Force("push", mass.center, (push.value, 0)))
    >>> t = np.linspace(0, 1, 21)
    >>> seen = {"time": t, "mass.x": 0.75 * t**2}  # under a force of 3 N
    >>> result = da.invert(system.build(), seen, histories=[push], smoothing=1e-6)
    >>> result.values["push"].round(3)
    array([3., 3., 3., 3., 3.])
    """
    if not histories:
        raise AnalysisError("nothing to find; give histories=[da.input_history(system, ...)]")
    if not isinstance(smoothing, str) and not smoothing > 0:
        raise AnalysisError(f"smoothing is {smoothing!r}; it must be above zero")
    if order not in (1, 2, 3):
        raise AnalysisError(f"order is {order!r}; it must be 1, 2 or 3")
    names = [name for h in histories for name in h.names]
    misfit = make_misfit(
        *(model, data, measures, [*names, *vary], analysis, time, noise, None, start),
        regularised=True,
    )
    solver = LeastSquaresSolver(misfit, "linear", tolerance, max_iterations, progress=progress)
    noise_known = solver.use_specified_noise()
    if smoothing == "discrepancy" and not noise_known:
        raise AnalysisError(
            "smoothing by discrepancy needs noise={column: deviation} of all columns"
        )
    x = misfit.unknowns.start
    check_start(misfit, x)
    problem = _RegularisedProblem(solver, _blocks(histories, misfit, order), smoothing, noise_known)
    fit, mu, l_curve = problem.solve(x)
    defer_ctrl_c()
    inversion = _inversion(misfit, histories, fit, mu, l_curve, problem)
    inversion.interrupted = solver.interrupted
    return inversion


@dataclass
class _RegularisedProblem:
    """Least squares with a roughness penalty on histories, and the choice of its weight.

    Attributes
    ----------
    blocks : rows of the roughness of each history
    weights : of the blocks
    noise_known : whether the standard deviation of the noise is given
    """

    solver: LeastSquaresSolver
    blocks: list[np.ndarray]
    smoothing: str | float
    noise_known: bool
    weights: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.weights = np.ones(len(self.blocks))

    @property
    def rows(self) -> np.ndarray:
        """Rows of the roughness of all histories."""
        pairs = zip(self.weights, self.blocks, strict=True)
        return np.vstack([weight * block for weight, block in pairs])

    def solve(self, x: np.ndarray) -> tuple[Fit, float, Curve]:
        """Alternate solution and choice of the smoothing until the smoothing no longer changes."""
        l_curve = self._linear(x)
        mu = (
            float(np.median(l_curve.smoothing))
            if isinstance(self.smoothing, str)
            else self.smoothing
        )
        for _ in range(MAX_ROUNDS):
            rows = self.rows
            self.solver.penalty = np.sqrt(mu) * rows, np.zeros(len(rows))
            fit = self.solver.solve(x)
            x, previous, weights = fit.x, mu, self.weights
            l_curve = self._linear(x)
            mu = select_smoothing(self.smoothing, l_curve)
            weight_change = np.abs(np.log(self.weights**2 / weights**2)).max()
            if self.solver.interrupted or (
                abs(mu - previous) <= 0.3 * previous and weight_change <= 0.3
            ):
                self.weights = weights
                break
        return fit, previous, l_curve

    def _linear(self, x: np.ndarray) -> Curve:
        """L-curve of the problem linearised at a solution; updates the weights of the histories."""
        misfit = self.solver.misfit
        jacobian = misfit.jacobian(x)
        data = jacobian @ x - misfit.residual(x)
        if self.smoothing == "likelihood" and len(self.blocks) > 1:
            self.weights = history_weights(jacobian, data, self.blocks, self.noise_known)
        return curve(jacobian, data, self.rows, self.noise_known)


def _blocks(histories: Sequence[InputHistory], misfit: Misfit, order: int) -> list[np.ndarray]:
    """Rows of the roughness of each history."""
    labels = misfit.unknowns.labels
    blocks = []
    for history in histories:
        rough = history.roughness(order)
        block = np.zeros((len(rough), len(labels)))
        block[:, [labels.index(name) for name in history.names]] = rough
        blocks.append(block)
    return blocks


def _inversion(
    misfit: Misfit,
    histories: Sequence[InputHistory],
    fit: Fit,
    mu: float,
    l_curve: Curve,
    problem: _RegularisedProblem,
) -> InversionResult:
    x, labels, rows = fit.x, misfit.unknowns.labels, problem.rows
    residual = misfit.residual(x)
    covariance = _covariance(misfit.jacobian(x), residual, x, mu, problem)
    spread = np.sqrt(np.diag(covariance))
    motions = misfit.motions(x)
    assert motions is not None
    columns = {h.name: [labels.index(name) for name in h.names] for h in histories}
    return InversionResult(
        values={name: x[index] for name, index in columns.items()},
        deviation={name: spread[index] for name, index in columns.items()},
        x=dict(zip(labels, map(float, x), strict=True)),
        success=fit.success,
        message=fit.message,
        smoothing=mu,
        weights=dict(zip(columns, map(float, problem.weights), strict=True)),
        covariance=covariance,
        curve=l_curve,
        misfit_norm=float(np.linalg.norm(residual)),
        roughness_norm=float(np.linalg.norm(rows @ x)),
        motions=motions,
        predicted=misfit.predicted(x),
        histories=list(histories),
        misfit=misfit,
    )


def _covariance(
    jacobian: np.ndarray,
    residual: np.ndarray,
    x: np.ndarray,
    mu: float,
    problem: _RegularisedProblem,
) -> np.ndarray:
    """``σ² (JᵀJ + μPᵀP)⁻¹``: covariance due to noise and to the bias of the smoothing.

    The posterior covariance of a history with random roughness (Wahba 1983). Its intervals have
    the stated coverage of a fixed smooth history, on average over the knots (Nychka 1988).
    """
    rows = problem.rows
    inverse = pseudo_inverse(jacobian.T @ jacobian + mu * rows.T @ rows)
    if problem.noise_known:
        return inverse
    if problem.smoothing == "likelihood":
        free = x.size - int(np.linalg.matrix_rank(rows))
        roughness = float(np.sum((rows @ x) ** 2))
        return np.asarray(
            (residual @ residual + mu * roughness) / max(residual.size - free, 1) * inverse
        )
    degrees = float(np.sum(inverse * (jacobian.T @ jacobian)))
    return np.asarray(residual @ residual / max(residual.size - degrees, 1.0) * inverse)
