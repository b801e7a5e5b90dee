"""The misfit ``r = (m(t − τ; p) − y)/σ`` of a model to its data, and its exact Jacobian."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.design.identification.experiment import Observation
from dalembert.design.identification.unknowns import Unknowns
from dalembert.errors import AnalysisError, ModelError
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.sensitivity.gradient import history_gradients, history_rates
from dalembert.symbolic.parametric_model import ParametricModel


@dataclass
class Misfit:
    """Residuals of all experiments as functions of the unknowns.

    Parameters
    ----------
    used : for each experiment (K, columns), the samples that count
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
        self.used = [self._used(o) for o in self.observations]
        self.noise = [np.ones_like(o.values) for o in self.observations]

    def _used(self, o: Observation) -> np.ndarray:
        """Samples that are there, and inside the run whatever the delay."""
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
        """Runs of all experiments; None where one fails, with the reason kept."""
        key = np.asarray(x, dtype=float).tobytes()
        if self._last[0] != key:
            self._last = key, self._run(x)
        return self._last[1]

    def _run(self, x: np.ndarray) -> list[Result] | None:
        found: list[Result] = []
        for e, o in enumerate(self.observations):
            given = {**o.experiment.parameters, **self.unknowns.parameters(e, x)}
            self.runs += 1
            try:
                motion = o.analysis.run(self.model, given)
            except (AnalysisError, ModelError) as error:  # such as a mass below zero
                self.failures.append(f"{o.name}: {error}")
                return None
            if motion.status.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            if not motion.status.success:
                self.failures.append(f"{o.name}: {motion.status}")
                return None
            found.append(motion)
        return found

    def predicted(self, x: np.ndarray) -> list[np.ndarray]:
        """(K, columns) measures of each experiment, NaN where no sample is used.

        Raises
        ------
        AnalysisError
            A run fails.
        """
        motions = self.motions(x)
        if motions is None:
            raise AnalysisError(self.failures[-1])
        made = []
        for o, motion, used in zip(self.observations, motions, self.used, strict=True):
            table = np.full(o.values.shape, np.nan)
            for delay, group in self._groups(o, x):
                rows = np.flatnonzero(np.any(used[:, group], axis=1))
                at = motion.at(o.times[rows] - delay)
                for j in group:
                    table[rows, j] = at.values(o.measures[j])
            made.append(np.where(used, table, np.nan))
        return made

    def residual(self, x: np.ndarray) -> np.ndarray:
        """(N,) residuals in standard deviations; infinite where a run fails."""
        try:
            found = self.predicted(x)
        except AnalysisError:
            return np.full(self.size, np.inf)
        parts = zip(found, self.observations, self.noise, self.used, strict=True)
        return np.concatenate([((m - o.values) / s)[u] for m, o, s, u in parts])

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """(N, n) derivatives of the residuals, from the exact gradients of all samples.

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
            table = self._table(e, o, motion, x)
            scaled = table / self.noise[e][:, :, None]
            rows.append(scaled[self.used[e]])
        return np.vstack(rows)

    def _table(self, e: int, o: Observation, motion: Result, x: np.ndarray) -> np.ndarray:
        """(K, columns, n) derivatives of the measures of one experiment."""
        where, used = self.unknowns.where[e], self.used[e]
        table = np.zeros((*o.values.shape, x.size))
        for delay, group in self._groups(o, x):
            rows = np.flatnonzero(np.any(used[:, group], axis=1))
            if not rows.size:
                continue
            at = motion.at(o.times[rows] - delay)
            if where:
                found = history_gradients(at, [o.measures[j] for j in group], list(where))
                for j, columns in zip(group, found, strict=True):
                    table[rows[:, None], j, np.array(list(where.values()))] = columns
            for j in group:
                if o.columns[j] in self.unknowns.delays:
                    table[rows, j, self.unknowns.delays[o.columns[j]]] = -history_rates(
                        at, o.measures[j]
                    )
        return table

    def _groups(self, o: Observation, x: np.ndarray) -> list[tuple[float, list[int]]]:
        """Delays, and the columns that have them."""
        delays = [self.unknowns.delay(c, x) for c in o.columns]
        return [(d, [j for j, own in enumerate(delays) if own == d]) for d in dict.fromkeys(delays)]
