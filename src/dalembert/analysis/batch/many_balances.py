"""Equilibria of many designs at an instant, all by Newton's method at once.

What ``StaticBalance`` and ``newton.solve`` do for one. A design of which some directions are much
stiffer than others, whose forces have no potential, or that does not arrive, is left to a run of
its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.static_balance import (
    BENT,
    CLOSED,
    CURVED,
    LONGEST,
    SKEW,
    STIFF,
    StaticsKernel,
)
from dalembert.symbolic.equations.newton import ROUNDING, TINY, NewtonSettings
from dalembert.symbolic.once import once

HALVINGS = NewtonSettings(tolerance=1.0, max_iterations=1).halvings


@dataclass(eq=False)
class ManyForces:
    """``Forces`` of many designs; arrays begin with the design.

    Attributes
    ----------
    y, value, force, multiplier, free, resistance, stiffness : as of one
    size : largest of what is left, in what counts as zero
    """

    y: np.ndarray
    value: np.ndarray
    force: np.ndarray
    multiplier: np.ndarray
    free: np.ndarray
    resistance: np.ndarray
    stiffness: np.ndarray
    size: np.ndarray

    def some(self, chosen: np.ndarray) -> ManyForces:
        """Those of some designs."""
        return ManyForces(*(getattr(self, f.name)[chosen] for f in fields(self)))

    def put(self, places: np.ndarray, other: ManyForces) -> None:
        """Take over those of some designs."""
        for f in fields(self):
            getattr(self, f.name)[places] = getattr(other, f.name)

    @property
    def stable(self) -> np.ndarray:
        """(designs,) whether every direction resists."""
        largest = np.abs(self.resistance).max(axis=1, initial=0.0)[:, None]
        return np.asarray(np.all(self.resistance > CURVED * largest, axis=1))

    @property
    def conservative(self) -> np.ndarray:
        """(designs,) whether the stiffness is symmetric."""
        skew = np.abs(self.stiffness - self.stiffness.transpose(0, 2, 1))
        sizes = (a.max(axis=(1, 2), initial=0.0) for a in (skew, SKEW * np.abs(self.stiffness)))
        return ~np.greater(*sizes)

    @property
    def stiff(self) -> np.ndarray:
        """(designs, k) magnitudes of the resistances, none of them nothing."""
        sizes = np.abs(self.resistance)
        return np.maximum(sizes, CURVED * sizes.max(axis=1, initial=0.0)[:, None])

    @property
    def uneven(self) -> np.ndarray:
        """(designs,) whether what is stiff must be kept straight on the way along the rest."""
        stiff = self.stiff
        return np.asarray(
            np.any(stiff > STIFF * stiff.min(axis=1, initial=np.inf)[:, None], axis=1)
        )

    def deflection(self, force: np.ndarray) -> np.ndarray:
        """Of the free directions by forces."""
        return np.asarray(np.linalg.solve(self.stiffness, force[..., None])[..., 0])


class ManyBalances:
    """Equilibria of a model at an instant.

    Parameters
    ----------
    kernel : StaticsKernel
    time : [s]
    tolerance, max_iterations : as of ``Equilibrium``
    evaluate : function and rows of arguments → rows of results
    """

    def __init__(
        self,
        kernel: StaticsKernel,
        time: float,
        tolerance: float,
        max_iterations: int,
        evaluate: Callable[..., list[np.ndarray]],
    ):
        self.kernel, self.time, self.evaluate = kernel, time, evaluate
        self.tolerance, self.max_iterations = tolerance, max_iterations
        self.e = kernel.model.equations
        self.sizes = self.e.scales

    def solve(self, y: np.ndarray, p: np.ndarray) -> tuple[ManyForces, np.ndarray, np.ndarray]:
        """Equilibria near assembled positions, after how many steps, and which were found."""
        with np.errstate(all="ignore"):
            here = self._look(y, p)
            count, lost = np.zeros(len(y), dtype=int), ~np.isfinite(here.size)
            for _ in range(self.max_iterations):
                lost |= (here.size > 1) & here.uneven
                if not (going := np.flatnonzero((here.size > 1) & ~lost)).size:
                    break
                arrived = self._advance(here, going, p)
                count[going[arrived]] += 1
                lost[going[~arrived]] = True
        return here, count, ~lost & here.conservative & (here.size <= 1)

    def _advance(self, here: ManyForces, going: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Take a step of some designs, halved until it leads nearer; which have taken one."""
        now = here.some(going)
        step = self._steps(now)
        waiting, arrived = np.arange(going.size), np.zeros(going.size, dtype=bool)
        for _ in range(HALVINGS + 1):
            before, at = now.some(waiting), going[waiting]
            there, found = self._arrived(before.y, step[waiting], p[at])
            good = found & np.isfinite(there.size) & self._nearer(before, there)
            here.put(at[good], there.some(good))
            arrived[waiting[good]] = True
            waiting = waiting[~good]
            if not waiting.size:
                break
            step[waiting] /= 2
        return arrived

    def _steps(self, now: ManyForces) -> np.ndarray:
        """Newton's steps; where some direction does not resist, such that fall instead."""
        stable, along = now.stable, now.value / now.stiff
        if stable.any():
            resisting = now.some(stable)
            along[stable] = resisting.deflection(resisting.value)
        step = np.einsum("knf,kf->kn", now.free, along)
        longest = LONGEST * self.sizes.displacements
        shares = np.min(longest / np.maximum(np.abs(step), TINY), axis=1, initial=1.0)
        return np.asarray(step * shares[:, None])

    def _arrived(
        self, y: np.ndarray, step: np.ndarray, p: np.ndarray
    ) -> tuple[ManyForces, np.ndarray]:
        """Where steps lead, and whether they lead to assembled positions."""
        y, found = self._onto_constraints(self._gone(y, step), p)
        return self._look(y, p), found

    def _nearer(self, here: ManyForces, there: ManyForces) -> np.ndarray:
        way = self.e.manifold.lead(here.y.T, there.y.T).T
        nearer = np.einsum("kn,kn->k", here.force + there.force, way) > 0
        if (left := np.flatnonzero(~nearer & here.stable)).size:
            now, then = here.some(left), there.some(left)
            turned = now.free / self.sizes.displacements[:, None] ** 2
            seen = np.einsum("knf,kng,kg->kf", turned, then.free, then.value)
            bent = np.linalg.norm(now.deflection(seen), axis=1)
            nearer[left] = bent < np.linalg.norm(now.deflection(now.value), axis=1)
        return np.asarray(nearer)

    def _look(self, y: np.ndarray, p: np.ndarray) -> ManyForces:
        unit, row, m = self.sizes.displacements, self.sizes.rows, self.e.constraint_count
        force, c, _, _ = self._static(y, np.zeros((len(y), m)), p)
        force, c = force * unit, c * unit / row[:, None]
        undefined = ~(np.isfinite(force).all(axis=1) & np.isfinite(c).all(axis=(1, 2)))
        force[undefined], c[undefined] = 0.0, 0.0
        left, singular, right = np.linalg.svd(c)
        across = np.einsum("krn,kn->kr", right[:, : singular.shape[1]], force)
        across *= _inverse(singular, unit.size)
        multiplier = np.einsum("kmr,kr->km", left[:, :, : singular.shape[1]], across) / row
        free = right[:, m:].transpose(0, 2, 1) * unit[:, None]
        stiffness = self._static(y, multiplier, p)[2]
        stiffness[undefined | ~np.isfinite(stiffness).all(axis=(1, 2))] = np.nan
        seen = free.transpose(0, 2, 1) @ stiffness @ free
        symmetric = np.nan_to_num((seen + seen.transpose(0, 2, 1)) / 2)
        resistance, turned = np.linalg.eigh(symmetric)
        resistance[np.isnan(seen).any(axis=(1, 2))] = np.nan
        free = free @ turned
        value = np.einsum("knf,kn->kf", free, force / unit)
        value[undefined] = np.nan
        stiff = np.abs(resistance)
        place = np.abs(y / self.sizes.coordinates).max(axis=1, initial=0.0)[:, None]
        scale = np.maximum(np.abs(force).max(axis=1, initial=0.0)[:, None], BENT * stiff)
        zero = self.tolerance * scale + ROUNDING * np.maximum(scale, stiff * place)
        return ManyForces(
            y,
            value,
            force / unit,
            multiplier,
            free,
            resistance,
            free.transpose(0, 2, 1) @ stiffness @ free,
            _largest(value, zero),
        )

    def _onto_constraints(self, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The assembled positions near others, and which of them there are."""
        unit, row, m = self.sizes.displacements, self.sizes.rows, self.e.constraint_count
        zero, idle = (CLOSED.tolerance + ROUNDING) * row, np.zeros((len(y), m))
        _, c, _, phi = self._static(y, idle, p)
        y, best, size = y.copy(), y.copy(), _largest(phi, zero)
        least, ended = size.copy(), ~np.isfinite(size) | (size <= 1)
        for _ in range(CLOSED.max_iterations):
            if not (going := np.flatnonzero(~ended)).size:
                break
            alike = c[going] * unit / row[:, None]
            alike[~np.isfinite(alike).all(axis=(1, 2))] = 0.0
            inverse = np.linalg.pinv(alike, rcond=np.finfo(float).eps * max(alike.shape[1:]))
            step = -unit * np.einsum("knm,km->kn", inverse, phi[going] / row)
            there = self._gone(y[going], step)
            _, then, _, left = self._static(there, idle[going], p[going])
            new, old = _largest(left, zero), size[going]
            nearer = _norm(left / zero) < _norm(phi[going] / zero)
            at = going[nearer]
            y[at], c[at], phi[at], size[at] = (a[nearer] for a in (there, then, left, new))
            better = at[size[at] <= least[at]]
            best[better], least[better] = y[better], size[better]
            slow = (old <= CLOSED.slack) & (new > 1) & (new > old / 2)
            ended[going] = slow | ~nearer | (new <= 1)
        done = size <= 1
        return np.where(done[:, None], y, best), done | (least <= CLOSED.slack)

    def _gone(self, y: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.e.manifold.go(y.T, step.T).T

    def _static(self, y: np.ndarray, multiplier: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """Applied forces, ``C``, stiffness and ``Φ``."""
        t, n, m = np.full((len(y), 1), self.time), self.e.speed_count, self.e.constraint_count
        force, c, stiffness, phi = self.evaluate(_columns(self.kernel), t, y, multiplier, p)
        c, stiffness = (a.reshape(len(y), n, -1).transpose(0, 2, 1) for a in (c, stiffness))
        return [force, c.copy() if m else np.zeros((len(y), 0, n)), stiffness.copy(), phi]


def _inverse(singular: np.ndarray, columns: int) -> np.ndarray:
    """Of singular values; zero of those that are rounding."""
    least = np.finfo(float).eps * columns * singular.max(axis=1, initial=0.0)[:, None]
    return np.where(singular > least, 1 / singular, 0.0)


def _largest(value: np.ndarray, zero: np.ndarray) -> np.ndarray:
    shares = np.where(value == 0, 0.0, np.abs(value) / zero)
    return np.asarray(shares.max(axis=1, initial=0.0))


def _norm(shares: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(shares, axis=1))


@once
def _columns(kernel: StaticsKernel) -> ca.Function:
    """``(t, y, λ, p)`` → forces, ``C``, stiffness and ``Φ``, matrices column by column."""
    given = kernel.static.sx_in()
    outputs = [ca.densify(ca.vec(part)) for part in kernel.static.call(given)]
    return ca.Function("static_columns", given, outputs, {"cse": True})
