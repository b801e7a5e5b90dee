"""Switches of formulas and elements: found in the graph, held in steps, located, differentiated."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from thorough import crossed

import dalembert as da
from dalembert import planar
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.functions import maximum, minimum, sign, where
from dalembert.symbolic.formulas.switches import freeze_branches

INTEGRATORS = {
    "Dormand-Prince": (da.DormandPrince, da.RangeSpace()),
    "Dormand-Prince 853": (da.DormandPrince853, da.RangeSpace()),
    "Radau, index 3": (da.Radau, da.DAE(index=3)),
    "Radau, ODE": (da.Radau, da.RangeSpace()),
    "BDF": (da.BDF, da.DAE(index=3)),
}
END = 2.0


def stop(t, x, v, k):
    """What ``planar.Stop`` says it does, written out."""
    upper, lower = x - 0.2, -0.1 - x
    push = where(lower > 0, k * lower**1.5 * maximum(0, 1 - 0.3 * v), 0)
    return push - where(upper > 0, k * upper**1.5 * maximum(0, 1 + 0.3 * v), 0)


FORCES = {
    "kink": lambda t, x, v, p: where(x > 0.3, -900 * p * (x - 0.3), 0),
    "jump": lambda t, x, v, p: where(x < 0.3 * p, 0, -2 - v),
    "drag": lambda t, x, v, p: -1.5 * abs(v - 0.2 * p) * (v - 0.2) - 2 * x,
    "sign of place": lambda t, x, v, p: -2 * p * sign(x - 0.1),
    "saturation": lambda t, x, v, p: maximum(-0.8, minimum(0.8 * p, -20 * x)),
    "power of what is left": lambda t, x, v, p: -1e4 * p * maximum(x - 0.2, 0) ** 1.5,
    "power left out": lambda t, x, v, p: where(x > 0.2, -1e4 * p * (x - 0.2) ** 1.5, 0),
    "instant": lambda t, x, v, p: where(t > 0.7 * p, -3, 1),
    "two at once": lambda t, x, v, p: where(x > 0.3 * p, -1, 0) - where(2 * x < 0.6 * p, 0, v),
    "nested": lambda t, x, v, p: where(abs(x) > 0.3 * p, -2 * x, where(v > 0.5, -1, 0.5)),
    "across and back": lambda t, x, v, p: where(t > 0.7 * p, where(t < 0.9 * p, -5, 0), 0),
    "from the switch": lambda t, x, v, p: where(x > 0, -3 * p, 1),
    "stop": lambda t, x, v, p: stop(t, x, v, 2e3 * p),
}
"""Forces on a particle of 1 kg that starts from 0 with 1 m/s; p is 1."""


@functools.cache
def model(name: str):
    system = da.System("pushed", gravity=(0, 0))
    p = system.parameter("p", 1.0)
    b = system.add(planar.Particle("b", mass=1.0, position=(0, 0), velocity=(1, 0)))
    if name == "stop":
        options = {"lower": -0.1, "upper": 0.2, "damping": 0.3, "exponent": 1.5}
        system.add(planar.Stop("push", b.x, stiffness=2e3 * p, **options))
    else:
        system.add(planar.Force("push", b.point(0, 0), (FORCES[name](da.t, b.x, b.vx, p), 0)))
    return system.build()


@functools.cache
def reference(name: str, p: float = 1.0) -> np.ndarray:
    """Place and speed at the end, by steps so short that it does not matter where they end."""
    symbols = [ca.SX.sym(s) for s in "txvp"]
    formula = FORCES[name](*map(Expression, symbols)).sx
    function = ca.Function("force", [ca.vertcat(*symbols)], [ca.densify(formula)])
    buffer, evaluate = function.buffer()
    inputs, force = np.zeros(4), np.zeros(1)
    buffer.set_arg(0, memoryview(inputs))
    buffer.set_res(0, memoryview(force))

    def rate(time: float, z: np.ndarray) -> tuple[float, float]:
        inputs[:] = time, *z, p
        evaluate()
        return z[1], force[0]

    return solve_ivp(
        rate,
        (0, END),
        [0.0, 1.0],
        "DOP853",
        rtol=1e-11,
        atol=1e-12,
        max_step=2e-3,
    ).y[:, -1]


@functools.cache
def run(name: str, method: str, rtol: float = 1e-10, **options):
    integrator, formulation = INTEGRATORS[method]
    return da.solve_dynamics(
        model(name),
        END,
        integrator=integrator(rtol=rtol, atol=rtol / 100),
        formulation=formulation,
        **options,
    )


@pytest.mark.few(1)
@pytest.mark.parametrize("name", FORCES)
def test_motions_over_switches(name):
    for method in INTEGRATORS:
        motion = run(name, method)
        computed = [motion[f"b.{measure}"].values[-1] for measure in ("x", "vx")]
        assert motion.status.success, (method, motion.status)
        np.testing.assert_allclose(computed, reference(name), rtol=0, atol=1e-6, err_msg=method)


DIFFERENTIABLE = sorted({*FORCES} - {"power left out"})  # 0·NaN, with or without


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "method"), crossed(DIFFERENTIABLE, INTEGRATORS, 2))
def test_gradients_over_switches(name, method):
    """Direct and adjoint are one, and the derivative of the motion itself, jumps or none."""
    step = 1e-4
    wanted = (reference(name, 1 + step) - reference(name, 1 - step)) / (2 * step)
    responses = [da.final("b.x"), da.final("b.vx")]
    motion = run(name, method)
    adjoint = da.sensitivity(motion, responses, method="adjoint").values.ravel()
    direct = da.sensitivity(motion, responses, method="direct").values.ravel()
    size = np.max(np.abs(wanted))
    exact = 5e-3 if "index 3" in method else 5e-4  # speeds of index 3 have order 3
    np.testing.assert_allclose(direct, adjoint, rtol=0, atol=1e-9 * size)
    np.testing.assert_allclose(adjoint, wanted, rtol=0, atol=exact * size)


@pytest.mark.parametrize("method", INTEGRATORS)
def test_steps_end_at_switches(method):
    """The particle touches at 0.3 s and leaves half a period of the contact later."""
    motion = run("kink", method)
    for instant in (0.3, 0.3 + np.pi / 30):
        assert np.min(np.abs(motion.time - instant)) < 1e-8


@pytest.mark.few(2)
@pytest.mark.parametrize("method", INTEGRATORS)
def test_repeated_runs_go_over_switches_again(method):
    """Steps repeated with other parameters move with them as their gradients say."""
    motion, step = run("jump", method), 1e-6
    gradient = da.sensitivity(motion, [da.final("b.x")]).values.item()
    ends = [motion.analysis.replay(motion, np.array([1 + s * step])) for s in (1, -1)]
    difference = np.subtract(*(end["b.x"].values[-1] for end in ends)) / (2 * step)
    assert abs(difference - gradient) < 1e-6 * abs(gradient)


@pytest.mark.thorough
def test_periodic_rises():
    """All switches of a law at once, where its time begins anew."""
    system = da.System("driven", gravity=(0.0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.0, angle=0.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    times = {"duration": 0.2, "begin": 0.1, "dwell": 0.1, "fall": 0.3, "period": 0.8}
    law = da.HarmonicRise(height=0.5, **times)
    system.add(planar.RotationalDriver("drive", system.ground, crank, law))
    rod = system.add(planar.Bar("rod", length=0.5, mass=1.0, angle=-1.0))
    system.add(planar.Revolute("A", crank.end, rod.start))
    driven = system.build()
    wanted = da.solve_dynamics(driven, END, step=2e-4)["rod.angle"].values[-1]
    ends = []
    for method in ("Dormand-Prince", "Radau, index 3", "BDF"):
        integrator, formulation = INTEGRATORS[method]
        options = {"integrator": integrator(rtol=1e-9, atol=1e-11), "formulation": formulation}
        ends.append(da.solve_dynamics(driven, END, **options)["rod.angle"].values[-1])
    assert np.ptp(ends) < 1e-7
    assert abs(ends[0] - wanted) < 1e-5  # fixed steps lose their order at jumps of acceleration


def notes(name: str, response, **options) -> str:
    motion = da.solve_dynamics(model(name), END, **options)
    return "; ".join(da.sensitivity(motion, [response]).attrs["notes"])


def test_notes_of_gradients_over_switches():
    """Notes about switches that fixed steps went over; none where they were located."""
    adaptive = {"integrator": da.DormandPrince()}
    assert "went over switches" in notes("jump", da.final("b.x"), step=0.01)
    for response in (da.final("b.x"), da.integral("b.vx"), da.integral("b.ax")):
        messages = notes("jump", response, **adaptive)
        assert "switch" not in messages and "independent speeds" not in messages


@pytest.mark.thorough
def test_integrals_of_what_is_continuous_over_switches():
    """The integral of a speed is the way, and so are their derivatives."""
    for method in INTEGRATORS:
        motion = run("jump", method)
        both = da.sensitivity(motion, [da.integral("b.vx"), da.final("b.x")]).values.ravel()
        assert abs(da.evaluate(motion, da.integral("b.vx")) - motion["b.x"].values[-1]) < 1e-8
        assert abs(both[0] - both[1]) < 1e-6 * abs(both[1]), method


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["jump", "instant", "sign of place", "nested", "drag"])
def test_integrals_of_what_jumps_at_switches(name):
    """The integral of an acceleration is the change of the speed: instants of jumps move."""
    responses = [da.integral("b.ax"), da.final("b.vx")]
    for method in ("Dormand-Prince", "Radau, ODE"):
        for way in ("direct", "adjoint"):
            both = da.sensitivity(run(name, method), responses, method=way).values.ravel()
            assert abs(both[0] - both[1]) < 1e-6 * max(abs(both[1]), 1), (method, way)


def test_second_derivatives_over_switches_are_refused():
    with pytest.raises(da.UnsupportedError, match="second derivatives through switches"):
        da.hessian_product(run("jump", "Dormand-Prince"), da.final("b.x"), {"p": 1.0})


def test_friction_that_sticks_is_told():
    """Dry friction by a sign stops the particle, and from both sides holds it there."""
    for method in INTEGRATORS:
        system = da.System("sledge", gravity=(0, 0))
        b = system.add(planar.Particle("b", mass=1.0, position=(0, 0), velocity=(1, 0)))
        system.add(planar.Force("rubbing", b.point(0, 0), (-sign(b.vx), 0)))
        integrator, formulation = INTEGRATORS[method]
        motion = da.solve_dynamics(
            system.build(), 3.0, integrator=integrator(), formulation=formulation
        )
        assert motion.status.outcome is da.Outcome.CHATTERING
        assert not motion.status.success
        assert "rubbing" in motion.status.message and "tanh" in motion.status.message
        assert abs(motion.status.time - 1.0) < 1e-6
        assert abs(motion["b.x"].values[-1] - 0.5) < 1e-6


def test_switches_that_crowd_are_told():
    """A damped fall back to a force that turns: infinitely many switches in a finite time."""
    system = da.System("relay", gravity=(0, 0))
    b = system.add(planar.Particle("b", mass=1.0, position=(1, 0)))
    relay = where(b.x > 0, -1 - 0.5 * sign(b.vx), 1 - 0.5 * sign(b.vx))
    system.add(planar.Force("relay", b.point(0, 0), (relay, 0)))
    motion = da.solve_dynamics(system.build(), 20.0, integrator=da.DormandPrince())
    assert motion.status.outcome is da.Outcome.CHATTERING, motion.status
    assert "relay" in motion.status.message
    # from 1 m at rest: 2 s to the origin with 1 N, then arcs that shrink as √(0.5/1.5)
    ratio = np.sqrt(0.5 / 1.5)
    arc = 1 / 1.5 + ratio / 0.5
    assert abs(motion.status.time - (2 + arc / (1 - ratio))) < 1e-5


def held(expression: ca.SX, x: ca.SX):
    (formula,), switches = freeze_branches([expression], x)
    return ca.Function("held", [x, switches.sides], [formula, switches.functions]), switches


def test_held_formulas_are_the_formulas_on_their_sides():
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p")
    formulas = [
        ca.vertcat(
            ca.if_else(x[0] > 0, x[0] ** 1.5, 0),
            ca.if_else(x[0] < 0, 1, 2),
            ca.fmax(x[0] - x[1], p) ** 1.5 * ca.sign(x[1]),
        ),
        ca.diag(ca.vertcat(ca.fabs(x[1]), p, ca.fmax(p, 3))),
    ]
    computed, switches = freeze_branches(formulas, x)
    assert switches.count == 3  # those of x₀ are one, that of p is none
    plain = ca.Function("plain", [x, p], [*formulas, switches.actual])
    seen = ca.Function("seen", [x, switches.sides, p], computed)
    rng = np.random.default_rng(3)
    for _ in range(50):
        place, value = rng.normal(size=2), abs(rng.normal())
        *wanted, sides = plain(place, value)
        for one, other in zip(wanted, seen(place, sides, value), strict=True):
            np.testing.assert_array_equal(one.full(), other.full())


def test_powers_go_on_beyond_their_switch_only():
    x = ca.SX.sym("x")
    function, _ = held(ca.if_else(x > 0, x**1.5, 0), x)
    assert float(function(-0.25, 1)[0]) == -0.125
    bare, _ = held(x**1.5 + ca.fabs(x - 9), x)
    assert np.isnan(float(bare(-0.25, 0)[0]))


def test_a_run_lost_at_a_dead_centre_tells_it_beside_switches():
    """A slider-crank is driven beyond its reach by a law in two pieces."""
    system = da.System("too far")
    crank = system.add(planar.Bar("crank", length=1.2, mass=1, angle=0.8))
    rod = system.add(planar.Bar("rod", length=1.0, mass=1, angle=-0.8))
    slider = system.add(planar.Particle("slider", mass=1, position=(1.3, 0)))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.UserConstraint("level", slider.y))
    law = 0.8 + 4 * da.t - da.where(da.t < 0.1, da.t, 2 * da.t - 0.1)
    system.add(planar.RotationalDriver("motor", system.ground, crank, law))
    motion = da.solve_dynamics(system.build(), 1.0, step=1e-3, integrator=da.DormandPrince())
    assert motion.status.outcome is da.Outcome.SINGULAR
    assert "motor" in motion.status.message
