"""A set of designs of which none is better in all aims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np


def best_of(values: np.ndarray) -> np.ndarray:
    """Numbers of the rows that no other row is as good as in all columns and better in one."""
    kept = []
    for k, row in enumerate(values):
        beaten = np.all(values <= row, axis=1) & np.any(values < row, axis=1)
        same = np.all(values[:k] == row, axis=1)
        if not beaten.any() and not same.any():
            kept.append(k)
    return np.array(kept, dtype=int)


@dataclass(eq=False)
class Front:
    """Result of ``pareto``.

    Attributes
    ----------
    labels, units : of the aims
    names : of the parameters
    values : (points, aims), along the first aim
    designs : (points, parameters)
    message : how it was found
    runs : of the analysis
    """

    labels: list[str]
    units: list[str]
    names: list[str]
    values: np.ndarray
    designs: np.ndarray
    senses: list[float]
    message: str
    runs: int = 0
    gradients: int = 0
    failed: list[str] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.values)

    def design(self, k: int) -> dict[str, float]:
        """Parameter values of a point."""
        return dict(zip(self.names, map(float, self.designs[k]), strict=True))

    def hypervolume(self, reference: Sequence[float]) -> float:
        """Area up to a reference that the front beats, for two aims: larger is better.

        Raises
        ------
        ValueError
            There are more than two aims.
        """
        if self.values.shape[1] != 2:
            raise ValueError("the hypervolume is here for two aims")
        points = self.values * self.senses
        limit = np.asarray(reference, dtype=float) * self.senses
        points = points[np.all(points < limit, axis=1)]
        points = points[np.argsort(points[:, 0])]
        edges = np.append(points[1:, 0], limit[0])
        return float(np.sum((edges - points[:, 0]) * (limit[1] - points[:, 1])))

    def to_dataframe(self) -> Any:
        """One row a point: aims, then parameters."""
        import pandas as pd

        return pd.DataFrame(
            np.hstack([self.values, self.designs]), columns=[*self.labels, *self.names]
        )

    def plot(self, ax: Any = None) -> Any:
        """The first two aims against each other; returns the axes."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots(figsize=(5, 3.8), layout="constrained")
        ax.plot(self.values[:, 0], self.values[:, 1], marker="o", ms=4, lw=1)
        shown = [
            f"{label} [{unit}]" if unit else label
            for label, unit in zip(self.labels, self.units, strict=True)
        ]
        ax.set(xlabel=shown[0], ylabel=shown[1])
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
        return ax

    def __repr__(self) -> str:
        return f"<Front of {len(self)} designs: {', '.join(self.labels)}; {self.message}>"
