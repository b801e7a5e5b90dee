"""Equilibria of many designs at an instant by one Newton iteration.

The vectorised form of ``StaticBalance`` and ``newton.solve``. A design with directions of very
different stiffness, with forces without potential, or without convergence runs individually.
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
    """``Forces`` of many designs; the first axis is the design.

    Attributes
    ----------
    y, value, force, multiplier, free, resistance, stiffness : as in ``Forces``
    size : largest residual over its tolerance
    """

    y: np.ndarray
    value: np.ndarray
    force: np.ndarray
    multiplier: np.ndarray
    free: np.ndarray
    resistance: np.ndarray
    stiffness: np.ndarray
    size: np.ndarray

    def some(self, designs: np.ndarray) -> ManyForces:
        """Forces of selected designs."""
        return ManyForces(*(getattr(self, f.name)[designs] for f in fields(self)))

    def put(self, designs: np.ndarray, forces: ManyForces) -> None:
        """Replace the forces of selected designs."""
        for f in fields(self):
            getattr(self, f.name)[designs] = getattr(forces, f.name)

    @property
    def stable(self) -> np.ndarray:
        """(designs,) whether every direction has positive stiffness."""
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
        """(designs, k) magnitudes of the resistances, bounded below."""
        sizes = np.abs(self.resistance)
        return np.maximum(sizes, CURVED * sizes.max(axis=1, initial=0.0)[:, None])

    @property
    def uneven(self) -> np.ndarray:
        """(designs,) whether stiff directions need a correction after steps along soft ones."""
        stiff = self.stiff
        return np.asarray(
            np.any(stiff > STIFF * stiff.min(axis=1, initial=np.inf)[:, None], axis=1)
        )

    def deflection(self, force: np.ndarray) -> np.ndarray:
        """Deflections along the free directions by forces."""
        return np.asarray(np.linalg.solve(self.stiffness, force[..., None])[..., 0])


class ManyEquilibria:
    """Equilibria of a model at an instant.

    Parameters
    ----------
    kernel : StaticsKernel
    time : [s]
    tolerance, max_iterations : as in ``Equilibrium``
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
        """Equilibria near assembled positions, numbers of steps, and flags of convergence."""
        with np.errstate(all="ignore"):
            here = self._forces(y, p)
            count, failed = np.zeros(len(y), dtype=int), ~np.isfinite(here.size)
            for _ in range(self.max_iterations):
                failed |= (here.size > 1) & here.uneven
                if not (active := np.flatnonzero((here.size > 1) & ~failed)).size:
                    break
                success = self._advance(here, active, p)
                count[active[success]] += 1
                failed[active[~success]] = True
        return here, count, ~failed & here.conservative & (here.size <= 1)

    def _advance(self, here: ManyForces, active: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Step of some designs, halved until it reduces the residual; flags of success."""
        current = here.some(active)
        step = self._steps(current)
        waiting, success = np.arange(active.size), np.zeros(active.size, dtype=bool)
        for _ in range(HALVINGS + 1):
            before, designs = current.some(waiting), active[waiting]
            after, assembled = self._after(before.y, step[waiting], p[designs])
            accepted = assembled & np.isfinite(after.size) & self._nearer(before, after)
            here.put(designs[accepted], after.some(accepted))
            success[waiting[accepted]] = True
            waiting = waiting[~accepted]
            if not waiting.size:
                break
            step[waiting] /= 2
        return success

    def _steps(self, current: ManyForces) -> np.ndarray:
        """Newton steps; descent steps where a direction has no positive stiffness."""
        stable, along_free = current.stable, current.value / current.stiff
        if stable.any():
            stable_forces = current.some(stable)
            along_free[stable] = stable_forces.deflection(stable_forces.value)
        step = np.einsum("knf,kf->kn", current.free, along_free)
        longest = LONGEST * self.sizes.displacements
        shares = np.min(longest / np.maximum(np.abs(step), TINY), axis=1, initial=1.0)
        return np.asarray(step * shares[:, None])

    def _after(
        self, y: np.ndarray, step: np.ndarray, p: np.ndarray
    ) -> tuple[ManyForces, np.ndarray]:
        """Forces after steps, and whether the positions could be assembled."""
        y, assembled = self._onto_constraints(self._retract(y, step), p)
        return self._forces(y, p), assembled

    def _nearer(self, here: ManyForces, there: ManyForces) -> np.ndarray:
        displacement = self.e.manifold.lead(here.y.T, there.y.T).T
        nearer = np.einsum("kn,kn->k", here.force + there.force, displacement) > 0
        if (remaining := np.flatnonzero(~nearer & here.stable)).size:
            current, after = here.some(remaining), there.some(remaining)
            turned = current.free / self.sizes.displacements[:, None] ** 2
            residual = np.einsum("knf,kng,kg->kf", turned, after.free, after.value)
            deflections = np.linalg.norm(current.deflection(residual), axis=1)
            nearer[remaining] = deflections < np.linalg.norm(
                current.deflection(current.value), axis=1
            )
        return np.asarray(nearer)

    def _forces(self, y: np.ndarray, p: np.ndarray) -> ManyForces:
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
        projected = free.transpose(0, 2, 1) @ stiffness @ free
        symmetric = np.nan_to_num((projected + projected.transpose(0, 2, 1)) / 2)
        resistance, turned = np.linalg.eigh(symmetric)
        resistance[np.isnan(projected).any(axis=(1, 2))] = np.nan
        free = free @ turned
        value = np.einsum("knf,kn->kf", free, force / unit)
        value[undefined] = np.nan
        stiff = np.abs(resistance)
        position = np.abs(y / self.sizes.coordinates).max(axis=1, initial=0.0)[:, None]
        scale = np.maximum(np.abs(force).max(axis=1, initial=0.0)[:, None], BENT * stiff)
        zero = self.tolerance * scale + ROUNDING * np.maximum(scale, stiff * position)
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
        """Assembled positions near others, and flags of convergence."""
        unit, row, m = self.sizes.displacements, self.sizes.rows, self.e.constraint_count
        zero, idle = (CLOSED.tolerance + ROUNDING) * row, np.zeros((len(y), m))
        _, c, _, phi = self._static(y, idle, p)
        y, best, size = y.copy(), y.copy(), _largest(phi, zero)
        least, ended = size.copy(), ~np.isfinite(size) | (size <= 1)
        for _ in range(CLOSED.max_iterations):
            if not (active := np.flatnonzero(~ended)).size:
                break
            scaled = c[active] * unit / row[:, None]
            scaled[~np.isfinite(scaled).all(axis=(1, 2))] = 0.0
            inverse = np.linalg.pinv(scaled, rcond=np.finfo(float).eps * max(scaled.shape[1:]))
            step = -unit * np.einsum("knm,km->kn", inverse, phi[active] / row)
            moved = self._retract(y[active], step)
            _, jacobian, _, violation = self._static(moved, idle[active], p[active])
            new_size, old_size = _largest(violation, zero), size[active]
            nearer = _norm(violation / zero) < _norm(phi[active] / zero)
            improved = active[nearer]
            y[improved], c[improved], phi[improved], size[improved] = (
                a[nearer] for a in (moved, jacobian, violation, new_size)
            )
            record = improved[size[improved] <= least[improved]]
            best[record], least[record] = y[record], size[record]
            slow = (old_size <= CLOSED.slack) & (new_size > 1) & (new_size > old_size / 2)
            ended[active] = slow | ~nearer | (new_size <= 1)
        done = size <= 1
        return np.where(done[:, None], y, best), done | (least <= CLOSED.slack)

    def _retract(self, y: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.e.manifold.go(y.T, step.T).T

    def _static(self, y: np.ndarray, multiplier: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """Applied forces, ``C``, stiffness and ``Φ`` of all designs."""
        t, n, m = np.full((len(y), 1), self.time), self.e.speed_count, self.e.constraint_count
        force, c, stiffness, phi = self.evaluate(_columns(self.kernel), t, y, multiplier, p)
        c, stiffness = (a.reshape(len(y), n, -1).transpose(0, 2, 1) for a in (c, stiffness))
        return [force, c.copy() if m else np.zeros((len(y), 0, n)), stiffness.copy(), phi]


def _inverse(singular: np.ndarray, columns: int) -> np.ndarray:
    """Inverse singular values; zero for rounding."""
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
    arguments = kernel.static.sx_in()
    outputs = [ca.densify(ca.vec(part)) for part in kernel.static.call(arguments)]
    return ca.Function("static_columns", arguments, outputs, {"cse": True})
