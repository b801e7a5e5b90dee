"""Atlas of coupler curves, searched for curves with the shape of a target.

Closed paths are compared by Fourier descriptors: the moduli of the Fourier coefficients over the
arc length, which are invariant to translation, scale, rotation and starting point. Open paths, and
paths with prescribed timing, are compared with segments of all curves.
Source: I. Ullah, S. Kota (1997), Journal of Mechanical Design 119, 504-510.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from dalembert.analysis.progress import part_of
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.target import Target

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

COUNT, SAMPLES, HARMONICS = 4096, 72, 6
"""Numbers of linkages, of samples per revolution, and of Fourier coefficients."""
SEGMENTS = (0.15, 0.25, 0.35, 0.5, 0.65, 0.8, 0.95)
"""Lengths of segments of curves, in revolutions of the crank."""


@dataclass(frozen=True, eq=False)
class Start:
    """A linkage near the target, with crank angles at its entries and its distance."""

    linkage: Linkage
    theta: np.ndarray
    sense: int
    distance: float


@dataclass(frozen=True, eq=False)
class Atlas:
    """Linkages of unit size with their coupler curves.

    Attributes
    ----------
    kind : class of the linkages
    q, branch : dimensions (n,) by name, and branches (n,)
    curves : (n, SAMPLES) coupler points in one revolution
    """

    kind: type[Linkage]
    q: dict[str, np.ndarray]
    branch: np.ndarray
    curves: np.ndarray

    def nearest(
        self, target: Target, count: int, report: Callable[[float], None] = lambda fraction: None
    ) -> list[Start]:
        """Linkages, transformed by similarities, that are nearest to the points of a target.

        Parameters
        ----------
        report : called with the completed fraction
        """
        if target.closed and target.crank_angles is None:
            return self._closed(target, count)
        z = target.complex_points
        pick = np.unique(np.linspace(0, len(z) - 1, min(len(z), 9)).astype(int))
        candidates = []
        segments = self._segments(target, len(z))
        total = len(segments) * (1 if target.crank_angles is not None else 2)
        for number, (sense, positions) in enumerate(segments):
            report(number / total)
            samples = np.rint(positions * SAMPLES).astype(int) % SAMPLES
            _, distance = fit_similarity(self.curves[:, samples[pick]], z[pick])
            for k in np.argsort(distance)[: max(4, count // 4)]:
                candidates.append((distance[k], k, sense, samples, 2 * np.pi * positions))
        if target.crank_angles is None:
            candidates += self._segments_by_length(z, pick, count, part_of(report, 0.5, 1.0))
        candidates.sort(key=lambda entry: entry[0])
        return self._distinct(candidates, z, count)

    def _segments(self, target: Target, size: int) -> list[tuple[int, np.ndarray]]:
        """Sense of rotation, and positions of the entries on the curves in revolutions."""
        starts = np.arange(0, 1, 1 / 24)
        if target.crank_angles is not None:
            timing = (target.crank_angles - target.crank_angles[0]) / (2 * np.pi)
            return [(1, start + timing) for start in starts]
        even = np.linspace(0, 1, size)
        return [(s, b + s * even * length) for b in starts for length in SEGMENTS for s in (1, -1)]

    def _segments_by_length(
        self, z: np.ndarray, pick: np.ndarray, count: int, report: Callable[[float], None]
    ) -> list:
        """Segments with the distances of the target along the curve between entries."""
        arc_length = np.concatenate([[0.0], np.cumsum(abs(np.diff(z)))])
        arc_length /= arc_length[-1] or 1.0
        curves, theta = self._resampled
        candidates = []
        for start in np.arange(0, 1, 1 / 24):
            report(float(start))
            for length in SEGMENTS:
                for sense in (1, -1):
                    positions = start + sense * length * arc_length
                    samples = np.rint(positions * SAMPLES).astype(int) % SAMPLES
                    _, distance = fit_similarity(curves[:, samples[pick]], z[pick])
                    for k in np.argsort(distance)[: max(4, count // 4)]:
                        angles = np.unwrap(theta[k][samples], period=2 * np.pi)
                        candidates.append((distance[k], k, sense, samples, angles))
        return candidates

    def _closed(self, target: Target, count: int) -> list[Start]:
        z = target.complex_points
        steps = np.abs(np.diff(np.append(z, z[0])))
        arc_length = np.concatenate([[0.0], np.cumsum(steps)[:-1]]) / steps.sum()
        _, nearest = self._tree.query(descriptors(resample_by_length(z[None, :])[0])[0], k=96)
        candidates = []
        curves, theta = (array[nearest] for array in self._resampled)
        for sense in (1, -1):
            for shift in np.arange(0, 1, 1 / 36):
                samples = np.rint((shift + sense * arc_length) * SAMPLES).astype(int) % SAMPLES
                _, distance = fit_similarity(curves[:, samples], z)
                for k in np.argsort(distance)[:4]:
                    angles = np.unwrap(theta[k][samples], period=2 * np.pi)
                    candidates.append((distance[k], nearest[k], sense, None, angles))
        candidates.sort(key=lambda entry: entry[0])
        return self._distinct(candidates, z, count)

    def _distinct(self, candidates: list, z: np.ndarray, count: int) -> list[Start]:
        """The best segment of each linkage."""
        starts: dict[int, Start] = {}
        for distance, k, sense, _, theta in candidates:
            if k in starts or len(starts) == count:
                continue
            q = {name: values[k] for name, values in self.q.items()}
            curve = self.kind.points(q, self.branch[k], theta)
            ratio, _ = fit_similarity(curve[None, :], z)
            rotation = float(np.angle(ratio[0]))
            offset = np.mean(z) - ratio[0] * np.mean(curve)
            unit = self.kind(**q, branch=int(self.branch[k]))
            scaled = unit.scaled(float(abs(ratio[0])), complex(offset))
            transformed = type(scaled)(
                **{**scaled.numbers, "angle": rotation}, branch=scaled.branch
            )
            starts[k] = Start(transformed, theta + rotation, sense, float(distance))
        return list(starts.values())

    @property
    def _resampled(self) -> tuple[np.ndarray, np.ndarray]:
        return _resampled(self.kind)

    @property
    def _tree(self) -> cKDTree:
        return _tree(self.kind)


def fit_similarity(curves: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficient ``b`` and rms distance of the best similarity ``a + b·curve ≈ z``."""
    w = curves - curves.mean(axis=1, keepdims=True)
    centred = z - z.mean()
    power = np.maximum((abs(w) ** 2).sum(axis=1), 1e-12)
    ratio = (w.conj() @ centred) / power
    distance = np.sqrt(np.maximum((abs(centred) ** 2).sum() - abs(ratio) ** 2 * power, 0) / z.size)
    return ratio, distance


def resample_by_length(curves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Closed curves resampled at equal steps of arc length, and the curve parameters there."""
    closed_curves = np.concatenate([curves, curves[:, :1]], axis=1)
    arc_lengths = np.concatenate(
        [np.zeros((len(curves), 1)), np.cumsum(abs(np.diff(closed_curves, axis=1)), axis=1)], axis=1
    )
    angles = np.linspace(0, 2 * np.pi, closed_curves.shape[1])
    resampled, parameters = [], []
    for row, length in zip(closed_curves, arc_lengths, strict=True):
        positions = np.arange(SAMPLES) / SAMPLES * length[-1]
        resampled.append(
            np.interp(positions, length, row.real) + 1j * np.interp(positions, length, row.imag)
        )
        parameters.append(np.interp(positions, length, angles))
    return np.array(resampled), np.array(parameters)


def descriptors(curves: np.ndarray) -> np.ndarray:
    """Moduli of the coefficients; those of an order are sorted, independent of the sense."""
    moduli = np.abs(np.fft.fft(curves, axis=1))
    orders = np.arange(1, HARMONICS + 1)
    pair = np.stack([moduli[:, orders], moduli[:, -orders]])
    norm = np.sqrt((pair**2).sum(axis=(0, 2)))[:, None]
    larger = np.argmax(pair[:, :, 0], axis=0)
    rows = np.arange(len(curves))
    return np.concatenate([pair[larger, rows], pair[1 - larger, rows]], axis=1) / norm


@lru_cache(maxsize=4)
def linkage_atlas(kind: type[Linkage]) -> Atlas:
    """The atlas of a class of linkages, built on first use."""
    rng = np.random.default_rng(0)
    q, branch = kind.random_dimensions(rng, COUNT), rng.choice([-1, 1], COUNT)
    theta = np.arange(SAMPLES) * 2 * np.pi / SAMPLES
    columns = {name: values[:, None] for name, values in q.items()}
    curves = kind.points(columns, branch[:, None], theta[None, :])
    finite = np.isfinite(curves).all(axis=1)
    return Atlas(kind, {n: v[finite] for n, v in q.items()}, branch[finite], curves[finite])


@lru_cache(maxsize=4)
def _tree(kind: type[Linkage]) -> cKDTree:
    from scipy.spatial import cKDTree

    return cKDTree(descriptors(_resampled(kind)[0]))


@lru_cache(maxsize=4)
def _resampled(kind: type[Linkage]) -> tuple[np.ndarray, np.ndarray]:
    """Curves resampled at equal steps of arc length, and the crank angles there."""
    return resample_by_length(linkage_atlas(kind).curves)
