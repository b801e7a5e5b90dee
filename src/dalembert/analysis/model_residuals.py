"""Residuals of the model's own equations along a motion.

    Φ(y, t) = 0,      Ψ = C v + Φ_t = 0,      C v̇ = ξ,      M v̇ + d = f − Cᵀ λ

with all constraint equations and in body coordinates, independent of the strategies of the run.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.formulations.base import Level
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.evaluation.kernel import SELDOM, Kernel, condensed
from dalembert.symbolic.formulas.expression import stack
from dalembert.symbolic.once import once

CHECKED = 50
"""Number of outputs, evenly spread, at which all equations are checked; positions at every one."""
INSTANT = 1e-12
"""Difference of equal instants, relative to the end of the run [-]."""
TIED = 1e-12
"""Natural lengths below which a switching function of a distance is zero."""
STILL = 1e-3
"""Share of the natural speed and acceleration below which a mechanism counts as at rest."""


@dataclass(frozen=True)
class Violation:
    """The equation with the largest residual, relative to the size of its terms.

    Attributes
    ----------
    share : residual over terms, infinite where it is not finite
    text : the equation, its residual and the time
    """

    share: float
    text: str = ""


class ModelResiduals:
    """Residuals along a trajectory.

    Residuals are compared with the magnitudes of the terms plus the natural scales of the
    mechanism, so that rounding at rest does not count.

    Parameters
    ----------
    model : Model
    trajectory : states of all bodies, and multipliers
    p : (np,) parameters

    Attributes
    ----------
    one_sided : instants at which directions of contact forces may jump and only positions are
        checked [s]
    """

    def __init__(self, model: Model, trajectory: Trajectory, p: np.ndarray):
        self.model, self.s, self.p = model, trajectory, p
        self.one_sided = np.zeros(0)

    @cached_property
    def violations(self) -> np.ndarray:
        """(K,) largest residual of a position constraint; angles times the natural length [m]."""
        s = self.s
        mapped = _mapped(self.model, violation, s.t.size)
        return mapped(s.t, s.y, np.tile(self.p[:, None], s.t.size))[0].ravel()

    @cached_property
    def energies(self) -> np.ndarray:
        """(2, K) kinetic and potential energy [J]."""
        s = self.s
        mapped = _mapped(self.model, energies, s.t.size)
        return mapped(s.t, s.y, s.v, np.tile(self.p[:, None], s.t.size))[0]

    @cached_property
    def checked(self) -> Trajectory:
        """The states at which all equations are checked, the worst position among them."""
        count = self.s.t.size
        spread = checked_outputs(count)
        worst = np.argsort(np.nan_to_num(self.violations, nan=np.inf))[-1:]
        chosen = np.union1d(spread, worst)
        apart = np.abs(self.s.t[chosen, None] - self.one_sided) > INSTANT * abs(self.s.t[-1])
        smooth = chosen[apart.all(axis=1)]
        return self.s.some(smooth if smooth.size else chosen)

    @cached_property
    def _constraints(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows of Φ, Ψ and ``C v̇ − ξ``; magnitudes of their terms."""
        s = self.checked
        mapped, p = (
            _mapped(self.model, constraint_rows, s.t.size),
            np.tile(self.p[:, None], s.t.size),
        )
        residuals, terms = mapped(s.t, s.y, s.v, s.a, p)
        return residuals, terms

    @cached_property
    def _motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the equations of motion; magnitudes of their terms."""
        s, model = self.checked, self.model
        p = np.tile(self.p[:, None], s.t.size)
        forces = s.forces(model.all_equations.transmitted.numel())
        states = s.t, s.y, s.v, s.a, forces, p
        residuals, terms = _mapped(model, motion_rows, s.t.size)(*states)
        if not any(gap.switches.count for gap in model.all_equations.contacts):
            return residuals, terms
        sides, functions = _mapped(model, gap_sides, s.t.size)(s.t, s.y, p)
        tied = np.abs(functions) <= TIED * model.scales.length
        if not tied.any():
            return residuals, terms
        branched = _mapped(model, branched_motion_rows, s.t.size)
        residuals, terms = branched(*states, sides)
        sides = np.where(tied, 1 - sides, sides)  # a body touches two faces of one surface
        others = branched(*states, sides)
        units = model.scales.efforts[:, None]
        with np.errstate(all="ignore"):
            shares, other_shares = (
                np.abs(r / (size + units)).max(axis=0) for r, size in ((residuals, terms), others)
            )
        better = other_shares < shares
        return np.where(better, others[0], residuals), np.where(better, others[1], terms)

    # largest violations -----------------------------------------------------------------
    def of_level(self, level: Level, drifts: bool = False) -> Violation:
        """The largest violation of a constraint at a level.

        With ``drifts`` violations are compared with the largest term of any constraint at any time:
        stiff springs make the natural speeds fast, whatever the speed of the motion.
        """
        m = self.model.all_equations.constraint_count
        if not (m and self.s.t.size):
            return Violation(0.0)
        scales = self.model.scales
        residuals, terms = (table[level * m : (level + 1) * m] for table in self._constraints)
        units, natural = scales.rows[:, None], scales.time**-level
        if drifts and level > Level.POSITION:
            size = units * np.fmax(np.max(terms / units), STILL * natural)
        else:
            size = terms + units * natural
        row, share, value, time = self._worst(residuals, size)
        constraint, k = self.model.closure.owners[row]
        unit = constraint.units()[k] + ("", "/s", "/s²")[level]
        name = self.model.equation_names[row]
        return Violation(share, f"{name} is violated by {value:.3g} {unit} at t = {time:.9g} s")

    @property
    def of_motion(self) -> Violation:
        """The largest violation of an equation of motion."""
        if not (self.s.v.size and self.s.t.size):
            return Violation(0.0)
        residuals, terms = self._motion
        size = terms + self.model.scales.efforts[:, None]
        row, share, value, time = self._worst(residuals, size)
        unit = "N" if self.model.guesses.speed_units[row] == "m" else "N m"
        name = self.model.guesses.speed_names[row]
        text = f"the equation of motion of {name} is open by {value:.3g} {unit} at t = {time:.9g} s"
        return Violation(share, text)

    def _worst(self, residuals: np.ndarray, size: np.ndarray) -> tuple[int, float, float, float]:
        """Row, share of the size, residual and time."""
        residuals = np.abs(residuals)
        with np.errstate(all="ignore"):
            shares = residuals / size
        shares = np.where(np.isfinite(shares), shares, np.inf)
        row, k = np.unravel_index(int(np.argmax(shares)), shares.shape)
        time = self.checked.t[k]
        return int(row), float(shares[row, k]), float(residuals[row, k]), float(time)


def checked_outputs(count: int) -> np.ndarray:
    """Indices of the outputs at which all equations are checked."""
    return np.linspace(0, count - 1, min(count, CHECKED)).astype(int)


@once
def _mapped(model: Model, function_of: Callable[[Model], ca.Function], count: int) -> Kernel:
    """One of the functions below, mapped over ``count`` columns."""
    return Kernel(function_of(model).map(count))


@once
def violation(model: Model) -> ca.Function:
    """``(t, y, p) → |Φ|``."""
    e = model.all_equations
    lengths = e.constraints * (e.scales.length / e.scales.rows)
    largest = ca.densify(ca.norm_inf(lengths)) if lengths.numel() else ca.SX(0)
    return condensed("violation", [e.t, e.y, e.p], [largest], SELDOM)


@once
def energies(model: Model) -> ca.Function:
    """``(t, y, v, p) → [T; V]``."""
    e = model.all_equations
    outputs = ca.densify(ca.vertcat(e.kinetic_energy, e.potential))
    return condensed("energies", [e.t, e.y, e.v, e.p], [outputs], SELDOM)


@once
def constraint_rows(model: Model) -> ca.Function:
    """``(t, y, v, v̇, p) →`` residuals of each level, and sums of the magnitudes of their terms."""
    e = model.all_equations
    c, size = e.jacobian, ca.fabs(e.jacobian)
    psi, xi = e.velocity_constraints, e.constraint_acceleration
    driven = ca.substitute(psi, e.v, ca.SX.zeros(e.speed_count))
    pairs = [
        (e.constraints, ca.SX.zeros(e.constraint_count)),
        (psi, ca.mtimes(size, ca.fabs(e.v)) + ca.fabs(driven)),
        (ca.mtimes(c, e.a) - xi, ca.mtimes(size, ca.fabs(e.a)) + ca.fabs(xi)),
    ]
    outputs = [ca.densify(ca.vertcat(*parts)) for parts in zip(*pairs, strict=True)]
    return ca.Function("levels", [e.t, e.y, e.v, e.a, e.p], outputs)


@once
def motion_rows(model: Model) -> ca.Function:
    """``(t, y, v, v̇, λ, p) →`` residuals of the equations of motion, and magnitudes likewise."""
    e = model.all_equations
    outputs = _motion(e, [(gap.distance, gap.slip) for gap in e.contacts])
    return ca.Function("motion", [e.t, e.y, e.v, e.a, e.transmitted, e.p], outputs)


@once
def branched_motion_rows(model: Model) -> ca.Function:
    """The same with the sides of the switches of all gaps as last argument."""
    e = model.all_equations
    switches = [gap.switches for gap in e.contacts]
    outputs = _motion(e, [(s.distance, s.slip) for s in switches])
    sides = stack(s.switches.sides for s in switches)
    return ca.Function("motion", [e.t, e.y, e.v, e.a, e.transmitted, e.p, sides], outputs)


def _motion(e: Equations, gaps: list[tuple[ca.SX, ca.SX]]) -> list[ca.SX]:
    """Residuals of the equations of motion with distances and slips of gaps, and magnitudes."""
    c = e.jacobian
    push, pull = e.inertia.times(e.a), ca.mtimes(c.T, e.multiplier)
    terms = sum(
        map(ca.fabs, (push, e.bias, e.force)), ca.mtimes(ca.fabs(c).T, ca.fabs(e.multiplier))
    )
    for gap, (distance, slip) in zip(e.contacts, gaps, strict=True):
        along = e.by_displacement(distance), ca.jacobian(slip, e.v)
        for rows, force in zip(along, (gap.normal, gap.tangential), strict=True):
            pull -= ca.mtimes(rows.T, force)
            terms += ca.mtimes(ca.fabs(rows).T, ca.fabs(force))
    return [ca.densify(push + e.bias - e.force + pull), ca.densify(terms)]


@once
def gap_sides(model: Model) -> ca.Function:
    """``(t, y, p) →`` sides of the switches of all gaps, and their switching functions."""
    e = model.all_equations
    switches = [gap.switches.switches for gap in e.contacts]
    functions = [ca.substitute(s.functions, s.sides, s.actual) for s in switches]
    outputs = [ca.densify(stack(parts)) for parts in ([s.actual for s in switches], functions)]
    return ca.Function("gap_sides", [e.t, e.y, e.p], outputs)
