"""Starts for function generation: closed forms on a grid of unknown starting positions.

For given starting positions of crank and output, three coefficients of the linkage follow from
linear least squares (Freudenstein 1955). The best linkages of the grid are improved together by the
Levenberg–Marquardt method.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dalembert.design.synthesis.atlas import Start
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.target import Target

GRID = 48
"""Starting positions of crank and of output."""
REACH = 4.0
"""Largest distance of a slider from its origin, in strokes."""
IMPROVED = 600
"""Linkages of the grid that are improved."""
ROUNDS = 40
STEP = 1e-6
"""Difference step of logarithms of lengths and of angles."""
APART = 0.3
"""Distance of two starts in logarithms of lengths and in angles."""


def function_starts(
    kind: type[Linkage],
    target: Target,
    bounds: Mapping[str, tuple[float, float]],
    crank_turns: bool,
    count: int,
) -> list[Start]:
    """Linkages near a function, the best first; those whose crank turns by preference."""
    assert target.crank_angles is not None and target.outputs is not None
    family = _Family(kind, target.crank_angles, target.outputs, bounds)
    begins = np.arange(GRID) * 2 * np.pi / GRID
    stroke = float(np.ptp(target.outputs)) or 1.0
    outputs = begins if kind.output_is_angle else np.linspace(-REACH, REACH, GRID) * stroke
    first, offset = (a.ravel() for a in np.meshgrid(begins, outputs, indexing="ij"))
    q = kind.fitted(first[:, None] + target.crank_angles, offset[:, None] + target.outputs)
    found = []
    for branch in (1, -1):
        x = family.improved(family.packed(q, first), branch)
        error = np.sum(family.residual(x, branch) ** 2, axis=1)
        stays = np.logical_not(_turn(kind, family.dimensions(x))) & crank_turns
        found += [(bool(stays[k]), float(error[k]), branch, x[k]) for k in range(len(x))]
    found.sort(key=lambda one: one[:2])
    chosen: list[tuple[int, np.ndarray, float]] = []
    for _, error_of, branch, x_of in found:
        near = any(b == branch and np.max(abs(x_of - y)) < APART for b, y, _ in chosen)
        if len(chosen) < count and not near:
            chosen.append((branch, x_of, error_of))
    return [family.start(*one) for one in chosen]


@dataclass(frozen=True, eq=False)
class _Family:
    """Linkages (k,) of one kind for a function; their unknowns are logarithms of lengths, other
    dimensions, and the crank angle at the start."""

    kind: type[Linkage]
    given: np.ndarray
    wanted: np.ndarray
    bounds: Mapping[str, tuple[float, float]]

    @property
    def names(self) -> list[str]:
        """Dimensions that a function depends on."""
        return [n for n in self.kind.names() if self.bounds[n][0] < self.bounds[n][1]]

    def packed(self, q: dict[str, np.ndarray], first: np.ndarray) -> np.ndarray:
        """(k, unknowns) of the linkages that are real."""
        columns = [np.log(q[n]) if n in self.kind.lengths else q[n] for n in self.names]
        x = np.stack([*columns, first], axis=1)
        return self.clipped(x[np.all(np.isfinite(x), axis=1)])

    def clipped(self, x: np.ndarray) -> np.ndarray:
        """Within the bounds."""
        x = x.copy()
        for k, name in enumerate(self.names):
            low, high = self.bounds[name]
            if name in self.kind.lengths:
                low, high = np.log(max(low, 1e-6)), np.log(high)
            x[:, k] = np.clip(x[:, k], low, high)
        return x

    def dimensions(self, x: np.ndarray) -> dict[str, np.ndarray]:
        """Dimension → (k,) values."""
        made = {n: np.full(len(x), self.bounds[n][0]) for n in self.kind.names()}
        for k, name in enumerate(self.names):
            made[name] = np.exp(x[:, k]) if name in self.kind.lengths else x[:, k]
        return made

    def start(self, branch: int, x: np.ndarray, error: float) -> Start:
        """One of them."""
        numbers = {name: float(values[0]) for name, values in self.dimensions(x[None, :]).items()}
        return Start(self.kind(**numbers, branch=branch), self.given + x[-1], 1, error)

    def residual(self, x: np.ndarray, branch: int) -> np.ndarray:
        """(k, n) deviations of the outputs about their mean; NaN where a loop is open."""
        q = {name: values[:, None] for name, values in self.dimensions(x).items()}
        with np.errstate(all="ignore"):
            off = self.kind.loop(q, branch, self.given + x[:, -1:])[1] - self.wanted
        off = np.unwrap(off, axis=1) if self.kind.output_is_angle else off
        return np.asarray(off - off.mean(axis=1, keepdims=True))

    def improved(self, x: np.ndarray, branch: int) -> np.ndarray:
        """The best of them after some steps of Levenberg and Marquardt, all at once."""
        off = self.residual(x, branch)
        error = np.nan_to_num(np.sum(off**2, axis=1), nan=np.inf)
        best = np.argsort(error)[:IMPROVED]
        best = best[np.isfinite(error[best])]
        x, off, error = x[best], off[best], error[best]
        damping, unit = np.full(len(x), 1e-2), np.eye(x.shape[1])
        for _ in range(ROUNDS):
            slopes = [(self.residual(x + STEP * e, branch) - off) / STEP for e in unit]
            jacobian = np.nan_to_num(np.stack(slopes, axis=2))
            normal = np.einsum("kni,knj->kij", jacobian, jacobian)
            size = np.maximum(np.einsum("kii->k", normal), 1e-12)[:, None, None]
            right = np.einsum("kni,kn->ki", jacobian, off)
            step = np.linalg.solve(normal + damping[:, None, None] * size * unit, right[..., None])
            trial = self.clipped(x - np.clip(step[..., 0], -0.5, 0.5))
            there = self.residual(trial, branch)
            value = np.nan_to_num(np.sum(there**2, axis=1), nan=np.inf)
            good = value < error
            x[good], off[good], error[good] = trial[good], there[good], value[good]
            damping = np.clip(np.where(good, damping / 5, damping * 4), 1e-12, 1e3)
        return x


def _turn(kind: type[Linkage], q: dict[str, np.ndarray]) -> np.ndarray:
    """(k,) whether the crank turns."""
    with np.errstate(all="ignore"):
        return np.asarray(np.all([np.asarray(row) >= 0 for row in kind.turns(q, 0.0)], axis=0))
