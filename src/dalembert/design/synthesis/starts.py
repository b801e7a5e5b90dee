"""Starts of a synthesis: exact linkages for poses, closed forms for functions, or the atlas.

For function generation, initial positions of crank and output are taken from a grid; three
coefficients of the linkage then follow from linear least squares (Freudenstein 1955). The best
linkages of the grid are improved together by the Levenberg–Marquardt method.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from dalembert.design.synthesis.atlas import Start, linkage_atlas
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.pose_linkages import PoseLinkage, pose_linkages
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError

MAX_POSES = 5
"""Upper limit of poses with exact linkages."""
GRID = 48
"""Number of initial positions of crank and of output."""
MAX_SLIDER_POSITION = 4.0
"""Upper limit of the initial slider position, in strokes."""
IMPROVED = 600
"""Number of linkages of the grid that are improved."""
ROUNDS = 40
"""Number of Levenberg–Marquardt iterations."""
STEP = 1e-6
"""Difference step of logarithms of lengths and of angles."""
MIN_DISTANCE = 0.3
"""Lower limit of the distance of two starts, in logarithms of lengths and in angles."""


def check_starts(starts: int) -> None:
    """Refuse an invalid number of starts.

    Raises
    ------
    AnalysisError
        It is no positive integer.
    """
    if not isinstance(starts, (int, np.integer)) or isinstance(starts, bool) or starts < 1:
        raise AnalysisError(
            f"starts is a number of optimised starts, at least 1, got {starts!r:.30}"
        )


def no_convergence(starts: int) -> str:
    """Beginning of the message about a search without a solution."""
    return "its start does not converge" if starts == 1 else f"none of {starts} starts converges"


def starts_of(
    kind: type[Linkage],
    target: Target,
    bounds: Mapping[str, tuple[float, float]],
    crank_turns: bool,
    count: int,
    rng: np.random.Generator,
    report: Callable[[float], None] = lambda fraction: None,
) -> list[Start]:
    """Starts of a synthesis.

    Functions start from closed forms, motions through up to five poses from Burmester dyads, paths
    from the atlas, whose completed fraction is reported.
    """
    if target.points is None:
        exact = function_starts(kind, target, bounds, crank_turns, -(-3 * count // 4))
        return exact + _random_starts(kind, target, count - len(exact), rng)
    exact = _pose_starts(kind, target, crank_turns, -(-count // 2))
    return exact + linkage_atlas(kind).nearest(target, count - len(exact), report)


def _pose_starts(kind: type[Linkage], target: Target, crank_turns: bool, count: int) -> list[Start]:
    """Exact linkages through a few poses with free timing."""
    has_timing = target.crank_angles is not None
    if (
        has_timing
        or target.coupler_angles is None
        or target.points is None
        or len(target) > MAX_POSES
    ):
        return []
    try:
        linkages = pose_linkages(target.points, target.coupler_angles).linkages
    except AnalysisError:  # two poses are equal
        return []
    matching = [candidate for candidate in linkages if isinstance(candidate.linkage, kind)]
    matching.sort(
        key=lambda candidate: (
            len(candidate.defects),
            crank_turns and not candidate.linkage.crank_turns,
        )
    )
    return [_start(candidate) for candidate in matching[:count]]


def _start(candidate: PoseLinkage) -> Start:
    """Start with the sense of rotation of the shorter way through the crank angles."""
    senses = {s: float(np.sum(np.diff(s * candidate.crank_angles) % (2 * np.pi))) for s in (1, -1)}
    sense = min(senses, key=lambda s: senses[s])
    steps = sense * (np.diff(sense * candidate.crank_angles) % (2 * np.pi))
    theta = candidate.crank_angles[0] + np.concatenate([[0.0], np.cumsum(steps)])
    return Start(candidate.linkage, theta, sense, candidate.residual)


def _random_starts(
    kind: type[Linkage], target: Target, count: int, rng: np.random.Generator
) -> list[Start]:
    q, branch = kind.random_dimensions(rng, count), rng.choice([-1, 1], count)
    timing = np.zeros(len(target)) if target.crank_angles is None else target.crank_angles
    initial_angles = rng.uniform(0, 2 * np.pi, count)
    return [
        Start(
            kind(**{n: float(v[k]) for n, v in q.items()}, branch=int(branch[k])),
            timing + initial_angles[k],
            1,
            np.inf,
        )
        for k in range(count)
    ]


def function_starts(
    kind: type[Linkage],
    target: Target,
    bounds: Mapping[str, tuple[float, float]],
    crank_turns: bool,
    count: int,
) -> list[Start]:
    """Starts for function generation, sorted by error; linkages with rotating cranks first."""
    assert target.crank_angles is not None and target.outputs is not None
    family = _Family(kind, target.crank_angles, target.outputs, bounds)
    angles = np.arange(GRID) * 2 * np.pi / GRID
    stroke = float(np.ptp(target.outputs)) or 1.0
    outputs = (
        angles
        if kind.output_is_angle
        else np.linspace(-MAX_SLIDER_POSITION, MAX_SLIDER_POSITION, GRID) * stroke
    )
    first, offset = (a.ravel() for a in np.meshgrid(angles, outputs, indexing="ij"))
    q = kind.fitted_dimensions(
        first[:, None] + target.crank_angles, offset[:, None] + target.outputs
    )
    candidates = []
    for branch in (1, -1):
        x = family.improve(family.pack(q, first), branch)
        error = np.sum(family.residual(x, branch) ** 2, axis=1)
        rocks = np.logical_not(_rotates(kind, family.dimensions(x))) & crank_turns
        candidates += [(bool(rocks[k]), float(error[k]), branch, x[k]) for k in range(len(x))]
    candidates.sort(key=lambda entry: entry[:2])
    chosen: list[tuple[int, np.ndarray, float]] = []
    for _, error_of, branch, x_of in candidates:
        is_close = any(b == branch and np.max(abs(x_of - y)) < MIN_DISTANCE for b, y, _ in chosen)
        if len(chosen) < count and not is_close:
            chosen.append((branch, x_of, error_of))
    return [family.start(*entry) for entry in chosen]


@dataclass(frozen=True, eq=False)
class _Family:
    """Linkages (k,) of one kind for a function; their unknowns are logarithms of lengths, other
    dimensions, and the crank angle at the start."""

    kind: type[Linkage]
    timing: np.ndarray
    outputs: np.ndarray
    bounds: Mapping[str, tuple[float, float]]

    @property
    def names(self) -> list[str]:
        """Dimensions that a function depends on."""
        return [n for n in self.kind.names() if self.bounds[n][0] < self.bounds[n][1]]

    def pack(self, q: dict[str, np.ndarray], first: np.ndarray) -> np.ndarray:
        """(k, unknowns) of the linkages with real dimensions."""
        columns = [np.log(q[n]) if n in self.kind.lengths else q[n] for n in self.names]
        x = np.stack([*columns, first], axis=1)
        return self.clip(x[np.all(np.isfinite(x), axis=1)])

    def clip(self, x: np.ndarray) -> np.ndarray:
        """Unknowns clipped to the bounds."""
        x = x.copy()
        for k, name in enumerate(self.names):
            low, high = self.bounds[name]
            if name in self.kind.lengths:
                low, high = np.log(max(low, 1e-6)), np.log(high)
            x[:, k] = np.clip(x[:, k], low, high)
        return x

    def dimensions(self, x: np.ndarray) -> dict[str, np.ndarray]:
        """Dimension → (k,) values."""
        dimensions = {n: np.full(len(x), self.bounds[n][0]) for n in self.kind.names()}
        for k, name in enumerate(self.names):
            dimensions[name] = np.exp(x[:, k]) if name in self.kind.lengths else x[:, k]
        return dimensions

    def start(self, branch: int, x: np.ndarray, error: float) -> Start:
        """The start of one linkage."""
        numbers = {name: float(values[0]) for name, values in self.dimensions(x[None, :]).items()}
        return Start(self.kind(**numbers, branch=branch), self.timing + x[-1], 1, error)

    def residual(self, x: np.ndarray, branch: int) -> np.ndarray:
        """(k, n) deviations of the outputs from their mean; NaN if a loop is open."""
        q = {name: values[:, None] for name, values in self.dimensions(x).items()}
        with np.errstate(all="ignore"):
            deviation = self.kind.loop(q, branch, self.timing + x[:, -1:])[1] - self.outputs
        deviation = np.unwrap(deviation, axis=1) if self.kind.output_is_angle else deviation
        return np.asarray(deviation - deviation.mean(axis=1, keepdims=True))

    def improve(self, x: np.ndarray, branch: int) -> np.ndarray:
        """The best linkages after Levenberg–Marquardt iterations, vectorised."""
        residuals = self.residual(x, branch)
        error = np.nan_to_num(np.sum(residuals**2, axis=1), nan=np.inf)
        best = np.argsort(error)[:IMPROVED]
        best = best[np.isfinite(error[best])]
        x, residuals, error = x[best], residuals[best], error[best]
        damping, unit = np.full(len(x), 1e-2), np.eye(x.shape[1])
        for _ in range(ROUNDS):
            slopes = [(self.residual(x + STEP * e, branch) - residuals) / STEP for e in unit]
            jacobian = np.nan_to_num(np.stack(slopes, axis=2))
            normal = np.einsum("kni,knj->kij", jacobian, jacobian)
            scale = np.maximum(np.einsum("kii->k", normal), 1e-12)[:, None, None]
            gradient = np.einsum("kni,kn->ki", jacobian, residuals)
            step = np.linalg.solve(
                normal + damping[:, None, None] * scale * unit, gradient[..., None]
            )
            trial = self.clip(x - np.clip(step[..., 0], -0.5, 0.5))
            trial_residuals = self.residual(trial, branch)
            value = np.nan_to_num(np.sum(trial_residuals**2, axis=1), nan=np.inf)
            accepted = value < error
            x[accepted], residuals[accepted], error[accepted] = (
                trial[accepted],
                trial_residuals[accepted],
                value[accepted],
            )
            damping = np.clip(np.where(accepted, damping / 5, damping * 4), 1e-12, 1e3)
        return x


def _rotates(kind: type[Linkage], q: dict[str, np.ndarray]) -> np.ndarray:
    """(k,) whether the crank rotates fully."""
    with np.errstate(all="ignore"):
        return np.asarray(
            np.all([np.asarray(row) >= 0 for row in kind.rotation_conditions(q, 0.0)], axis=0)
        )
