"""A ball that rolls over the valley between two planes of a terrain, and over a turntable.

It turns about its new contact point after an inelastic impact, in which the angular momentum about
that point is conserved: ``v⁺ = v⁻ (2/5 + cos δ)/(7/5)`` for the angle δ between the planes. On a
turntable with the angular velocity Ω it follows circles with ``2/7 Ω`` (J. A. Burns, Am. J. Phys.
49, 1981).
"""

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

contact = spatial.contact
RADIUS, SPEED = 0.1, 2.0


@pytest.mark.few(1)
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("turn", [0.1, 0.3])
def test_loss_of_energy_at_a_valley(turn, integrator):
    system, x = da.System("valley", gravity=(0, 0, -2.0)), np.array([-1.0, 0.0, 1.0])
    heights = np.outer(np.maximum(np.tan(turn) * x, 0.0), np.ones(3))
    terrain = contact.HeightField(system.ground.frame(), (2.0, 1.0), heights)
    start = {"velocity": (SPEED, 0, 0), "angular_velocity": (0, SPEED / RADIUS, 0)}
    ball = spatial.Sphere("ball", radius=RADIUS, mass=1.0, position=(-0.3, 0, RADIUS), **start)
    shapes = [contact.Sphere(system.add(ball).center, RADIUS), terrain]
    system.add(spatial.Collisions("touch", shapes, friction=2.0))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=1e-3, integrator=integrator)
    loss = -np.ptp(motion["energy"].values) / (0.7 * SPEED**2)
    assert motion.status.success
    assert loss == pytest.approx(((0.4 + np.cos(turn)) / 1.4) ** 2 - 1, rel=0.05)


def on_a_turntable(step: float) -> float:
    """Largest distance from the circle in half a turn of the ball [m]."""
    rate, place, velocity = 3.0, 0.3 + 0.0j, 0.1 + 0.4j
    system = da.System("turntable", gravity=(0, 0, -9.81))
    table = spatial.Cylinder("table", radius=1.0, length=0.02, mass=50.0, position=(0, 0, -0.01))
    frames = system.ground.frame((0, 0, -0.01)), system.add(table).frame()
    axle = system.add(spatial.Revolute("axle", *frames))
    system.add(spatial.RotationalDriver("motor", axle, rate * da.t))
    slip = (velocity - 1j * rate * place) / RADIUS
    start = {"position": (place.real, place.imag, RADIUS), "velocity": (0.1, 0.4, 0)}
    turning = (-slip.imag, slip.real, 0)
    ball = spatial.Sphere("ball", radius=RADIUS, mass=1.0, angular_velocity=turning, **start)
    shapes = [contact.Sphere(system.add(ball).center, RADIUS)]
    shapes.append(contact.HalfSpace(table.frame((0, 0, 0.01))))
    system.add(spatial.Collisions("touch", shapes, friction=0.8))
    motion = da.solve_nonsmooth(system.build(), 1.0, step=step)
    assert motion.status.success
    slow = 2j / 7 * rate
    circle = place + velocity / slow * (np.exp(slow * motion.time) - 1)
    return float(abs(motion["ball.x"].values + 1j * motion["ball.y"].values - circle).max())


@pytest.mark.thorough
def test_circles_on_a_turntable():
    """Of first order in the turn of the table in a step."""
    errors = on_a_turntable(10e-3), on_a_turntable(5e-3)
    assert errors[1] < 2.5e-3
    assert errors[1] < 0.6 * errors[0]
