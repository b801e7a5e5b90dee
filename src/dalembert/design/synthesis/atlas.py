"""An atlas of coupler curves, searched for those alike in shape to a target.

Closed paths are compared by Fourier descriptors: the moduli of the coefficients of the curve by its
arc length, which do not change with place, size, turn and starting point. Pieces of path, and paths
with prescribed timing, are compared with pieces of all curves.
Source: I. Ullah, S. Kota (1997), Journal of Mechanical Design 119, 504-510.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.target import Target

COUNT, SAMPLES, HARMONICS = 4096, 72, 6
PIECES = (0.15, 0.25, 0.35, 0.5, 0.65, 0.8, 0.95)
"""Lengths of the pieces of curves, in turns of the crank."""


@dataclass(frozen=True, eq=False)
class Start:
    """A linkage near the target, the crank angles for its entries, and how far off it is."""

    linkage: Linkage
    theta: np.ndarray
    sense: int
    distance: float


@dataclass(frozen=True, eq=False)
class Atlas:
    """Linkages of unit size with their curves.

    Attributes
    ----------
    kind : of linkage
    q, branch : dimensions (n,) by name, and branches (n,)
    curves : (n, SAMPLES) coupler points in one turn
    """

    kind: type[Linkage]
    q: dict[str, np.ndarray]
    branch: np.ndarray
    curves: np.ndarray

    def nearest(self, target: Target, count: int) -> list[Start]:
        """Linkages, moved, turned and sized so that they come near the points of a target."""
        if target.closed and target.crank_angles is None:
            return self._closed(target, count)
        z = target.complex_points
        pick = np.unique(np.linspace(0, len(z) - 1, min(len(z), 9)).astype(int))
        found = []
        for sense, places in self._pieces(target, len(z)):
            samples = np.rint(places * SAMPLES).astype(int) % SAMPLES
            _, off = fitted(self.curves[:, samples[pick]], z[pick])
            for k in np.argsort(off)[: max(4, count // 4)]:
                found.append((off[k], k, sense, samples, 2 * np.pi * places))
        if target.crank_angles is None:
            found += self._by_length(z, pick, count)
        found.sort(key=lambda entry: entry[0])
        return self._distinct(found, z, count)

    def _pieces(self, target: Target, size: int) -> list[tuple[int, np.ndarray]]:
        """Sense of turning, and places of the entries on the curves in turns."""
        begins = np.arange(0, 1, 1 / 24)
        if target.crank_angles is not None:
            given = (target.crank_angles - target.crank_angles[0]) / (2 * np.pi)
            return [(1, begin + given) for begin in begins]
        even = np.linspace(0, 1, size)
        return [(s, b + s * even * piece) for b in begins for piece in PIECES for s in (1, -1)]

    def _by_length(self, z: np.ndarray, pick: np.ndarray, count: int) -> list:
        """Pieces of curves on which the entries are as far apart as those of the target."""
        along = np.concatenate([[0.0], np.cumsum(abs(np.diff(z)))])
        along /= along[-1] or 1.0
        curves, theta = self._even
        found = []
        for begin in np.arange(0, 1, 1 / 24):
            for piece in PIECES:
                for sense in (1, -1):
                    places = begin + sense * piece * along
                    samples = np.rint(places * SAMPLES).astype(int) % SAMPLES
                    _, off = fitted(curves[:, samples[pick]], z[pick])
                    for k in np.argsort(off)[: max(4, count // 4)]:
                        angles = np.unwrap(theta[k][samples], period=2 * np.pi)
                        found.append((off[k], k, sense, samples, angles))
        return found

    def _closed(self, target: Target, count: int) -> list[Start]:
        z = target.complex_points
        steps = np.abs(np.diff(np.append(z, z[0])))
        along = np.concatenate([[0.0], np.cumsum(steps)[:-1]]) / steps.sum()
        _, near = self._tree.query(descriptors(by_length(z[None, :])[0])[0], k=96)
        found = []
        curves, theta = (each[near] for each in self._even)
        for sense in (1, -1):
            for shift in np.arange(0, 1, 1 / 36):
                samples = np.rint((shift + sense * along) * SAMPLES).astype(int) % SAMPLES
                _, off = fitted(curves[:, samples], z)
                for k in np.argsort(off)[:4]:
                    angles = np.unwrap(theta[k][samples], period=2 * np.pi)
                    found.append((off[k], near[k], sense, None, angles))
        found.sort(key=lambda entry: entry[0])
        return self._distinct(found, z, count)

    def _distinct(self, found: list, z: np.ndarray, count: int) -> list[Start]:
        """The best piece of each linkage."""
        taken: dict[int, Start] = {}
        for off, k, sense, _, theta in found:
            if k in taken or len(taken) == count:
                continue
            q = {name: values[k] for name, values in self.q.items()}
            curve = self.kind.points(q, self.branch[k], theta)
            ratio, _ = fitted(curve[None, :], z)
            turned = float(np.angle(ratio[0]))
            moved = np.mean(z) - ratio[0] * np.mean(curve)
            unit = self.kind(**q, branch=int(self.branch[k]))
            made = unit.scaled(float(abs(ratio[0])), complex(moved))
            placed = type(made)(**{**made.numbers, "angle": turned}, branch=made.branch)
            taken[k] = Start(placed, theta + turned, sense, float(off))
        return list(taken.values())

    @property
    def _even(self) -> tuple[np.ndarray, np.ndarray]:
        return _even(self.kind)

    @property
    def _tree(self) -> Any:
        return _tree(self.kind)


def fitted(curves: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Turn and size, and root mean square distance, of the best similarity ``a + b·curve ≈ z``."""
    w = curves - curves.mean(axis=1, keepdims=True)
    about = z - z.mean()
    power = np.maximum((abs(w) ** 2).sum(axis=1), 1e-12)
    ratio = (w.conj() @ about) / power
    off = np.sqrt(np.maximum((abs(about) ** 2).sum() - abs(ratio) ** 2 * power, 0) / z.size)
    return ratio, off


def by_length(curves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Closed curves at equal steps of their length, and where that is in turns times 2π."""
    closed = np.concatenate([curves, curves[:, :1]], axis=1)
    along = np.concatenate(
        [np.zeros((len(curves), 1)), np.cumsum(abs(np.diff(closed, axis=1)), axis=1)], axis=1
    )
    angles = np.linspace(0, 2 * np.pi, closed.shape[1])
    made, where = [], []
    for row, length in zip(closed, along, strict=True):
        wanted = np.arange(SAMPLES) / SAMPLES * length[-1]
        made.append(np.interp(wanted, length, row.real) + 1j * np.interp(wanted, length, row.imag))
        where.append(np.interp(wanted, length, angles))
    return np.array(made), np.array(where)


def descriptors(curves: np.ndarray) -> np.ndarray:
    """Moduli of the coefficients, the two of an order sorted so that the sense does not count."""
    found = np.abs(np.fft.fft(curves, axis=1))
    orders = np.arange(1, HARMONICS + 1)
    pair = np.stack([found[:, orders], found[:, -orders]])
    whole = np.sqrt((pair**2).sum(axis=(0, 2)))[:, None]
    more = np.argmax(pair[:, :, 0], axis=0)
    rows = np.arange(len(curves))
    return np.concatenate([pair[more, rows], pair[1 - more, rows]], axis=1) / whole


@lru_cache(maxsize=4)
def atlas_of(kind: type[Linkage]) -> Atlas:
    """The atlas of a kind of linkage, built when it is first asked for."""
    rng = np.random.default_rng(0)
    q, branch = kind.drawn(rng, COUNT), rng.choice([-1, 1], COUNT)
    theta = np.arange(SAMPLES) * 2 * np.pi / SAMPLES
    columns = {name: values[:, None] for name, values in q.items()}
    curves = kind.points(columns, branch[:, None], theta[None, :])
    good = np.isfinite(curves).all(axis=1)
    return Atlas(kind, {n: v[good] for n, v in q.items()}, branch[good], curves[good])


@lru_cache(maxsize=4)
def _tree(kind: type[Linkage]) -> Any:
    from scipy.spatial import cKDTree

    return cKDTree(descriptors(_even(kind)[0]))


@lru_cache(maxsize=4)
def _even(kind: type[Linkage]) -> tuple[np.ndarray, np.ndarray]:
    """Curves at equal steps of their length, and the crank angles there."""
    return by_length(atlas_of(kind).curves)
