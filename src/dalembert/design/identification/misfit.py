"""Misfit ``r = (m(t − τ; p) − y)/σ`` of a model to data over the unknowns, and its Jacobian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.design.identification.experiment import Observation
from dalembert.errors import AnalysisError, ModelError
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.sensitivity.gradient import history_gradients, history_rates
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown

Delays = Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class Unknowns:
    """Shared parameters, parameters of single experiments, and delays.

    Attributes
    ----------
    labels : of all unknowns; ``phi0[experiment 2]`` for one of a single experiment
    start, lower, upper : (n,)
    where : for each experiment, parameter → index of its unknown
    delays : column → index of its delay
    """

    labels: tuple[str, ...]
    start: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    where: tuple[dict[str, int], ...]
    delays: dict[str, int]

    def parameters(self, e: int, x: np.ndarray) -> dict[str, float]:
        """Values of the unknown parameters of an experiment."""
        return {name: float(x[k]) for name, k in self.where[e].items()}

    def delay(self, column: str, x: np.ndarray) -> float:
        """Delay of the signal of a column [s]."""
        return float(x[self.delays[column]]) if column in self.delays else 0.0

    def sizes(self, x: np.ndarray) -> np.ndarray:
        """(n,) scales of the unknowns: the value, or the range of the bounds if it is zero."""
        size, width = np.maximum(abs(x), abs(self.start)), self.upper - self.lower
        return np.where(size > 0, size, np.where(np.isfinite(width) & (width > 0), width, 1.0))


def make_unknowns(
    model: ParametricModel,
    observations: Sequence[Observation],
    vary: Sequence[str],
    start: Mapping[str, float],
    delays: Delays,
) -> Unknowns:
    """Unknowns with the bounds and nominal values of the model.

    Raises
    ------
    ModelError, AnalysisError
        Unknown names, nothing to vary, or invalid bounds of a delay.
    """
    labels: list[tuple[str, str]] = [(name, name) for name in dict.fromkeys(vary)]
    where: list[dict[str, int]] = []
    for o in observations:
        fixed, own = (
            o.experiment.parameters,
            list(dict.fromkeys(o.experiment.own)),
        )
        for name in (*fixed, *own):
            if name not in model.parameters:
                raise ModelError(f"{o.name}: {unknown('parameter', name, model.parameters)}")
        indices = {n: k for k, (n, _) in enumerate(labels[: len(set(vary))]) if n not in fixed}
        for name in own:
            indices[name] = len(labels)
            labels.append((name, f"{name}[{o.name}]"))
        where.append(indices)
    for name in vary:
        if name not in model.parameters:
            raise ModelError(unknown("parameter to vary", name, model.parameters))
    for name in start:
        if name not in model.parameters:
            raise ModelError(f"start: {unknown('parameter', name, model.parameters)}")
    bounds = [model.parameters[name].bounds for name, _ in labels]
    values = [float(start.get(name, model.parameters[name].value)) for name, _ in labels]
    columns = {c for o in observations for c in o.columns}
    delay_indices = {}
    for column, (low, high) in delays.items():
        if column not in columns:
            raise AnalysisError(f"delays: {unknown('column', column, columns)}")
        if not low < high:
            raise AnalysisError(f"delays: the bounds {low}, {high} of {column!r} are not in order")
        delay_indices[column] = len(labels)
        labels.append((column, f"delay({column})"))
        bounds.append((low, high))
        values.append(min(max(0.0, low), high))
    if not labels:
        raise AnalysisError("nothing to identify: name parameters with vary=...")
    low_high = np.array(bounds, dtype=float)
    texts = tuple(label for _, label in labels)
    initial = np.clip(values, low_high[:, 0], low_high[:, 1])
    return Unknowns(texts, initial, low_high[:, 0], low_high[:, 1], tuple(where), delay_indices)


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
