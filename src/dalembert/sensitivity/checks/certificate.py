"""Certificates of gradients: comparison of all methods and Taylor tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.analysis.times import follow_parameters
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response, scalar_measure
from dalembert.responses.integrals import OverRun
from dalembert.results.result import Result
from dalembert.sensitivity.checks.diagnosis import NEGLIGIBLE
from dalembert.sensitivity.checks.finite_difference import Replays
from dalembert.sensitivity.checks.stencils import EPS, parameter_scales, quotient_within_bounds
from dalembert.sensitivity.checks.taylor import TaylorTest, taylor_test
from dalembert.sensitivity.moving_times import of_moving_times
from dalembert.sensitivity.registry import engine_of

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

STEPS = (1e-2, 1e-3, 1e-4, 1e-5)
SHORT_STEPS = (1e-5, 1e-6, 1e-7)
LONG_STEPS = (4e-2, 2e-2, 1e-2, 1e-3)
"""Relative steps of the differences: standard, near a kink, and for values with noise from a
tolerance [-]."""
AGREE = 1e-9
"""Upper limit of the difference of direct and adjoint derivatives, relative to the largest
influence [-]."""
CONFIRM = 1e-6
"""Upper limit of the difference of exact derivatives and difference quotients, likewise [-]."""
LOOSE = 1e-5
"""Upper limit of the uncertainty of a confirming difference, if derivatives are exact [-]."""
BARELY = 1e-9
"""Threshold of an influence relative to the response; a run resolves no smaller one [-]."""
ROUNDED = 100.0
"""Rounding error of derivatives, in machine accuracies of the response [-]."""
SPREAD = 10.0
"""Difference of the errors of neighbouring runs with error control, in tolerances [-]."""
SLOPE = 0.1
"""Permitted deviation of a Taylor slope below 2 [-]."""

CONFIRMED, NO_INFLUENCE = "confirmed", "no influence"
UNCONFIRMED, CONTRADICTED = "unconfirmed", "contradicted"
EXACT = "exact"


@dataclass(frozen=True, eq=False, repr=False)
class Certificate:
    """Verification that a gradient is the derivative of the computed responses.

    ``data`` holds over ``response × parameter`` the ``direct`` and the ``adjoint`` derivative,
    their ``disagreement``, the best ``difference`` with its ``step``, its ``error`` against the
    adjoint and its own ``uncertainty``, and a ``verdict``; all relative numbers are relative to
    the largest influence on the response, where an influence is a derivative times the size of its
    parameter (relative to the response, if no influence exceeds ``BARELY``). Over
    ``response`` there is the Taylor test: ``taylor_slope`` (2 or more for a correct gradient, 1
    for an incorrect one) and ``taylor_verdict``; over ``response × taylor_step`` the
    ``taylor_remainder``.

    Verdicts: confirmed; no influence; unconfirmed, if differences are too inaccurate; contradicted;
    exact, if the response is linear and the remainder vanishes.

    Parameters
    ----------
    data : Dataset as described above

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 3.0, "m/s", bounds=(1, 5))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(speed, 10)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> gradient = da.sensitivity(motion, da.final("stone.x**2"), certificate=True)
    >>> certificate = gradient.attrs["certificate"]
    >>> isinstance(certificate, da.Certificate), certificate.data["verdict"].values.ravel().tolist()
    (True, ['confirmed'])
    """

    data: xr.Dataset

    @property
    def passed(self) -> bool:
        """True if all entries are confirmed, have no influence or are exact."""
        entries = np.isin(self.data["verdict"].values, (CONFIRMED, NO_INFLUENCE))
        tests = np.isin(self.data["taylor_verdict"].values, (CONFIRMED, EXACT))
        return bool(entries.all() and tests.all())

    def table(self) -> pd.DataFrame:
        """Table with one row per response and parameter."""
        names = ("direct", "adjoint", "disagreement", "difference", "step", "error", "verdict")
        return self.data[list(names)].to_dataframe().reset_index()

    def summary(self) -> list[str]:
        """Summary with one sentence per result."""
        verdicts = self.data["verdict"]
        words, counts = np.unique(verdicts.values.astype(str), return_counts=True)
        tally = ", ".join(f"{n} {word}" for word, n in zip(words, counts, strict=True))
        worst = float(self.data["disagreement"].max())
        lines = [
            f"{verdicts.size} derivatives: {tally}; direct and adjoint differ by {worst:.1e} at "
            f"most, differences by {float(self.data['error'].max()):.1e}"
        ]
        for r in self.data["response"].values:
            here = self.data.sel(response=r)
            slope, verdict = float(here["taylor_slope"]), str(here["taylor_verdict"].item())
            text = f"slope {slope:.2f}, {verdict}" if np.isfinite(slope) else verdict
            lines.append(f"Taylor test of {r}: {text}")
        if self.data.attrs["times_follow"]:
            lines.append("at fixed times: the gradient also includes the moving times")
        return lines

    def __repr__(self) -> str:
        state = "passed" if self.passed else "not passed"
        return "\n".join(
            [f"<Certificate of {self.data.attrs['model']!r}: {state}>", *self.summary()]
        )

    def _repr_html_(self) -> str:
        return self.table().to_html(index=False, float_format=lambda x: f"{x:.6g}")


def certify(
    motion: Result,
    responses: Sequence[Response],
    columns: list[int],
    rng: np.random.Generator | None = None,
) -> Certificate:
    """Certificate by three methods for every entry and Taylor tests in a random direction."""
    import xarray as xr

    engine, values = engine_of(motion, responses), Replays(motion, responses)
    direct, adjoint = engine.direct(columns), engine.adjoint()[:, columns]
    if values.reruns:
        moves = of_moving_times(motion, responses, columns)
        direct, adjoint = direct + moves, adjoint + moves
    scales = parameter_scales(motion, columns)
    largest = np.abs(adjoint * scales).max(axis=1, keepdims=True)
    size = _sizes(motion, responses, values(motion.parameters))[:, None]
    largest = np.where(largest > BARELY * size, largest, np.where(size > 0, size, 1.0))
    relative = scales / largest
    unsteady = SPREAD * motion.analysis.gradient_error * np.maximum(size, largest)
    noise = np.maximum(EPS * size, unsteady)
    steps, differences, uncertainty = _differences(values, columns, noise, relative)
    agreement, rng = _agreement(motion), rng or np.random.default_rng(0)
    taylor = taylor_test(values, columns, adjoint, agreement, noise, rng)
    cells: dict[str, Any] = {
        "direct": direct,
        "adjoint": adjoint,
        "disagreement": np.abs(direct - adjoint) * relative,
        "difference": differences,
        "step": steps,
        "error": np.abs(differences - adjoint) * relative,
        "uncertainty": uncertainty * relative,
    }
    limit = np.maximum(agreement, ROUNDED * EPS * size / largest)
    cells["verdict"] = _verdicts(cells, np.abs(adjoint) * relative, agreement, limit)
    rough = [not values.reruns and _has_moving_kinks(motion, r) for r in responses]
    inaccurate = np.array(rough)[:, None] & (cells["disagreement"] <= limit)
    cells["verdict"][inaccurate & (cells["verdict"] == CONTRADICTED)] = UNCONFIRMED
    names = list(motion.model.parameters)
    coordinates = {
        "response": [r.label for r in responses],
        "parameter": [names[i] for i in columns],
        "taylor_step": taylor.steps,
    }
    data: dict[str, Any] = {k: (("response", "parameter"), v) for k, v in cells.items()}
    data["taylor_slope"] = ("response", [taylor.slope(r) for r in range(len(responses))])
    verdicts = [_taylor_verdict(taylor, r, rough[r]) for r in range(len(responses))]
    data["taylor_verdict"] = ("response", np.array(verdicts, dtype=object))
    data["taylor_remainder"] = (("response", "taylor_step"), taylor.remainders)
    fixed_times = follow_parameters(motion.analysis) and not values.reruns
    attrs = {"model": motion.model.name, "times_follow": fixed_times}
    return Certificate(xr.Dataset(data, coordinates, attrs=attrs))


def _agreement(motion: Result) -> float:
    """Tolerance for the agreement of direct and adjoint derivatives."""
    return max(AGREE, 1e3 * motion.analysis.gradient_error)


def _sizes(motion: Result, responses: Sequence[Response], values: np.ndarray) -> np.ndarray:
    """Sizes of the responses; of the largest sample if a response is negligible relative to it.

    The height of a crank along the x axis is zero and no reference for influences.
    """

    def largest(response: Response) -> float:
        return float(np.abs(motion.values(scalar_measure(motion, response))).max(initial=0.0))

    reach = [max(abs(w) * largest(term) for w, term in r.terms) for r in responses]
    return np.where(np.abs(values) > BARELY * np.array(reach), np.abs(values), reach)


def _differences(
    values: Replays, columns: list[int], noise: np.ndarray, relative: np.ndarray
) -> tuple[np.ndarray, ...]:
    """(responses, columns) steps, quotients and uncertainties for the best agreeing pair of steps.

    The ``noise`` (responses, 1) of the values bounds the uncertainty from below, since two steps
    may agree by chance. If no pair agrees, as near a kink, shorter steps are tried.
    """
    exact = not values.motion.analysis.gradient_error
    best = _quotients(values, columns, noise, STEPS if exact else LONG_STEPS)
    if exact and not np.all(best[2] * relative <= LOOSE):
        shorter = _quotients(values, columns, noise, SHORT_STEPS)
        better = np.nan_to_num(shorter[2], nan=np.inf) < np.nan_to_num(best[2], nan=np.inf)
        best = tuple(np.where(better, *both) for both in zip(shorter, best, strict=True))
    return best


def _quotients(
    values: Replays, columns: list[int], noise: np.ndarray, steps: Sequence[float]
) -> tuple[np.ndarray, ...]:
    """(responses, columns) steps, quotients and uncertainties, the best of some relative steps."""
    size = values(values.parameters).size
    shape = (len(steps), size, len(columns))
    quotients, lengths, rough = (np.full(shape, np.nan) for _ in range(3))
    for j, column in enumerate(columns):
        for k, relative in enumerate(steps):
            try:
                quotient = quotient_within_bounds(values.motion, column, "richardson", relative)
                quotients[k, :, j] = quotient.evaluate(values.parameters, values)
            except AnalysisError:
                continue  # another step may be admissible
            lengths[k, :, j] = quotient.step
            rough[k, :, j] = noise[:, 0] * quotient.amplification
    uncertain = np.maximum(np.abs(np.diff(quotients, axis=0)), rough[:-1])
    best = np.argmin(np.where(np.isfinite(uncertain), uncertain, np.inf), axis=0)
    rows, cols = np.indices(best.shape)
    return tuple(array[best, rows, cols] for array in (lengths, quotients, uncertain))


def _verdicts(
    cells: dict[str, np.ndarray], influence: np.ndarray, agreement: float, limit: np.ndarray
) -> np.ndarray:
    """Verdict for every entry."""
    error, uncertainty = cells["error"], cells["uncertainty"]
    within = np.maximum(max(CONFIRM, agreement), 10 * uncertainty)
    verdicts = np.full(error.shape, CONFIRMED, dtype=object)
    verdicts[influence <= NEGLIGIBLE] = NO_INFLUENCE
    verdicts[~(uncertainty <= max(LOOSE, 100 * agreement))] = UNCONFIRMED
    verdicts[(error > within) | ~(cells["disagreement"] <= limit)] = CONTRADICTED
    return verdicts


def _has_moving_kinks(motion: Result, response: Response) -> bool:
    """True if repeated runs have errors from kinks or impacts that move inside fixed steps."""
    moves = motion.statistics.get("switches", 0) > 0 or bool(getattr(motion, "impacts", ()))
    return moves and (isinstance(response, OverRun) or not response.has_fixed_times(motion))


def _taylor_verdict(taylor: TaylorTest, response: int, rough: bool) -> str:
    slope = taylor.slope(response)
    if np.isnan(slope):
        return EXACT if taylor.exact(response) else UNCONFIRMED
    if slope >= 2.0 - SLOPE:
        return CONFIRMED
    return UNCONFIRMED if rough else CONTRADICTED
