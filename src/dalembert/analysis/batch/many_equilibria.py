"""Equilibria of many designs at an instant by one Newton iteration.

The vectorised form of ``StaticBalance`` and ``newton.solve``. A design without convergence runs
individually; without states of first order also one with directions of very different stiffness, or
with forces without potential.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.static_balance import (
    BENT,
    CLOSED,
    CURVED,
    LONGEST,
    STIFF,
    FreeDirections,
)
from dalembert.analysis.equilibrium.statics_kernel import StaticsKernel
from dalembert.symbolic.equations.many_newton import ManyEquations, Points, solve_many
from dalembert.symbolic.equations.newton import ROUNDING, TINY, NewtonSettings
from dalembert.symbolic.once import once


@dataclass(eq=False)
class ManyForces(FreeDirections, Points):
    """``Forces`` of many designs at positions ``x``; the first axis is the design.

    Attributes
    ----------
    force, multiplier, free, resistance, stiffness : as in ``Forces``
    """

    force: np.ndarray
    multiplier: np.ndarray
    free: np.ndarray
    resistance: np.ndarray
    stiffness: np.ndarray

    @property
    def stable(self) -> np.ndarray:
        """(designs,) whether every direction has positive stiffness."""
        largest = np.abs(self.resistance).max(axis=1, initial=0.0)[:, None]
        return np.asarray(np.all(self.resistance > CURVED * largest, axis=1))

    @property
    def uneven(self) -> np.ndarray:
        """(designs,) whether stiff directions need a correction after steps along soft ones."""
        stiff = self.stiff
        return np.asarray(
            np.any(stiff > STIFF * stiff.min(axis=1, initial=np.inf)[:, None], axis=1)
        )


class ManyEquilibria(ManyEquations[ManyForces]):
    """Equilibria of a model at an instant.

    Parameters
    ----------
    static : ManyStatics
    p : (designs, np) parameters
    settings : NewtonSettings
    damped : with states, whether steps are damped, as of ``StaticBalance``
    """

    def __init__(
        self, static: ManyStatics, p: np.ndarray, settings: NewtonSettings, damped: bool = True
    ):
        self.static, self.p, self.settings = static, p, settings
        self.e, self.sizes = static.e, static.e.scales
        self.states, self.damped = len(static.kernel.states), damped
        self.longest = LONGEST * self.sizes.displacements
        self.longest[self.longest.size - self.states :] = np.inf
        self._first = np.full((len(p), 2), np.nan)

    def solve(self, y: np.ndarray) -> tuple[ManyForces, np.ndarray, np.ndarray]:
        """Equilibria near assembled positions, numbers of steps, and flags of convergence."""
        solutions = solve_many(self, y, self.settings)
        forces, steps, accepted = solutions.points, solutions.iterations, solutions.accepted
        if not self.states:
            return forces, steps, accepted & forces.conservative
        missed = np.flatnonzero(~accepted)
        if self.damped and missed.size:
            again = ManyEquilibria(self.static, self.p[missed], self.settings, damped=False)
            others, steps[missed], accepted[missed] = again.solve(y[missed])
            forces.put(missed, others)
        return forces, steps, accepted

    def steps(self, here: ManyForces, designs: np.ndarray) -> np.ndarray:
        """Newton steps; descent steps where a direction has no positive stiffness."""
        step = np.einsum("knf,kf->kn", here.free, self._along_free(here, designs))
        step *= np.min(self.longest / np.maximum(np.abs(step), TINY), axis=1, initial=1.0)[:, None]
        if not self.states:
            step[here.uneven] = np.nan  # such designs run individually
        return step

    def _along_free(self, here: ManyForces, designs: np.ndarray) -> np.ndarray:
        if not self.states:
            stable, along_free = here.stable, here.value / here.stiff
            if stable.any():
                stable_forces = here.some(stable)
                along_free[stable] = stable_forces.deflection(stable_forces.value)
            return along_free
        damping = self._damping(here, designs) if self.damped else np.zeros(designs.size)
        matrix = here.stiffness + damping[:, None, None] * np.eye(here.value.shape[1])
        regular = np.isfinite(matrix).all(axis=(1, 2)) & (np.linalg.slogdet(matrix)[0] != 0)
        along_free = np.full_like(here.value, np.nan)
        along_free[regular] = np.linalg.solve(matrix[regular], here.value[regular, :, None])[..., 0]
        return along_free

    def _damping(self, here: ManyForces, designs: np.ndarray) -> np.ndarray:
        """Damping of each design, which falls with the residual."""
        size = np.linalg.norm(here.value, axis=1)
        stiffest = np.abs(here.stiffness).max(axis=(1, 2), initial=0.0)
        new = np.isnan(self._first[designs, 0])
        self._first[designs[new]] = np.column_stack([size, stiffest])[new]
        first, stiffest = self._first[designs].T
        return stiffest * np.divide(size, first, out=np.zeros(size.shape), where=first > 0)

    def after(self, here: ManyForces, steps: np.ndarray, designs: np.ndarray) -> ManyForces:
        closures, y = ManyClosures(self.static, self.p[designs]), self.static.moved(here.x, steps)
        closed = solve_many(closures, y, CLOSED)
        forces = self.points(closed.points.x, designs)
        forces.size[~closed.accepted] = np.nan
        return forces

    def nearer(self, here: ManyForces, there: ManyForces) -> np.ndarray:
        if self.states and self.damped:
            return np.isfinite(there.value).all(axis=1)
        if self.states:
            nearer = np.zeros(len(here.x), dtype=bool)
            compared = np.isfinite(there.value).all(axis=1)
        else:
            displacement = self.e.manifold.lead(here.x.T, there.x.T).T
            nearer = np.einsum("kn,kn->k", here.force + there.force, displacement) > 0
            compared = here.stable
        if (remaining := np.flatnonzero(~nearer & compared)).size:
            current, after = here.some(remaining), there.some(remaining)
            turned = current.free / self.sizes.displacements[:, None] ** 2
            residual = np.einsum("knf,kng,kg->kf", turned, after.free, after.value)
            deflections = np.linalg.norm(current.deflection(residual), axis=1)
            nearer[remaining] = deflections < np.linalg.norm(
                current.deflection(current.value), axis=1
            )
        return np.asarray(nearer)

    def points(self, x: np.ndarray, designs: np.ndarray) -> ManyForces:
        unit, row, m = self.sizes.displacements, self.sizes.rows, self.e.constraint_count
        p = self.p[designs]
        force, c, _, _ = self.static(x, np.zeros((len(x), m)), p)
        force, c = force * unit, c * unit / row[:, None]
        undefined = ~(np.isfinite(force).all(axis=1) & np.isfinite(c).all(axis=(1, 2)))
        force[undefined], c[undefined] = 0.0, 0.0
        left, singular, right = np.linalg.svd(c)
        across = np.einsum("krn,kn->kr", right[:, : singular.shape[1]], force)
        across *= _inverse(singular, unit.size)
        multiplier = np.einsum("kmr,kr->km", left[:, :, : singular.shape[1]], across) / row
        free = right[:, m:].transpose(0, 2, 1) * unit[:, None]
        stiffness = self.static(x, multiplier, p)[2]
        stiffness[undefined | ~np.isfinite(stiffness).all(axis=(1, 2))] = np.nan
        projected = free.transpose(0, 2, 1) @ stiffness @ free
        symmetric = np.nan_to_num((projected + projected.transpose(0, 2, 1)) / 2)
        resistance, turned = np.linalg.eigh(symmetric)
        resistance[np.isnan(projected).any(axis=(1, 2))] = np.nan
        free = free @ turned
        value = np.einsum("knf,kn->kf", free, force / unit)
        value[undefined] = np.nan
        stiff = np.abs(resistance)
        position = np.abs(x / self.sizes.coordinates).max(axis=1, initial=0.0)[:, None]
        scale = np.maximum(np.abs(force).max(axis=1, initial=0.0)[:, None], BENT * stiff)
        zero = self.settings.tolerance * scale + ROUNDING * np.maximum(scale, stiff * position)
        return ManyForces(
            x,
            value,
            zero,
            force / unit,
            multiplier,
            free,
            resistance,
            free.transpose(0, 2, 1) @ stiffness @ free,
        )


@dataclass(eq=False)
class ManyViolations(Points):
    """Violations of the constraints of many designs, and their Jacobians ``C``."""

    jacobian: np.ndarray


class ManyClosures(ManyEquations[ManyViolations]):
    """Constraints of many designs at an instant, with the shortest steps to them.

    Parameters
    ----------
    static : ManyStatics
    p : (designs, np) parameters
    """

    def __init__(self, static: ManyStatics, p: np.ndarray):
        self.static, self.p, self.sizes = static, p, static.e.scales
        self.zero = (CLOSED.tolerance + ROUNDING) * self.sizes.rows

    def points(self, x: np.ndarray, designs: np.ndarray) -> ManyViolations:
        idle = np.zeros((len(x), self.static.e.constraint_count))
        _, c, _, phi = self.static(x, idle, self.p[designs])
        return ManyViolations(x, phi, np.tile(self.zero, (len(x), 1)), c)

    def steps(self, here: ManyViolations, designs: np.ndarray) -> np.ndarray:
        unit, row = self.sizes.displacements, self.sizes.rows
        scaled = here.jacobian * unit / row[:, None]
        scaled[~np.isfinite(scaled).all(axis=(1, 2))] = 0.0
        inverse = np.linalg.pinv(scaled, rcond=np.finfo(float).eps * max(scaled.shape[1:]))
        return np.asarray(-unit * np.einsum("knm,km->kn", inverse, here.value / row))

    def after(self, here: ManyViolations, steps: np.ndarray, designs: np.ndarray) -> ManyViolations:
        return self.points(self.static.moved(here.x, steps), designs)


class ManyStatics:
    """Static equations of many designs at an instant.

    Parameters
    ----------
    kernel : StaticsKernel
    time : [s]
    evaluate : function and rows of arguments → rows of results
    """

    def __init__(
        self, kernel: StaticsKernel, time: float, evaluate: Callable[..., list[np.ndarray]]
    ):
        self.kernel, self.time, self.evaluate = kernel, time, evaluate
        self.e = kernel.equations

    def __call__(self, y: np.ndarray, multiplier: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """Applied forces, ``C``, stiffness and ``Φ``."""
        t, n, m = np.full((len(y), 1), self.time), self.e.speed_count, self.e.constraint_count
        force, c, stiffness, phi = self.evaluate(_columns(self.kernel), t, y, multiplier, p)
        c, stiffness = (a.reshape(len(y), n, -1).transpose(0, 2, 1) for a in (c, stiffness))
        return [force, c.copy() if m else np.zeros((len(y), 0, n)), stiffness.copy(), phi]

    def moved(self, y: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """Positions after displacements."""
        return self.e.manifold.go(y.T, steps.T).T


def _inverse(singular: np.ndarray, columns: int) -> np.ndarray:
    """Inverse singular values; zero for rounding."""
    least = np.finfo(float).eps * columns * singular.max(axis=1, initial=0.0)[:, None]
    return np.where(singular > least, 1 / singular, 0.0)


@once
def _columns(kernel: StaticsKernel) -> ca.Function:
    """``(t, y, λ, p)`` → forces, ``C``, stiffness and ``Φ``, matrices column by column."""
    arguments = kernel.static.sx_in()
    outputs = [ca.densify(ca.vec(part)) for part in kernel.static.call(arguments)]
    return ca.Function("static_columns", arguments, outputs, {"cse": True})
