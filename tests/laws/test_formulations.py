"""Formulations: all give the same accelerations and multipliers, whoever looks at the mechanism."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from registry import CASES, COMBINED, FORMULATIONS, PLANAR, Observer, definite, model_of
from twins import turn

from dalembert.elements.pair import Pair
from dalembert.symbolic.once import once

MOVED = Observer(angle=0.7, shift=(0.4, -1.1), boost=(1.3, 0.6))


def solution(model, formulation, t, y, v, p) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations and multipliers."""
    function = _law(model, formulation)
    return tuple(a.full().ravel() for a in function(t, np.concatenate([y, v, [0, 0]]), p))


@once
def _law(model, formulation):
    e, formulation_used = model.equations, definite(FORMULATIONS[formulation], model)
    return formulation_used.acceleration(e, e.constraint_acceleration).function


@pytest.mark.few(27)
@pytest.mark.parametrize(("name", "formulation"), COMBINED)
def test_all_formulations_agree(name, formulation):
    """The same v̇ and λ to 1e-9, massless coordinates included."""
    model = model_of(name)
    state = (0.0, model.start.y, model.start.v, model.nominal)
    for computed, expected in zip(
        solution(model, formulation, *state), solution(model, "KKT", *state), strict=True
    ):
        scale = 1 + np.abs(expected).max(initial=0)
        np.testing.assert_allclose(computed, expected, atol=1e-9 * scale)


def moved(model, vector: np.ndarray, angle: float, shift, spin: float) -> np.ndarray:
    """Poses, speeds or accelerations as another observer sees them."""
    out, k = vector.copy(), 0
    for body in model.bodies:
        out[k : k + 2] = turn(angle, vector[k : k + 2]) + shift
        if body.rotates:
            out[k + 2] += spin
        k += body.pose.numel()
    return out


@functools.cache
def weightless(name: str, observer: Observer):
    return CASES[name].model(gravity=False, observer=observer)


def reactions(model, y, v, a, multiplier) -> tuple[np.ndarray, np.ndarray]:
    """Forces (joints, 2) and moments (joints,) of all joints."""
    e = model.equations
    computed = [c.reaction() for c in model.constraints if isinstance(c, Pair)]
    columns = [model.at_ground(ca.vertcat(*pair)) for pair in computed]
    function = ca.Function("r", [e.t, e.y, e.v, e.a, e.multiplier, e.p], [ca.horzcat(*columns)])
    table = function(0.0, y, v, a, multiplier, model.nominal).full()
    return table[:2].T, table[2]


@pytest.mark.few(13)
@pytest.mark.parametrize("name", [n for n in PLANAR if CASES[n].objective])
def test_forces_do_not_depend_on_the_observer(name):
    """Turned, shifted and in uniform motion: accelerations and reactions turn, no more."""
    here, there = weightless(name, Observer()), weightless(name, MOVED)
    y, v = here.start.y, here.start.v
    y_moved = moved(here, y, MOVED.angle, MOVED.shift, MOVED.angle)
    v_moved = moved(here, v, MOVED.angle, MOVED.boost, 0.0)
    a, multiplier = solution(here, "KKT", 0.0, y, v, here.nominal)
    a_moved, multiplier_moved = solution(there, "KKT", 0.0, y_moved, v_moved, there.nominal)
    limit = 1e-10 * (1 + np.abs(a).max())
    np.testing.assert_allclose(a_moved, moved(here, a, MOVED.angle, 0.0, 0.0), atol=limit)
    if multiplier.size:
        force, moment = reactions(here, y, v, a, multiplier)
        force_moved, moment_moved = reactions(there, y_moved, v_moved, a_moved, multiplier_moved)
        np.testing.assert_allclose(force_moved.T, turn(MOVED.angle, force.T), atol=limit)
        np.testing.assert_allclose(moment_moved, moment, atol=limit)
