"""The rows of a comparison: each run timed from a cold start and measured."""

from __future__ import annotations

import time as clock
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.analysis.comparison.combinations import Combination
from dalembert.analysis.comparison.reference import Observation, Reference, differences
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.errors import DalembertError, ModelError, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.results.comparison.data import BETWEEN
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome


class ComparisonRun:
    """Runs of one model over the same times.

    Parameters
    ----------
    model : Model
    span : ``Dynamics`` with span and outputs
    p : parameter values
    observed : quantities whose errors are computed
    exact : Reference
    repeat : number of timed runs after the first one

    Attributes
    ----------
    rows : one per run
    unsupported : strategies that are not supported
    interrupted : whether the user stopped the last run
    """

    def __init__(
        self,
        model: Model,
        span: Dynamics,
        p: np.ndarray,
        observed: Observation,
        exact: Reference,
        repeat: int,
    ):
        self.model, self.span, self.p = model, span, p
        self.observed, self.exact, self.repeat = observed, exact, repeat
        self.rows: list[dict[str, Any]] = []
        self.unsupported: list[dict[str, str]] = []
        self.interrupted = False
        self.choice: Dynamics | None = None
        self.cold, self.preparation = model, 0.0

    def add(self, combination: Combination) -> None:
        """Append the costs, violations and errors of a combination, or the reason of its failure.

        Unsupported strategies are reported once, not for every step.
        """
        names = combination.labels
        if names in self.unsupported:
            return
        row: dict[str, Any] = {
            **names,
            "step": combination.step,
            "tolerance": combination.tolerance,
        }
        self.rows.append(row)
        try:
            motion, costs = self.timed(replace(self.span, **combination.strategies))
            row |= costs | self.quality(motion)
            row |= {"outcome": motion.status.outcome.value, "message": motion.status.message}
            row |= {"warnings": BETWEEN.join(motion.warnings)}
            self.interrupted = motion.status.outcome is Outcome.INTERRUPTED
        except (DalembertError, RuntimeError) as error:  # CasADi raises RuntimeError
            row |= {"outcome": type(error).__name__, "message": " ".join(str(error).split())}
            if isinstance(error, (UnsupportedError, ModelError)):
                row |= {"step": None, "tolerance": None}
                self.unsupported.append(names)
        except KeyboardInterrupt:
            self.rows.pop()
            self.interrupted = True

    def timed(self, analysis: Dynamics) -> tuple[Motion, dict[str, Any]]:
        """A run, and the shortest time of its integration.

        Changes of variant compile during the first run, so that it is not timed alone. The steps
        of one choice share its functions and the preparation time of the first run.
        """
        choice = replace(analysis, step=None, outputs=None)
        first = choice != self.choice
        if first:
            self.choice = choice  # preparation is measured, and its memory freed after the choice
            self.cold = copy(self.model)
        cold, begin = self.cold, clock.perf_counter()
        analysis.kernel(cold)
        building = clock.perf_counter() - begin
        motion = analysis.run(cold, self.p)
        if first:
            self.preparation = building + motion.statistics["preparation time [s]"]
        brief = replace(analysis, outputs=self.span.outputs[-1:])  # type: ignore[index]
        again = range(self.repeat if motion.status.success else 0)
        runs = [motion, *(_uninterrupted(brief.run(cold, self.p)) for _ in again)]
        shortest = min(run.statistics["integration time [s]"] for run in runs)
        count = motion.statistics["steps"]
        return replace(motion, model=self.model), {
            "steps": count,
            "rejected": motion.statistics["rejected steps"],
            "time": shortest,
            "time_per_step": 1e6 * shortest / count if motion.status.success else None,
            "preparation": self.preparation,
        }

    def quality(self, motion: Motion) -> dict[str, Any]:
        """Violations, energy error and errors of a run that reached the end."""
        if motion.status.outcome not in (Outcome.COMPLETED, Outcome.NOT_CONVERGED):
            return {}
        largest = {
            name: float(np.max(abs(motion.data[name].values), initial=0.0))
            for name in ("position_violation", "velocity_violation", "balance_error")
        }
        energy_error = largest.pop("balance_error") / self.exact.energy
        row: dict[str, Any] = {**largest, "energy_error": energy_error}
        errors = differences(self.observed.of(motion), self.exact.values)
        for kind, (maximum, last) in errors.items():
            row[f"error_{kind}"], row[f"error_{kind}_final"] = maximum, last
        trusted = self.exact.uncertainty["position"][0]
        return row | {"below_uncertainty": row["error_position"] <= trusted}


def _uninterrupted(motion: Motion) -> Motion:
    """The motion, unless the user stopped it."""
    if motion.status.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    return motion
