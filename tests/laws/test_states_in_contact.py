"""States of first order in steps with rigid contacts."""

from __future__ import annotations

import functools

import numpy as np
import pytest
import scipy.integrate

import dalembert as da
from dalembert import planar

RADIUS, COIL, DROP = 0.1, 1.0, 0.5
RESTITUTION = 0.7
NOMINAL = {"resistance": 0.8, "drop": DROP}


@functools.cache
def hopper(floor: float = 0.0, inductance: float = 0.05, balls: int = 1) -> da.Model:
    """Balls with voice coils, whose currents are states, above a floor."""
    system = da.System("hopper", gravity=(0, -9.81))
    resistance = system.parameter("resistance", NOMINAL["resistance"])
    drop = system.parameter("drop", NOMINAL["drop"])
    shapes = [planar.contact.HalfPlane(system.ground.point(0, floor), (0, 1))]
    for k in range(balls):
        name = f"ball{k}"
        place = (k, RADIUS + drop * (1 + 0.1 * k))
        ball = system.add(planar.Body(name, mass=1.0, inertia=0.01, position=place, angle=0))
        current = system.add(da.blocks.State(f"current{k}", unit="A"))
        voltage = 2 * da.sin(9 * da.t)
        current.rate = (voltage - resistance * current.value - COIL * ball.vy) / inductance
        system.add(planar.Force(f"coil{k}", ball.center, (0, COIL * current.value)))
        shapes.append(planar.contact.Circle(ball, RADIUS))
    system.add(planar.Collisions("contacts", shapes, restitution=RESTITUTION))
    return system.build()


def exact(
    duration: float,
    inductance: float = 0.05,
    floor: float = 0.0,
    resistance: float = NOMINAL["resistance"],
    drop: float = DROP,
) -> np.ndarray:
    """Height, speed and current of the first ball, with impacts located by SciPy."""

    def rates(t, x):
        current = (2 * np.sin(9 * t) - resistance * x[2] - COIL * x[1]) / inductance
        return [x[1], -9.81 + COIL * x[2], current]

    def touch(t, x):
        return x[0] - floor - RADIUS

    touch.terminal, touch.direction = True, -1
    t, x = 0.0, np.array([RADIUS + drop, 0.0, 0.0])
    settings = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "events": touch}
    while t < duration:
        run = scipy.integrate.solve_ivp(rates, (t, duration), x, **settings)
        t, x = run.t[-1], run.y[:, -1].copy()
        if run.status == 1:
            x[0], x[1] = floor + RADIUS + 1e-15, -RESTITUTION * x[1]
    return x


def errors(duration: float, steps: tuple[float, ...], reference, **options) -> np.ndarray:
    model = hopper(**options)
    ends = []
    for step in steps:
        motion = da.solve_nonsmooth(model, duration, step=step)
        assert motion.status.success, motion.status
        ends.append([motion[n][-1].item() for n in ("ball0.y", "ball0.vy", "current0.value")])
    return np.abs(np.array(ends) - reference).max(axis=1)


@pytest.mark.few(1)
@pytest.mark.parametrize("inductance", [0.05, 1e-4])
def test_steps_without_contact_are_of_second_order(inductance):
    """Also where the time constant of the state is shorter than the step."""
    case = {"inductance": inductance, "floor": -50.0}
    coarse, fine = errors(0.4, (4e-3, 1e-3), exact(0.4, **case), **case)
    assert fine < coarse / 14 and fine < 2e-4


@pytest.mark.thorough
def test_impacts_change_speeds_and_not_states():
    """Against impacts located by SciPy; the instants of impacts have errors of the step."""
    reference = exact(0.9)
    coarse, fine = errors(0.9, (2e-3, 5e-4), reference)
    assert fine < coarse / 2.5 and fine < 2e-3


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("integrator", "counts"), [(da.AnticipatedImpacts(), (1, 2)), (da.MoreauJean(), (1,))]
)
def test_gradients_pass_through_states_and_impacts(integrator, counts):
    """Against differences of SciPy's solution; a second ball does not change them."""
    responses, span, change = [da.Final("current0.value"), da.Final("ball0.y")], 0.9, 1e-5
    gradients = []
    for balls in counts:
        motion = da.solve_nonsmooth(hopper(balls=balls), span, step=5e-4, integrator=integrator)
        direct, adjoint = (
            da.sensitivity(motion, responses, method=method).values
            for method in ("direct", "adjoint")
        )
        assert np.allclose(direct, adjoint, rtol=1e-9, atol=1e-12 * np.abs(direct).max())
        gradients.append(direct)
    assert np.allclose(
        gradients[0], gradients[-1], rtol=1e-4
    )  # instants of impacts have errors of the step
    for k, shift in enumerate(({"resistance": change}, {"drop": change})):
        ends = [
            exact(span, **{name: NOMINAL[name] + sign * s for name, s in shift.items()})[[2, 0]]
            for sign in (1, -1)
        ]
        assert np.allclose(gradients[0][:, k], (ends[0] - ends[1]) / (2 * change), rtol=3e-2)
