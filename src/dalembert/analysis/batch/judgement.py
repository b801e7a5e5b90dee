"""Which designs of a batch are motions of the model beyond doubt.

The residuals, and the shares that are allowed, are those of a single run. What does not pass is run
on its own, so that there is one judge only.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.batch.states import MarchedStates, States
from dalembert.analysis.dynamics.energy_balance import energy_errors, energy_moved
from dalembert.analysis.dynamics.truth import DRIFT, held_levels
from dalembert.analysis.model_residuals import (
    STILL,
    constraint_rows,
    energies,
    looked_at,
    motion_rows,
    violation,
)
from dalembert.analysis.model_truth import EXACT, MOTION
from dalembert.analysis.singular_positions import LOST
from dalembert.formulations.base import Level
from dalembert.model.model import Model
from dalembert.symbolic.once import once


class Judgement:
    """Residuals of many designs.

    Parameters
    ----------
    states : MarchedStates, the start among its instants
    designs : numbers of the designs that came to their end
    outputs : numbers of the instants that are outputs
    balance : largest error of the energy over the energy that took part

    Attributes
    ----------
    violations : (designs,) largest violation of a position at outputs [m]
    unbalanced : (designs,) largest error of the energy, relative
    passed : (designs,)
    """

    def __init__(
        self, states: MarchedStates, designs: np.ndarray, outputs: np.ndarray, balance: float
    ):
        self.states, self.designs = states, designs
        every = np.arange(states.time.size)
        found = states.evaluate(at_outputs(states.model, states.bodies), designs, every)
        each, self._energies, defined = found[0][..., 0], found[1], found[2][..., 0]
        self.violations = each[:, outputs].max(axis=1, initial=0.0)
        worst = np.argmax(np.nan_to_num(each, nan=np.inf), axis=1)
        scales = states.model.scales
        with np.errstate(all="ignore"):
            self.unbalanced = self._unbalanced()
            shares = self._shares(worst)
            self.passed = (
                np.all(np.isfinite(defined), axis=1)
                & np.all(np.isfinite(states.x[designs]), axis=(1, 2))
                & (each.max(axis=1, initial=0.0) <= LOST * scales.length)
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
        """(designs, 4) what is open of each level and of motion, over what may be."""
        states, model = self.states, self.states.model
        spread = looked_at(states.time.size)
        outputs = np.column_stack([np.tile(spread, (worst.size, 1)), worst])
        found = states.evaluate(at_some(model, states.bodies, True), self.designs, outputs)
        opened, relative, terms = (values.max(axis=1, initial=0.0) for values in found)
        shares, held = opened / np.array([*EXACT.values(), MOTION]), held_levels(states.kernel)
        for level in Level:
            if level in held:
                continue
            open_by = opened[:, level]
            if level > Level.POSITION:
                least = STILL * model.scales.time**-level
                open_by = relative[:, level] / np.fmax(terms[:, level], least)
            shares[:, level] = open_by / DRIFT
        return np.where(np.isfinite(shares), shares, np.inf)


def open_by(states: States, designs: np.ndarray, forces: bool) -> np.ndarray:
    """(designs,) what is open where all levels are held, and of motion, over what may be."""
    spread = looked_at(states.time.size)
    violated = violation(states.model)
    t, x, p = states.bodies.sx_in()
    at = ca.Function("open", [t, x, p], [violated(t, states.bodies(t, x, p)[0], p)])
    (each,) = states.evaluate(at, designs, np.arange(states.time.size))
    worst = np.argmax(np.nan_to_num(each[..., 0], nan=np.inf), axis=1)
    outputs = np.column_stack([np.tile(spread, (worst.size, 1)), worst])
    function = at_some(states.model, states.bodies, forces)
    found = states.evaluate(function, designs, outputs)[0].max(axis=1, initial=0.0)
    shares = found / np.array([*EXACT.values(), *([MOTION] if forces else [])])
    return np.asarray(np.where(np.isfinite(shares), shares, np.inf).max(axis=1))


@once
def at_outputs(model: Model, bodies: ca.Function) -> ca.Function:
    """``(t, x, p) →`` violation, kinetic and potential energy, and 0 where all is defined."""
    t, x, p = bodies.sx_in()
    y, v, a, multiplier = bodies.call([t, x, p])
    defined = ca.sum1(0 * ca.vertcat(a, multiplier))
    outputs = [violation(model)(t, y, p), energies(model)(t, y, v, p), ca.densify(defined)]
    return ca.Function("at_outputs", [t, x, p], outputs, {"cse": True})


@once
def at_some(model: Model, bodies: ca.Function, forces: bool) -> ca.Function:
    """``(t, x, p) →`` shares of the terms, by level and of motion; residuals and terms by level.

    Where there are no forces, equations of motion are not looked at.
    """
    e, scales = model.all_equations, model.scales
    t, x, p = bodies.sx_in()
    y, v, a, multiplier = bodies.call([t, x, p])
    m = e.constraint_count
    left, terms = constraint_rows(model)(t, y, v, a, p)
    units = ca.SX(scales.rows)
    shares, relative, sizes = [], [], []
    for level in Level:
        part = slice(level * m, (level + 1) * m)
        away, size = ca.fabs(left[part]), terms[part]
        shares.append(_largest(away / (size + units * scales.time**-level)))
        relative.append(_largest(away / units))
        sizes.append(_largest(size / units))
    undefined = ca.sum1(0 * left)  # what is largest says nothing of NaN
    if forces:
        none = ca.SX.zeros(e.transmitted.numel() - multiplier.numel())
        away, size = motion_rows(model)(t, y, v, a, ca.vertcat(multiplier, none), p)
        shares.append(_largest(ca.fabs(away) / (size + ca.SX(scales.efforts))))
        undefined += ca.sum1(0 * away)
    shares[0] += undefined
    outputs = [ca.vertcat(*column) for column in (shares, relative, sizes)]
    return ca.Function("at_some", [t, x, p], outputs, {"cse": True})


def _largest(column: ca.SX) -> ca.SX:
    return ca.mmax(column) if column.numel() else ca.SX(0)
