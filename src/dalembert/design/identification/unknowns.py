"""Unknowns of an identification and their assignment to experiments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.design.identification.experiment import Observation
from dalembert.errors import AnalysisError, ModelError
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
