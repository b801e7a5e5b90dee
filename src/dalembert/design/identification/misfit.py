"""Misfit ``r = (m(t − τ; p) − y)/σ`` of a model to data, with its exact Jacobian."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.design.identification.experiment import Observation
from dalembert.design.identification.unknowns import Unknowns
from dalembert.errors import AnalysisError, ModelError
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.sensitivity.histories import history_gradients, history_rates
from dalembert.symbolic.parametric_model import ParametricModel


@dataclass
class Misfit:
    """Residuals of all experiments as functions of the unknowns.

    Parameters
    ----------
    used : for each experiment (K, columns), mask of the samples in use
    noise : for each experiment (K, columns) standard deviations
    """

    model: ParametricModel
    observations: Sequence[Observation]
    unknowns: Unknowns
    used: list[np.ndarray] = field(init=False)
    noise: list[np.ndarray] = field(init=False)
    runs: int = 0
    failures: list[str] = field(default_factory=list)
    _last: tuple[bytes, list[Result] | None] = (b"", None)

    def __post_init__(self) -> None:
        self.used = [self._usable(o) for o in self.observations]
        self.noise = [np.ones_like(o.values) for o in self.observations]

    def _usable(self, o: Observation) -> np.ndarray:
        """Mask of the samples that are available and within the run for all delays."""
        used = o.present.copy()
        span = getattr(o.analysis, "t_span", None) or (0.0, getattr(o.analysis, "duration", None))
        for j, column in enumerate(o.columns):
            if column in self.unknowns.delays:
                k = self.unknowns.delays[column]
                used[:, j] &= o.times - self.unknowns.upper[k] >= span[0]
                if span[1] is not None:
                    used[:, j] &= o.times - self.unknowns.lower[k] <= span[1]
        return used

    @property
    def size(self) -> int:
        """Number of residuals."""
        return int(sum(np.count_nonzero(u) for u in self.used))

    def motions(self, x: np.ndarray) -> list[Result] | None:
        """Results of all experiments; None and an entry in ``failures`` if one fails."""
        key = np.asarray(x, dtype=float).tobytes()
        if self._last[0] != key:
            self._last = key, self._run(x)
        return self._last[1]

    def _run(self, x: np.ndarray) -> list[Result] | None:
        motions: list[Result] = []
        for number, o in enumerate(self.observations):
            parameters = {**o.experiment.parameters, **self.unknowns.parameters(number, x)}
            self.runs += 1
            try:
                motion = o.analysis.run(self.model, parameters)
            except (AnalysisError, ModelError) as error:  # such as a mass below zero
                self.failures.append(f"{o.name}: {error}")
                return None
            if motion.status.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            if not motion.status.success:
                self.failures.append(f"{o.name}: {motion.status}")
                return None
            motions.append(motion)
        return motions

    def predicted(self, x: np.ndarray) -> list[np.ndarray]:
        """(K, columns) measures of each experiment, NaN for samples that are not used.

        Raises
        ------
        AnalysisError
            A run fails.
        """
        motions = self.motions(x)
        if motions is None:
            raise AnalysisError(self.failures[-1])
        tables = []
        for o, motion, used in zip(self.observations, motions, self.used, strict=True):
            table = np.full(o.values.shape, np.nan)
            for delay, group in self._delay_groups(o, x):
                rows = np.flatnonzero(np.any(used[:, group], axis=1))
                samples = motion.at(o.times[rows] - delay)
                for j in group:
                    table[rows, j] = samples.values(o.measures[j])
            tables.append(np.where(used, table, np.nan))
        return tables

    def residual(self, x: np.ndarray) -> np.ndarray:
        """(N,) residuals in standard deviations; infinite if a run fails."""
        try:
            predicted = self.predicted(x)
        except AnalysisError:
            return np.full(self.size, np.inf)
        parts = zip(predicted, self.observations, self.noise, self.used, strict=True)
        return np.concatenate([((m - o.values) / s)[u] for m, o, s, u in parts])

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """(N, n) exact derivatives of the residuals.

        Raises
        ------
        AnalysisError
            A run fails.
        """
        motions = self.motions(x)
        if motions is None:
            raise AnalysisError(self.failures[-1])
        rows = []
        for e, (o, motion) in enumerate(zip(self.observations, motions, strict=True)):
            table = self._gradient_table(e, o, motion, x)
            scaled = table / self.noise[e][:, :, None]
            rows.append(scaled[self.used[e]])
        return np.vstack(rows)

    def _gradient_table(self, e: int, o: Observation, motion: Result, x: np.ndarray) -> np.ndarray:
        """(K, columns, n) derivatives of the measures of one experiment."""
        where, used = self.unknowns.where[e], self.used[e]
        table = np.zeros((*o.values.shape, x.size))
        for delay, group in self._delay_groups(o, x):
            rows = np.flatnonzero(np.any(used[:, group], axis=1))
            if not rows.size:
                continue
            samples = motion.at(o.times[rows] - delay)
            if where:
                gradients = history_gradients(samples, [o.measures[j] for j in group], list(where))
                for j, columns in zip(group, gradients, strict=True):
                    table[rows[:, None], j, np.array(list(where.values()))] = columns
            for j in group:
                if o.columns[j] in self.unknowns.delays:
                    table[rows, j, self.unknowns.delays[o.columns[j]]] = -history_rates(
                        samples, o.measures[j]
                    )
        return table

    def _delay_groups(self, o: Observation, x: np.ndarray) -> list[tuple[float, list[int]]]:
        """Distinct delays, each with its columns."""
        delays = [self.unknowns.delay(c, x) for c in o.columns]
        return [
            (d, [j for j, delay in enumerate(delays) if delay == d]) for d in dict.fromkeys(delays)
        ]
