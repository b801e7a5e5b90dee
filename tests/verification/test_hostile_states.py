"""States of first order that are stiff, discontinuous, late or badly scaled, against SciPy.

Every case states its equations twice: as blocks on a sled of 1 kg on a rail that starts at 1 m, and
by hand for ``solve_ivp``, with the instants of jumps located.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar
from dalembert.errors import ExpressionError, ModelError
from dalembert.symbolic.formulas.functions import maximum, minimum

SETTINGS = {"method": "Radau", "rtol": 1e-10, "atol": 1e-13}
State = da.blocks.State


class Case(NamedTuple):
    """Builder of states, returning the force; rates by hand; start of the states; tolerance."""

    build: Callable
    rates: Callable
    start: tuple[float, ...]
    duration: float = 3.0
    tolerance: float = 1e-6


def states(system: da.System, start: tuple[float, ...]) -> list:
    return [system.add(State(f"z{k}", start=value)) for k, value in enumerate(start)]


def stiff_chain(system, sled):
    """Time constants of 0.1 µs and 1 ms in series."""
    z, w = states(system, (0.0, 0.0))
    z.rate = (da.sin(3 * da.t) * sled.x - z.value) / 1e-7
    w.rate = (z.value - w.value) / 1e-3
    return -4 * sled.x + w.value


def algebraic(system, sled):
    """A gain of 10⁹: ``z³/16 = −4 x`` but where its slope is infinite."""
    (z,) = states(system, (-4.0,))
    z.rate = 1e9 * (-4 * sled.x - z.value**3 / 16)
    return z.value


def saturating(system, sled):
    (z,) = states(system, (0.0,))
    z.rate = (minimum(maximum(-5 * sled.x - sled.vx, -1.0), 1.0) - z.value) / 0.05
    return z.value


def dead_zone(system, sled):
    (z,) = states(system, (0.0,))
    over = maximum(sled.x - 0.2, 0.0) + minimum(sled.x + 0.2, 0.0)
    z.rate = (-over - z.value) / 0.02
    return 6 * z.value


def hidden(system, sled):
    """An unstable state that no force sees."""
    (z,) = states(system, (1e-3,))
    z.rate = z.value + sled.x
    return -4 * sled.x


def chained(system, sled):
    """Five integrators with gains of 1000 from 10⁻⁹."""
    chain = states(system, (0.0,) * 5)
    chain[0].rate = 1e-9 * sled.x
    for first, second in pairwise(chain):
        second.rate = 1e3 * first.value
    return -4 * sled.x + chain[-1].value


def tiny_and_huge(system, sled):
    z, w = states(system, (1e-14, 1e12))
    z.rate = 1e-14 * sled.vx - z.value
    w.rate = 1e12 * sled.x - w.value
    return -4 * sled.x + 1e14 * z.value + 1e-12 * w.value


def hysteresis(system, sled):
    """Bouc and Wen."""
    (z,) = states(system, (0.0,))
    v = sled.vx
    size = da.sqrt(v**2) * da.sqrt(z.value**2)
    z.rate = v - 0.5 * size * z.value - 0.5 * v * z.value**2
    return -4 * z.value - 0.5 * sled.x + da.sin(2 * da.t)


def units(system, sled):
    z = system.add(State("z0", start="20 mm", unit="mm"))
    z.rate = (sled.x - z.value) / 0.2
    return -5 * z.value


def tabulated(system, sled):
    """A spline of a cubic is this cubic."""
    x = np.linspace(-3, 3, 13)
    table = system.table("characteristic", x, x**3 - 2 * x)
    (z,) = states(system, (0.0,))
    z.rate = (sled.x - z.value) / 0.3
    return -table(z.value) - 3 * sled.x


def second_order_lag(system, sled):
    """A zero in the right half plane."""
    u = da.sin(2 * da.t) + 0.3 * sled.x
    block = da.blocks.TransferFunction("g", u, numerator=(1, -1), denominator=(0.5, 1.2, 1))
    return system.add(block).output - 2 * sled.x


def multiplied(system, sled):
    """Parametric excitation: states multiply forces and each other."""
    z, w = states(system, (1.0, 0.5))
    z.rate = w.value * z.value * da.cos(3 * da.t) - 0.1 * z.value
    w.rate = -w.value + sled.vx * z.value
    return -4 * z.value * sled.x - w.value * sled.vx


CASES = {
    "stiff chain": Case(
        stiff_chain,
        lambda t, x, v, z, w: (
            -4 * x + w,
            (np.sin(3 * t) * x - z) / 1e-7,
            (z - w) / 1e-3,
        ),
        (0.0, 0.0),
    ),
    "algebraic": Case(
        algebraic, lambda t, x, v, z: (z, 1e9 * (-4 * x - z**3 / 16)), (-4.0,), 4.0, 2e-5
    ),
    "saturating": Case(
        saturating,
        lambda t, x, v, z: (z, (min(max(-5 * x - v, -1.0), 1.0) - z) / 0.05),
        (0.0,),
    ),
    "dead zone": Case(
        dead_zone,
        lambda t, x, v, z: (6 * z, (-(max(x - 0.2, 0.0) + min(x + 0.2, 0.0)) - z) / 0.02),
        (0.0,),
    ),
    "hidden": Case(hidden, lambda t, x, v, z: (-4 * x, z + x), (1e-3,), 8.0),
    "chained": Case(
        chained,
        lambda t, x, v, *z: (-4 * x + z[-1], 1e-9 * x, *(1e3 * k for k in z[:-1])),
        (0.0,) * 5,
        1.0,
    ),
    "tiny and huge": Case(
        tiny_and_huge,
        lambda t, x, v, z, w: (-4 * x + 1e14 * z + 1e-12 * w, 1e-14 * v - z, 1e12 * x - w),
        (1e-14, 1e12),
    ),
    "hysteresis": Case(
        hysteresis,
        lambda t, x, v, z: (
            -4 * z - 0.5 * x + np.sin(2 * t),
            v - 0.5 * abs(v) * abs(z) * z - 0.5 * v * z**2,
        ),
        (0.0,),
        6.0,
    ),
    "units": Case(units, lambda t, x, v, z: (-5 * z, (x - z) / 0.2), (0.02,)),
    "table": Case(tabulated, lambda t, x, v, z: (-(z**3 - 2 * z) - 3 * x, (x - z) / 0.3), (0.0,)),
    "zero of a transfer function": Case(
        second_order_lag,
        lambda t, x, v, q, r: (
            r - q - 2 * x,
            r,
            (np.sin(2 * t) + 0.3 * x - 1.2 * r - q) / 0.5,
        ),
        (0.0, 0.0),
    ),
    "multiplied": Case(
        multiplied,
        lambda t, x, v, z, w: (
            -4 * z * x - w * v,
            w * z * np.cos(3 * t) - 0.1 * z,
            -w + v * z,
        ),
        (1.0, 0.5),
    ),
}


def on_a_sled(build: Callable) -> da.Model:
    system = da.System("sled")
    sled = system.add(planar.Particle("sled", mass=1.0, position=(1.0, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, sled.center))
    system.add(planar.Force("force", sled.center, (build(system, sled), 0)))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize("name", CASES)
def test_states_agree_with_scipy(name):
    case = CASES[name]
    model = on_a_sled(case.build)
    motion = da.solve_dynamics(model, case.duration, outputs=31)
    assert motion.status.success, motion.status

    def rates(t, x):
        return [x[1], *case.rates(t, *x)]

    start, t = [1.0, 0.0, *case.start], np.asarray(motion.time)
    x = solve_ivp(rates, (0, case.duration), start, t_eval=t, **SETTINGS).y
    names = [n for n in (f"z{k}.value" for k in range(len(case.start))) if n in model]
    for row, measure in enumerate(("sled.x", "sled.vx", *names)):
        size = np.abs(x[row]).max()
        error = np.abs(motion[measure].values - x[row]).max()
        assert error < case.tolerance * size, (measure, error, size)


def test_relay_of_a_position():
    """A bang-bang force through a lag, with the instants of switching located by SciPy."""

    def relay(system, sled):
        (z,) = states(system, (0.0,))
        z.rate = (da.where(sled.x > 0, -1.0, 1.0) - z.value) / 0.3
        return 3 * z.value

    motion = da.solve_dynamics(on_a_sled(relay), 6.0, outputs=31)
    t, x, begin, sign = np.asarray(motion.time), np.array([1.0, 0.0, 0.0]), 0.0, -1.0
    expected = np.zeros((3, t.size))
    while begin < 6.0:

        def crossing(_, x):
            return x[0]

        crossing.terminal, crossing.direction = True, sign  # type: ignore[attr-defined]
        run = solve_ivp(
            lambda t, x, sign=sign: [x[1], 3 * x[2], (sign - x[2]) / 0.3],
            (begin, 6.0), x, events=crossing, dense_output=True, **SETTINGS,
        )  # fmt: skip
        inside = (t >= begin) & (t <= run.t[-1])
        expected[:, inside] = run.sol(t[inside])
        begin, x = run.t[-1], run.y[:, -1]
        if run.status == 1:
            sign, x[0] = -sign, 0.0
    assert motion.status.success
    np.testing.assert_allclose(motion["sled.x"], expected[0], atol=1e-7)
    np.testing.assert_allclose(motion["z0.value"], expected[2], atol=1e-7)


def test_delay_by_the_method_of_steps():
    """A damper acts on a late position; the delay begins at the position of the start."""

    def late(system, sled):
        delay = da.blocks.TransportDelay("late", sled.x, delay=0.1, order=6, start=1.0)
        return -4 * system.add(delay).output - 0.9 * sled.vx

    motion = da.solve_dynamics(on_a_sled(late), 2.0, step=1e-3)
    pasts, x = [lambda t: 1.0], np.array([1.0, 0.0])
    expected = [1.0]
    for k in range(20):  # intervals of the length of the delay
        past, (a, b) = pasts[-1], (0.1 * k, 0.1 * (k + 1))
        run = solve_ivp(
            lambda t, x, past=past: [x[1], -4 * past(t - 0.1) - 0.9 * x[1]],
            (a, b), x, dense_output=True, **SETTINGS,
        )  # fmt: skip
        pasts.append(lambda t, run=run: run.sol(t)[0])
        x = run.y[:, -1]
        expected.append(x[0])
    np.testing.assert_allclose(motion["sled.x"][::100], expected, atol=2e-6)


def test_states_without_a_solution_end_with_a_reason():
    def escaping(system, sled):
        (z,) = states(system, (1.0,))
        z.rate = z.value**2  # infinite after one second
        return -4 * sled.x + 0.1 * z.value

    status = da.solve_dynamics(on_a_sled(escaping), 2.0, outputs=11).status
    assert not status.success and "t = 1 s" in status.message


def test_states_of_accelerations_and_jumping_positions_are_refused():
    def accelerated(system, sled):
        (z,) = states(system, (0.0,))
        z.rate = (sled.ax - z.value) / 0.1
        return -2 * z.value

    with pytest.raises(ExpressionError, match=r"z0: depends on sled\.ax"):
        on_a_sled(accelerated)

    def stepping(filters):
        system = da.System("stepping")
        sled = system.add(planar.Particle("sled", mass=1.0, position=(1.0, 0)))
        system.add(planar.PinInSlot("rail", system.ground.center, sled.center))
        hold = da.blocks.ZeroOrderHold("hold", da.sin(3 * da.t), sample_time=0.1)
        law = system.add(hold).output
        for k in range(filters):
            law = system.add(da.blocks.LowPass(f"filter{k}", law, cutoff=20.0)).output
        system.add(planar.CoordinateDriver("drive", sled.center, 1 + law))
        return system.build()

    for filters in (0, 1):
        with pytest.raises(ModelError, match=r"drive: its position or speed follows hold"):
            stepping(filters)
    motion = da.solve_dynamics(stepping(2), 1.0, outputs=11)

    def rates(t, x):
        held = np.sin(3 * 0.1 * np.floor(t / 0.1 + 1e-9))
        return [20 * (held - x[0]), 20 * (x[0] - x[1])]

    x, values = np.zeros(2), [1.0]
    for k in range(10):
        x = solve_ivp(rates, (0.1 * k, 0.1 * (k + 1) - 1e-12), x, **SETTINGS).y[:, -1]
        values.append(1 + x[1])
    assert motion.status.success
    np.testing.assert_allclose(motion["sled.x"], values, atol=1e-7)
