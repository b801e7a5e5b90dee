"""What a motion leaves open of the model's own equations.

    Φ(y, t) = 0,      Ψ = C v + Φ_t = 0,      C v̇ = ξ,      M v̇ + d = f − Cᵀ λ

with all constraint equations and in the coordinates of the bodies, whatever a run has used.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.formulations.levels import Level
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.kernel import Kernel
from dalembert.symbolic.once import once

LOOKED = 50
"""Outputs, evenly spread, at which all equations are looked at; positions are at every one."""
STILL = 1e-3
"""Of the natural speed and acceleration: a mechanism whose terms are smaller is at rest."""


@dataclass(frozen=True)
class Gap:
    """The equation that is open furthest, relative to the size of its terms.

    Attributes
    ----------
    share : residual over terms, infinite where it is not a number
    text : which equation, by how much, and when
    """

    share: float
    text: str = ""


class ModelResiduals:
    """Residuals along a trajectory.

    Terms count by their magnitudes, with the mechanism's own scales: what is at rest is not judged
    by its rounding.

    Parameters
    ----------
    model : Model
    trajectory : of all bodies and multipliers
    p : (np,) parameters
    """

    def __init__(self, model: Model, trajectory: Trajectory, p: np.ndarray):
        self.model, self.s, self.p = model, trajectory, p
        self.m = model.all_equations.constraint_count
        count = trajectory.t.size
        looked = np.linspace(0, count - 1, min(count, LOOKED)).astype(int)
        worst = np.argmax(np.nan_to_num(self.violations, nan=np.inf))
        self.looked = np.unique([*looked, worst])

    @cached_property
    def _everywhere(self) -> np.ndarray:
        """(3, K) violation, kinetic and potential energy at every output."""
        s = self.s
        mapped = _everywhere(self.model, s.t.size)
        return mapped(s.t, s.y, s.v, np.tile(self.p[:, None], s.t.size))[0]

    @property
    def violations(self) -> np.ndarray:
        """(K,) largest residual of a position constraint; angles times the natural length [m]."""
        return self._everywhere[0]

    @property
    def energies(self) -> np.ndarray:
        """(2, K) kinetic and potential energy [J]."""
        return self._everywhere[1:]

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows of Φ, Ψ, ``C v̇ − ξ`` and the equations of motion; magnitudes of their terms."""
        s = self.s.some(self.looked)
        mapped, p = _residuals(self.model, s.t.size), np.tile(self.p[:, None], s.t.size)
        residuals, terms = mapped(s.t, s.y, s.v, s.a, s.multiplier, p)
        return residuals, terms

    # the worst of each ------------------------------------------------------------------
    def of_level(self, level: Level, drifts: bool = False) -> Gap:
        """The constraint that is violated most.

        What drifts is compared with the largest term of any constraint at any time: stiff springs
        make the natural speeds fast, whatever moves.
        """
        if not self.m:
            return Gap(0.0)
        rows, scales = slice(level * self.m, (level + 1) * self.m), self.model.scales
        units, terms = scales.rows[:, None], self._table[1][rows]
        natural = scales.time**-level
        if drifts and level > Level.POSITION:
            size = units * np.fmax(np.max(terms / units), STILL * natural)
        else:
            size = terms + units * natural
        row, share, value, time = self._worst(rows, size)
        constraint, k = self.model.closure.owners[row]
        unit = constraint.units()[k] + ("", "/s", "/s²")[level]
        name = self.model.equation_names[row]
        return Gap(share, f"{name} is violated by {value:.3g} {unit} at t = {time:.9g} s")

    @property
    def of_motion(self) -> Gap:
        """The equation of motion that is open furthest."""
        rows = slice(len(Level) * self.m, None)
        size = self._table[1][rows] + self.model.scales.efforts[:, None]
        row, share, value, time = self._worst(rows, size)
        unit = "N" if self.model.guesses.units[row] == "m" else "N m"
        name = self.model.guesses.names[row]
        text = f"the equation of motion of {name} is open by {value:.3g} {unit} at t = {time:.9g} s"
        return Gap(share, text)

    def _worst(self, rows: slice, size: np.ndarray) -> tuple[int, float, float, float]:
        """Row, share of the size, residual and time."""
        residuals = np.abs(self._table[0][rows])
        with np.errstate(all="ignore"):
            shares = residuals / size
        shares = np.where(np.isfinite(shares), shares, np.inf)
        row, k = np.unravel_index(int(np.argmax(shares)), shares.shape)
        time = self.s.t[self.looked[k]]
        return int(row), float(shares[row, k]), float(residuals[row, k]), float(time)


@once
def _everywhere(model: Model, count: int) -> Kernel:
    """``(t, y, v, p) → [|Φ|; T; V]`` for so many columns."""
    e = model.all_equations
    lengths = e.constraints * (e.scales.length / e.scales.rows)
    violation = ca.norm_inf(lengths) if lengths.numel() else ca.SX(0)
    wanted = ca.densify(ca.vertcat(violation, e.kinetic_energy, e.potential))
    function = ca.Function("everywhere", [e.t, e.y, e.v, e.p], [wanted], {"cse": True})
    return Kernel(function.map(count))


@once
def _residuals(model: Model, count: int) -> Kernel:
    """``(t, y, v, v̇, λ, p) →`` residuals, and sums of the magnitudes of their terms."""
    return Kernel(_equations(model).map(count))


@once
def _equations(model: Model) -> ca.Function:
    e = model.all_equations
    c, size = e.jacobian, ca.fabs(e.jacobian)
    psi, xi = e.velocity_constraints, e.constraint_acceleration
    driven = ca.substitute(psi, e.v, ca.SX.zeros(e.speed_count))
    push, pull = e.inertia.times(e.a), ca.mtimes(c.T, e.multiplier)
    pairs = [
        (e.constraints, ca.SX.zeros(e.constraint_count)),
        (psi, ca.mtimes(size, ca.fabs(e.v)) + ca.fabs(driven)),
        (ca.mtimes(c, e.a) - xi, ca.mtimes(size, ca.fabs(e.a)) + ca.fabs(xi)),
        (
            push + e.bias - e.force + pull,
            sum(map(ca.fabs, (push, e.bias, e.force)), ca.mtimes(size.T, ca.fabs(e.multiplier))),
        ),
    ]
    inputs = [e.t, e.y, e.v, e.a, e.multiplier, e.p]
    outputs = [ca.densify(ca.vertcat(*parts)) for parts in zip(*pairs, strict=True)]
    return ca.Function("residuals", inputs, outputs, {"cse": True})
