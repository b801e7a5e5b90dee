"""Tolerance analysis: scatter and worst case of a response for toleranced dimensions.

First order: ``σ_f² = Σ (∂f/∂p_i σ_i)²``; second order adds the mean shift ``½ Σ f_ii σ_i²`` and
``½ Σ (f_ij σ_i σ_j)²``; the worst case is the extreme within the box of all tolerances.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.optimize.optimization import design_problem
from dalembert.design.optimize.problem import DesignProblem, Evaluation
from dalembert.design.tolerance.tolerance_result import ToleranceResult
from dalembert.errors import AnalysisError, ModelError
from dalembert.interrupts import interruptible, searching
from dalembert.options import RandomSource, random_generator
from dalembert.responses.base import Response
from dalembert.responses.evaluation import as_responses
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import unknown
from dalembert.units.measured import check_measured, measured

STEP = 1e-3
"""Step of the second differences, relative to the tolerances [-]."""
BLOCK_SIZE = 20
"""Samples per progress report."""
MAX_CORNER_DIMENSION = 5
"""Upper limit of the tolerances for which all corners of the box are evaluated."""


@dataclass
class Box:
    """Response over the box of all tolerances, ``p = p₀ + t z`` with ``|z| ≤ 1``."""

    problem: DesignProblem
    nominal: np.ndarray
    half: np.ndarray

    def value(self, z: np.ndarray) -> float:
        """Response.

        Raises
        ------
        AnalysisError
            The run fails.
        """
        return float(self._evaluate(z, False).values[0])

    def slope(self, z: np.ndarray) -> np.ndarray:
        """(n,) derivatives by ``z``: first-order change for each full tolerance."""
        return self.problem.slope(self._evaluate(z, True), 0) * self.half

    def _evaluate(self, z: np.ndarray, gradient: bool) -> Evaluation:
        p = self.nominal + self.half * z
        evaluation = self.problem.evaluate(p, gradient)
        if evaluation is None:
            values = ", ".join(
                f"{n} = {v:.6g}" for n, v in self.problem.variables.parameters(p).items()
            )
            raise AnalysisError(f"a run fails at {values}: {self.problem.failures[-1]}")
        return evaluation

    def hessian(self) -> np.ndarray:
        """(n, n) second derivatives by central differences of the exact gradient."""
        size = self.half.size
        rows = [(self.slope(STEP * e) - self.slope(-STEP * e)) / (2 * STEP) for e in np.eye(size)]
        matrix = np.array(rows)
        return (matrix + matrix.T) / 2

    def extreme(self, sign: float) -> float:
        """Minimum (−1) or maximum (+1) within the box, by a local search from the best corner."""
        from scipy.optimize import minimize

        start = max(self._corners(sign), key=lambda z: sign * self.value(z))
        corner_value = sign * self.value(start)
        scale = max(
            abs(corner_value - sign * self.value(0 * start)), 1e-9 * abs(corner_value), 1e-300
        )
        outcome = minimize(
            lambda z: (corner_value - sign * self.value(np.clip(z, -1, 1))) / scale,
            0.9 * start,  # a corner may be a saddle
            jac=lambda z: -sign * self.slope(np.clip(z, -1, 1)) / scale,
            method="L-BFGS-B",
            bounds=[(-1, 1)] * self.half.size,
        )
        return sign * max(corner_value, sign * self.value(np.clip(outcome.x, -1, 1)))

    def _corners(self, sign: float) -> list[np.ndarray]:
        """All corners of a small box; of a large one the corner in the direction of the slope."""
        size = self.half.size
        if size <= MAX_CORNER_DIMENSION:
            return [2.0 * np.array(corner) - 1 for corner in np.ndindex(*(2,) * size)]
        return [np.where(sign * self.slope(np.zeros(size)) < 0, -1.0, 1.0)]


@check_arguments
@interruptible
def tolerance(
    model: ParametricModel,
    response: Response,
    tolerances: Mapping[str, float | str],
    *,
    analysis: Analysis,
    sigmas: float = 3.0,
    second_order: bool = True,
    worst_case: bool = True,
    samples: int = 0,
    rng: RandomSource = 0,
    progress: Reported = False,
) -> ToleranceResult:
    """Scatter and worst case of a response from dimensional tolerances.

    Ctrl-C ends it with the results until then, at least to first order.

    Parameters
    ----------
    model : Model or StructuralModel
    response : toleranced response
    tolerances : parameter → half width ``±t`` about its nominal value, or text as ``"0.1 mm"``
    analysis : analysis of the response
    sigmas : standard deviations per tolerance; dimensions are normally distributed
    second_order : also the Hessian, by two gradients per tolerance
    worst_case : also the extremes within all tolerances
    samples : number of Monte Carlo samples; default none
    rng : seed or generator of the samples
    progress : True for a bar, or a function of the fraction done

    Raises
    ------
    ModelError, AnalysisError
        Unknown parameters, a tolerance not above zero, or a run that fails.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> stack = da.Structure("two plates")
    >>> a, b = stack.parameter("a", 20.0, "mm"), stack.parameter("b", 30.0, "mm")
    >>> end = stack.node("end", a + b)
    >>> part = stack.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> height = da.final("a + b", name="height")
    >>> limits = {"a": 0.3e-3, "b": 0.4e-3}
    >>> result = da.tolerance(stack.build(), height, limits, analysis=da.Statics())
    >>> round(3 * result.std * 1e3, 6)  # √(0.3² + 0.4²) [mm]
    0.5
    >>> [round(x * 1e3, 6) for x in result.worst]  # ± 0.7 mm
    [49.3, 50.7]
    """
    if not tolerances:
        raise AnalysisError("there are no tolerances; give tolerances={'name': 0.1e-3}")
    widths: dict[str, Any] = {name: measured(width) for name, width in tolerances.items()}
    for name, width in widths.items():
        if name not in model.parameters:
            raise ModelError(unknown("parameter with a tolerance", name, model.parameters))
        check_measured([width], model.parameters[name].unit, f"tolerance of {name}")
        if not (np.isfinite(width) and width > 0):
            raise ModelError(f"its tolerance is {width!r}; it must be above zero", name)
    if not sigmas > 0:
        raise AnalysisError(f"sigmas is {sigmas!r}; it must be above zero")
    names, parameter_names = list(widths), list(model.parameters)
    nominal = np.array([model.nominal[parameter_names.index(n)] for n in names])
    half_widths = np.array([float(t) for t in widths.values()])
    problem = design_problem(model, analysis, as_responses(response), names)
    box, origin = Box(problem, nominal, half_widths), np.zeros(half_widths.size)
    result = ToleranceResult(
        label=response.label,
        nominal=box.value(origin),
        tolerances=dict(zip(names, map(float, half_widths), strict=True)),
        effects=dict(zip(names, map(float, box.slope(origin)), strict=True)),
        sigmas=sigmas,
        name=model.name,
        unit=problem.unit(0, problem.results(nominal)),
        units={n: model.parameters[n].unit for n in names},
        run=next(iter(problem.results(nominal).values()), None),
        response=as_responses(response)[0],
    )
    with progress_reporter(progress, "tolerances") as report:
        try:
            with searching():
                if second_order:
                    result.hessian = box.hessian()
                report(0.2)
                if worst_case:
                    result.worst = box.extreme(-1), box.extreme(1)
                report(0.3)
                if samples:
                    generator = random_generator(rng)
                    result.sampled, result.samples = np.zeros(0), np.zeros((0, nominal.size))
                    for points, values in _sample_blocks(box, sigmas, samples, generator):
                        result.sampled = np.append(result.sampled, values)
                        result.samples = np.vstack([result.samples, nominal + half_widths * points])
                        report(0.3 + 0.7 * result.sampled.size / samples)
        except KeyboardInterrupt:
            result.interrupted = True
    if result.sampled is not None and not result.sampled.size:
        result.sampled = result.samples = None
    return result


def _sample_blocks(
    box: Box, sigmas: float, samples: int, rng: np.random.Generator
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield blocks of normally distributed dimensions, as shares of the tolerances, and their
    responses."""
    points = rng.normal(size=(samples, box.half.size)) / sigmas
    for block in np.array_split(points, max(1, samples // BLOCK_SIZE)):
        yield block, np.array([box.value(z) for z in block])
