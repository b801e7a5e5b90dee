"""Balance of forces on the tangent space of the constraints, ``r(y) = Zᵀ f = 0``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.statics_kernel import StaticsKernel
from dalembert.symbolic.equations.newton import ROUNDING, Equations, NewtonSettings, Residual, solve

LONGEST = 0.5
"""Upper limit of a step, in characteristic lengths and radians."""
CURVED = 1e-12
"""Threshold for a stable direction: stiffness relative to the largest one."""
NEUTRAL = 1e-9
"""Upper limit of the magnitude of a stiffness, relative to the largest one, that counts as none."""
SKEW = 1e-9
"""Threshold for an asymmetric stiffness, relative to its largest entry."""
BENT = 1e-3
"""Deflection, in natural sizes, whose elastic force scales the residual."""
STIFF = 1e4
"""Threshold for stiff directions: resistance relative to the smallest one."""
CLOSED = NewtonSettings(tolerance=1e-13, max_iterations=20)
"""Settings for the closure of the constraints."""


class FreeDirections:
    """Stiffness along the free directions of a position, or of many along the first axis.

    Attributes
    ----------
    resistance : (…, k) stiffness of each direction
    stiffness : (…, k, k) ``Zᵀ K Z``, its symmetric part diagonal
    """

    resistance: np.ndarray
    stiffness: np.ndarray

    @property
    def conservative(self) -> Any:
        """Whether the stiffness is symmetric, as for forces with a potential."""
        skew = np.abs(self.stiffness - self.stiffness.swapaxes(-1, -2))
        sizes = (a.max(axis=(-2, -1), initial=0.0) for a in (skew, SKEW * np.abs(self.stiffness)))
        return ~np.greater(*sizes)

    @property
    def stiff(self) -> np.ndarray:
        """(…, k) magnitudes of the resistances, bounded below."""
        sizes = np.abs(self.resistance)
        return np.maximum(sizes, CURVED * sizes.max(axis=-1, initial=0.0, keepdims=True))

    def deflection(self, force: np.ndarray) -> np.ndarray:
        """Deflections along the free directions by forces."""
        return np.asarray(np.linalg.solve(self.stiffness, force[..., None])[..., 0])


@dataclass(frozen=True)
class Forces(FreeDirections, Residual):
    """Work of the forces along the free directions, with the terms of the next step.

    Attributes
    ----------
    y : (n,) position
    force : (n,) applied forces
    multiplier : λ of the best balance
    free : (n, k) free directions ``Z``, orthonormal in natural sizes
    """

    y: np.ndarray = field(kw_only=True)
    force: np.ndarray = field(kw_only=True)
    multiplier: np.ndarray = field(kw_only=True)
    free: np.ndarray = field(kw_only=True)
    resistance: np.ndarray = field(kw_only=True)
    stiffness: np.ndarray = field(kw_only=True)

    @cached_property
    def stiffnesses(self) -> np.ndarray:
        """(k,) stiffnesses relative to the largest one; negative where displacements diverge.

        Without a potential they are the real parts of eigenvalues; flutter depends on masses.
        """
        stiffnesses = self.resistance
        if not self.conservative and np.all(np.isfinite(self.stiffness)):
            stiffnesses = np.linalg.eigvals(self.stiffness).real
        return stiffnesses / (np.abs(self.resistance).max(initial=0.0) or 1.0)

    @property
    def stable(self) -> bool:
        """Whether every free direction has positive stiffness."""
        return bool(np.all(self.stiffnesses > CURVED))

    @property
    def negative(self) -> int:
        """Number of directions in which the position is left."""
        return int(np.sum(self.stiffnesses < -NEUTRAL))


class StaticBalance(Equations[np.ndarray]):
    """Equilibrium of a model at an instant.

    With states of first order it is no minimum of a potential: the steps follow a damped motion
    whose damping vanishes with the residual (pseudo-transient continuation: Kelley & Keyes, SIAM J.
    Numer. Anal. 35, 1998).

    Parameters
    ----------
    kernel : StaticsKernel
    time : [s]
    p : (np,) parameters
    damped : with states, whether steps are damped; else they are those of Newton's method, which
        also leads to unstable equilibria
    """

    def __init__(self, kernel: StaticsKernel, time: float, p: np.ndarray, damped: bool = True):
        self._damped = damped
        self.kernel, self.time, self.p = kernel, time, p
        self.e = e = kernel.equations
        self.idle, self.sizes = np.zeros(e.constraint_count), e.scales
        self._first: tuple[float, float] | None = None
        self.longest = LONGEST * self.sizes.displacements
        self.longest[e.speed_count - len(kernel.states) :] = np.inf

    def evaluate(self, y: np.ndarray, multiplier: np.ndarray):
        """Applied force, ``C``, stiffness and ``Φ``."""
        force, c, stiffness, phi = self.kernel.static(self.time, y, multiplier, self.p)
        return force.full().ravel(), c.full(), stiffness.full(), phi.full().ravel()

    def residual(self, x: np.ndarray) -> Forces:
        force, c, _, _ = self.evaluate(x, self.idle)
        unit, row = self.sizes.displacements, self.sizes.rows
        force, c = force * unit, c * unit / row[:, None]
        if not (np.all(np.isfinite(force)) and np.all(np.isfinite(c))):
            c, force = np.zeros_like(c), np.full_like(force, np.nan)
        multiplier = np.linalg.lstsq(c.T, force, rcond=None)[0] / row if c.size else self.idle
        free = np.linalg.svd(c)[2][c.shape[0] :].T if c.size else np.eye(force.size)
        free = free * unit[:, None]
        stiffness = self.evaluate(x, multiplier)[2]
        resistance, rotation = _spectrum(free.T @ stiffness @ free)
        free = free @ rotation
        stiff, position = np.abs(resistance), np.abs(x / self.sizes.coordinates).max(initial=0.0)
        scale = np.maximum(np.abs(force).max(initial=0.0), BENT * stiff)
        return Forces(
            free.T @ (force / unit),
            scale,
            ROUNDING * np.maximum(scale, stiff * position),
            y=x,
            force=force / unit,
            multiplier=multiplier,
            free=free,
            resistance=resistance,
            stiffness=free.T @ stiffness @ free,
        )

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        """Newton step, or a descent step if a direction has no positive stiffness."""
        assert isinstance(residual, Forces)
        if self.kernel.states and self._damped:
            return self._relaxed(residual)
        if residual.stable or self.kernel.states:
            return residual.free @ residual.deflection(residual.value)
        return residual.free @ (residual.value / residual.stiff)

    def _relaxed(self, residual: Forces) -> np.ndarray:
        """Implicit step of the motion ``μ ẋ = r`` whose damping falls with the residual."""
        size = float(np.linalg.norm(residual.value))
        if self._first is None:
            self._first = size, float(np.abs(residual.stiffness).max(initial=0.0))
        first, stiffest = self._first
        damping = stiffest * size / first if first else 0.0
        matrix = residual.stiffness + damping * np.eye(residual.value.size)
        return np.asarray(residual.free @ np.linalg.solve(matrix, residual.value))

    def steps(self, x: np.ndarray, residual: Residual) -> Iterator[np.ndarray]:
        """Steps with a correction along stiff directions, which steps along soft ones rotate."""
        assert isinstance(residual, Forces)
        if self.kernel.states:
            yield from super().steps(x, residual)
        stiff = residual.stiff > STIFF * residual.stiff.min(initial=np.inf)
        across = residual.free[:, stiff] / residual.stiff[stiff]
        for step in super().steps(x, residual):
            if stiff.any():
                force = self.residual(self.retract(x, step))
                assert isinstance(force, Forces)
                step = step + across @ self.projected(residual, force)[stiff]
            yield step

    def projected(self, here: Forces, there: Forces) -> np.ndarray:
        """Residual at one position along the free directions of another."""
        directions = here.free.T / self.sizes.displacements**2
        return np.asarray(directions @ there.free @ there.value)

    def nearer(self, here: Residual, there: Residual, zero: np.ndarray) -> bool:
        """Whether a step is accepted by positive work or, in stable positions, smaller deflection.

        Residuals are unsuitable, because steps along soft directions bend stiff ones slightly.
        """
        assert isinstance(here, Forces) and isinstance(there, Forces)
        displacement = self.e.manifold.lead(here.y, there.y)
        if self.kernel.states and self._damped:
            return bool(np.all(np.isfinite(there.value)))
        if not self.kernel.states and (here.force + there.force) @ displacement > 0:
            return True
        if not ((here.stable or self.kernel.states) and np.all(np.isfinite(there.value))):
            return False
        deflection = np.linalg.norm(here.deflection(self.projected(here, there)))
        return bool(deflection < np.linalg.norm(here.deflection(here.value)))

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The assembled position near ``x + step``, NaN if there is none."""
        position = self.onto_constraints(self.e.manifold.go(x, step))
        return np.full_like(x, np.nan) if position is None else position

    def onto_constraints(self, y: np.ndarray) -> np.ndarray | None:
        """The assembled position nearest to ``y``, None if there is none nearby."""
        root = solve(_Closure(self), y, CLOSED)
        return root.x if root.accepted else None


@dataclass(frozen=True)
class Violation(Residual):
    """Violations of the constraints, and their Jacobian ``C``."""

    jacobian: np.ndarray = field(kw_only=True)


class _Closure(Equations[np.ndarray]):
    """Constraints at an instant with the shortest steps to them."""

    def __init__(self, balance: StaticBalance):
        self.balance = balance

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.balance.e.manifold.go(x, step)

    def residual(self, x: np.ndarray) -> Violation:
        _, c, _, phi = self.balance.evaluate(x, self.balance.idle)
        return Violation(phi, self.balance.sizes.rows, jacobian=c)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        assert isinstance(residual, Violation)
        unit, row = self.balance.sizes.displacements, self.balance.sizes.rows
        scaled = residual.jacobian * unit / row[:, None]
        return -unit * np.linalg.lstsq(scaled, residual.value / row, rcond=None)[0]


def _spectrum(stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues and eigenvectors of the symmetric part."""
    if not np.all(np.isfinite(stiffness)):
        return np.full(stiffness.shape[0], np.nan), np.eye(stiffness.shape[0])
    return np.linalg.eigh((stiffness + stiffness.T) / 2)
