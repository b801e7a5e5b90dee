"""The balance of forces on the tangent space of the constraints, ``r(y) = Zᵀ f = 0``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.model.assembly.position import position_stages
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.equations.newton import ROUNDING, Equations, NewtonSettings, Residual, solve
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

LONGEST = 0.5
"""Longest step, in characteristic lengths and radians."""
CURVED = 1e-12
"""Stiffness, relative to the largest, from which on a direction counts as stable."""
SKEW = 1e-9
"""Asymmetry of a stiffness, relative to it, that is rounding."""
BENT = 1e-3
"""Deflection, in natural sizes, whose elastic force is a force that counts."""
STIFF = 1e4
"""Resistance, relative to the smallest, of what is kept straight on the way along the others."""
CLOSED = NewtonSettings(tolerance=1e-13, max_iterations=20)


class StaticsKernel:
    """Compiled static equations of a model."""

    def __init__(self, model: Model):
        model.closure.refuse_singular_start()
        e = model.equations
        self.model = model
        at_rest = ca.substitute(e.force - e.bias, e.v, ca.SX.zeros(e.speed_count))
        forces = at_rest - ca.mtimes(e.jacobian.T, e.multiplier)
        self.balance = forces
        self.static = ca.Function(
            "static",
            [e.t, e.y, e.multiplier, e.p],
            [
                at_rest,
                e.jacobian,
                -e.by_displacement(forces),
                e.constraints,
            ],
            {"cse": True},
        )

    @property
    def configuration(self) -> ImplicitFunction:
        """``(t, [y; λ] nearby, p) → y, λ`` with their exact derivatives."""
        e = self.model.equations
        near = ca.SX.sym("near", e.coordinate_count + e.constraint_count)
        unknown = ca.vertcat(e.y, e.multiplier)
        way = e.manifold.displacement(near[: e.coordinate_count], e.y)
        held = e.constraints + ca.mtimes(e.slip_jacobian, way) if e.slips else e.constraints
        residual = ca.vertcat(self.balance, held)
        sizes = e.scales
        rows = np.concatenate([sizes.efforts, sizes.rows])
        stages = position_stages(
            e, near, residual, rows, beside=e.multiplier, beside_sizes=sizes.multipliers
        )
        return ImplicitFunction("equilibrium", [e.t, near, e.p], stages, [unknown])

    @once
    def measured(self, measure: Expression) -> ImplicitFunction:
        """A measure of the equilibrium; speeds and accelerations are zero."""
        e = self.model.equations
        still = ca.vertcat(e.v, e.a)
        at_rest = ca.substitute(e.without_dropped(measure.sx), still, ca.SX.zeros(still.numel()))
        found = self.configuration
        return ImplicitFunction("measured", found.inputs, found.stages, [at_rest])

    def near(self, s: Trajectory) -> np.ndarray:
        """Where the configuration is differentiated."""
        return np.vstack([s.y, s.multiplier[self.model.closure.rows]])


statics_kernel = once(StaticsKernel)
"""The one of a model."""


@dataclass(frozen=True)
class Forces(Residual):
    """Work of the forces along the free directions, and what is needed to go on.

    Attributes
    ----------
    y : (n,) position
    force : (n,) applied forces
    multiplier : λ that balances them best
    free : (n, k) free directions ``Z``, orthonormal in natural sizes
    resistance : (k,) of each free direction
    stiffness : (k, k) ``Zᵀ K Z``, its symmetric part diagonal
    """

    y: np.ndarray = field(kw_only=True)
    force: np.ndarray = field(kw_only=True)
    multiplier: np.ndarray = field(kw_only=True)
    free: np.ndarray = field(kw_only=True)
    resistance: np.ndarray = field(kw_only=True)
    stiffness: np.ndarray = field(kw_only=True)

    @cached_property
    def conservative(self) -> bool:
        """The stiffness is symmetric: the forces have a potential, as far as is seen here."""
        skew = np.abs(self.stiffness - self.stiffness.T).max(initial=0.0)
        return not skew > SKEW * np.abs(self.stiffness).max(initial=0.0)

    @cached_property
    def stable(self) -> bool:
        """Every free direction resists; without a potential, no displacement runs away by itself
        (no divergence; flutter is a matter of masses)."""
        resisting = self.resistance
        if not self.conservative and np.all(np.isfinite(self.stiffness)):
            resisting = np.linalg.eigvals(self.stiffness).real
        largest = np.abs(self.resistance).max(initial=0.0)
        return bool(np.all(resisting > CURVED * largest))

    @property
    def stiff(self) -> np.ndarray:
        """(k,) magnitudes of the resistances, none of them nothing."""
        sizes = np.abs(self.resistance)
        return np.maximum(sizes, CURVED * sizes.max(initial=0.0))

    def deflection(self, force: np.ndarray) -> np.ndarray:
        """Of the free directions by a force."""
        return np.asarray(np.linalg.solve(self.stiffness, force))


class StaticBalance(Equations[np.ndarray]):
    """Equilibrium of a model at an instant.

    Parameters
    ----------
    kernel : StaticsKernel
    time : [s]
    p : (np,) parameters
    """

    def __init__(self, kernel: StaticsKernel, time: float, p: np.ndarray):
        self.kernel, self.time, self.p = kernel, time, p
        e = kernel.model.equations
        self.idle, self.sizes = np.zeros(e.constraint_count), e.scales
        self.longest = LONGEST * self.sizes.displacements

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
        resistance, turned = _spectrum(free.T @ stiffness @ free)
        free = free @ turned
        stiff, place = np.abs(resistance), np.abs(x / self.sizes.coordinates).max(initial=0.0)
        scale = np.maximum(np.abs(force).max(initial=0.0), BENT * stiff)
        return Forces(
            free.T @ (force / unit),
            scale,
            ROUNDING * np.maximum(scale, stiff * place),
            y=x,
            force=force / unit,
            multiplier=multiplier,
            free=free,
            resistance=resistance,
            stiffness=free.T @ stiffness @ free,
        )

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        """Newton's step; where some direction does not resist, one that falls instead."""
        assert isinstance(residual, Forces)
        if residual.stable:
            return residual.free @ residual.deflection(residual.value)
        return residual.free @ (residual.value / residual.stiff)

    def steps(self, x: np.ndarray, residual: Residual) -> Iterator[np.ndarray]:
        """Steps that end where what is stiff is straight again: soft ones turn it, so it bends."""
        assert isinstance(residual, Forces)
        stiff = residual.stiff > STIFF * residual.stiff.min(initial=np.inf)
        across = residual.free[:, stiff] / residual.stiff[stiff]
        for step in super().steps(x, residual):
            if stiff.any():
                force = self.residual(self.retract(x, step))
                assert isinstance(force, Forces)
                step = step + across @ self.seen(residual, force)[stiff]
            yield step

    def seen(self, here: Forces, there: Forces) -> np.ndarray:
        """What is left at one place along the free directions of another."""
        turned = here.free.T / self.sizes.displacements**2
        return np.asarray(turned @ there.free @ there.value)

    def nearer(self, here: Residual, there: Residual, zero: np.ndarray) -> bool:
        """By the work done on the way; where all directions resist, by deflections left as well.

        Residuals would not do: a step along a soft direction bends a stiff one by a little.
        """
        assert isinstance(here, Forces) and isinstance(there, Forces)
        way = self.kernel.model.equations.manifold.lead(here.y, there.y)
        if (here.force + there.force) @ way > 0:
            return True
        if not (here.stable and np.all(np.isfinite(there.value))):
            return False
        left = np.linalg.norm(here.deflection(self.seen(here, there)))
        return bool(left < np.linalg.norm(here.deflection(here.value)))

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The assembled position near ``x + step``, not a number where there is none."""
        moved = self.onto_constraints(self.kernel.model.equations.manifold.go(x, step))
        return np.full_like(x, np.nan) if moved is None else moved

    def onto_constraints(self, y: np.ndarray) -> np.ndarray | None:
        """The assembled position nearest to ``y``, None where there is none near."""
        found = solve(_Nearest(self), y, CLOSED)
        return found.x if found.accepted else None


@dataclass(frozen=True)
class Openness(Residual):
    """Violations of the constraints, and their Jacobian ``C``."""

    jacobian: np.ndarray = field(kw_only=True)


class _Nearest(Equations[np.ndarray]):
    """The constraints at an instant, with the shortest steps to them."""

    def __init__(self, balance: StaticBalance):
        self.balance = balance

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        return self.balance.kernel.model.equations.manifold.go(x, step)

    def residual(self, x: np.ndarray) -> Openness:
        _, c, _, phi = self.balance.evaluate(x, self.balance.idle)
        return Openness(phi, self.balance.sizes.rows, jacobian=c)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        assert isinstance(residual, Openness)
        unit, row = self.balance.sizes.displacements, self.balance.sizes.rows
        alike = residual.jacobian * unit / row[:, None]
        return -unit * np.linalg.lstsq(alike, residual.value / row, rcond=None)[0]


def rest_text(residual: float, iterations: int, stable: bool, conservative: bool = True) -> str:
    """What is said of an equilibrium."""
    kind = "stable" if stable else "not a stable position"
    if stable and not conservative:
        kind = "statically stable (loads without potential: linearize tells of flutter)"
    return f"residual {residual:.3g} N after {iterations} iterations, {kind}"


def _spectrum(stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues and vectors of the symmetric part."""
    if not np.all(np.isfinite(stiffness)):
        return np.full(stiffness.shape[0], np.nan), np.eye(stiffness.shape[0])
    return np.linalg.eigh((stiffness + stiffness.T) / 2)
