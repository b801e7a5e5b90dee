"""Residual check of the designs of a batch.

Residuals and tolerances are those of a single run. Designs that fail run individually, so the check
of a single run decides on their status.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.batch.states import MarchedStates, States
from dalembert.analysis.dynamics.residual_check import (
    DRIFT,
    energy_errors,
    energy_moved,
    held_levels,
)
from dalembert.analysis.model_residuals import (
    STILL,
    checked_outputs,
    constraint_rows,
    energies,
    motion_rows,
    violation,
)
from dalembert.analysis.residual_check import EXACT, MOTION
from dalembert.analysis.singular_positions import LOST
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.symbolic.once import once


class BatchResiduals:
    """Residuals of many designs.

    Parameters
    ----------
    states : MarchedStates, including the start
    designs : numbers of the designs that reached their end
    outputs : numbers of the instants that are outputs
    balance : largest permitted energy error, relative to the energy that took part

    Attributes
    ----------
    violations : (designs,) largest violation of a position at outputs [m]
    unbalanced : (designs,) largest relative energy error
    passed : (designs,) whether all residuals are within their tolerances
    """

    def __init__(
        self, states: MarchedStates, designs: np.ndarray, outputs: np.ndarray, balance: float
    ):
        self.states, self.designs = states, designs
        instants = np.arange(states.time.size)
        values = states.evaluate(at_outputs(states.model, states.bodies), designs, instants)
        violations, self._energies, defined = values[0][..., 0], values[1], values[2][..., 0]
        self.violations = violations[:, outputs].max(axis=1, initial=0.0)
        worst = np.argmax(np.nan_to_num(violations, nan=np.inf), axis=1)
        scales = states.model.scales
        with np.errstate(all="ignore"):
            self.unbalanced = self._unbalanced()
            shares = self._shares(worst)
            self.passed = (
                np.all(np.isfinite(defined), axis=1)
                & np.all(np.isfinite(states.x[designs]), axis=(1, 2))
                & (violations.max(axis=1, initial=0.0) <= LOST * scales.length)
                & np.all(shares <= 1, axis=1)
                & (self.unbalanced <= balance)
            )

    def _unbalanced(self) -> np.ndarray:
        e, x = self.states.kernel.equations, self.states.x[self.designs]
        n = e.coordinate_count + e.speed_count
        work = (x[:, :, n : n + 2] - x[:, :1, n : n + 2]).transpose(0, 2, 1)
        table = self._energies.transpose(0, 2, 1)
        moved = energy_moved(table, work, self.states.model.scales.energy)
        errors = np.abs(energy_errors(table, work)) / moved[:, None]
        return np.asarray(np.where(np.isfinite(errors), errors, np.inf).max(axis=1))

    def _shares(self, worst: np.ndarray) -> np.ndarray:
        """(designs, 4) residuals of each level and of the equations of motion over tolerances."""
        states, model = self.states, self.states.model
        spread = checked_outputs(states.time.size)
        outputs = np.column_stack([np.tile(spread, (worst.size, 1)), worst])
        values = states.evaluate(at_some(model, states.bodies, True), self.designs, outputs)
        relative, residuals, terms = (column.max(axis=1, initial=0.0) for column in values)
        shares = relative / np.array([*EXACT.values(), MOTION])
        enforced = held_levels(states.kernel)
        for level in Level:
            if level in enforced:
                continue
            share = relative[:, level]
            if level > Level.POSITION:
                least = STILL * model.scales.time**-level
                share = residuals[:, level] / np.fmax(terms[:, level], least)
            shares[:, level] = share / DRIFT
        return np.where(np.isfinite(shares), shares, np.inf)


def residual_shares(states: States, designs: np.ndarray, forces: bool) -> np.ndarray:
    """(designs,) largest residual over its tolerance, with all levels enforced exactly."""
    spread = checked_outputs(states.time.size)
    violation_at = violation(states.model)
    t, x, p = states.bodies.sx_in()
    y = states.bodies(t, x, p)[0]
    function = ca.Function("open", [t, x, p], [violation_at(t, y, p)])
    (violations,) = states.evaluate(function, designs, np.arange(states.time.size))
    worst = np.argmax(np.nan_to_num(violations[..., 0], nan=np.inf), axis=1)
    outputs = np.column_stack([np.tile(spread, (worst.size, 1)), worst])
    function = at_some(states.model, states.bodies, forces)
    residuals = states.evaluate(function, designs, outputs)[0].max(axis=1, initial=0.0)
    shares = residuals / np.array([*EXACT.values(), *([MOTION] if forces else [])])
    return np.asarray(np.where(np.isfinite(shares), shares, np.inf).max(axis=1))


@once
def at_outputs(model: Model, bodies: ca.Function) -> ca.Function:
    """``(t, x, p) →`` violation, kinetic and potential energy, and 0 (NaN if undefined)."""
    t, x, p = bodies.sx_in()
    y, v, a, multiplier = bodies.call([t, x, p])
    defined = ca.sum1(0 * ca.vertcat(a, multiplier))
    outputs = [violation(model)(t, y, p), energies(model)(t, y, v, p), ca.densify(defined)]
    return ca.Function("at_outputs", [t, x, p], outputs, {"cse": True})


@once
def at_some(model: Model, bodies: ca.Function, forces: bool) -> ca.Function:
    """``(t, x, p) →`` residuals over terms, by level and of motion; residuals, terms by level.

    The equations of motion are omitted without ``forces``.
    """
    e, scales = model.all_equations, model.scales
    t, x, p = bodies.sx_in()
    y, v, a, multiplier = bodies.call([t, x, p])
    m = e.constraint_count
    residual, terms = constraint_rows(model)(t, y, v, a, p)
    units = ca.SX(scales.rows)
    shares, relative, sizes = [], [], []
    for level in Level:
        part = slice(level * m, (level + 1) * m)
        magnitude, size = ca.fabs(residual[part]), terms[part]
        shares.append(_largest(magnitude / (size + units * scales.time**-level)))
        relative.append(_largest(magnitude / units))
        sizes.append(_largest(size / units))
    undefined = ca.sum1(0 * residual)  # the maximum ignores NaN
    if forces:
        padding = ca.SX.zeros(e.transmitted.numel() - multiplier.numel())
        imbalance, size = motion_rows(model)(t, y, v, a, ca.vertcat(multiplier, padding), p)
        shares.append(_largest(ca.fabs(imbalance) / (size + ca.SX(scales.efforts))))
        undefined += ca.sum1(0 * imbalance)
    shares[0] += undefined
    outputs = [ca.vertcat(*column) for column in (shares, relative, sizes)]
    return ca.Function("at_some", [t, x, p], outputs, {"cse": True})


def _largest(column: ca.SX) -> ca.SX:
    return ca.mmax(column) if column.numel() else ca.SX(0)
