"""A ball in a groove, a wedge between two blocks, and a disc in a rotating drum.

A ball that rolls in a groove with the half angle β touches its sides at the distance ``r sin β``
from its axis of rotation, so that ``a = g sin α/(1 + 2/(5 sin² β))`` on a slope α; it slips where
friction at both sides is less than ``m (g sin α − a)/2``. The wedge and the blocks follow from
Newton's law along their faces. The disc slips until it has the speed of the drum; both pieces are
integrated by SciPy.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial

G = 9.81
SCHEMES = pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])


def run(system: da.System, duration: float, step: float, scheme) -> da.Motion:
    motion = da.solve_nonsmooth(system.build(), duration, step=step, integrator=scheme)
    assert motion.status.success
    return motion


@pytest.mark.few(2)
@SCHEMES
@pytest.mark.parametrize(("half", "friction"), [(0.8, 0.8), (0.4, 0.8), (0.5, 0.05)])
def test_ball_in_a_groove(half, friction, scheme):
    slope, radius, mass, duration = 0.3, 0.1, 1.3, 0.5
    system = da.System("groove", gravity=(G * np.sin(slope), 0, -G * np.cos(slope)))
    start = (0, 0, radius / np.sin(half))
    ball = system.add(spatial.Sphere("ball", mass=mass, radius=radius, position=start))
    shapes = [spatial.contact.Sphere(ball.center, radius)]
    for side in (1, -1):
        normal = (0, side * np.cos(half), np.sin(half))
        shapes.append(spatial.contact.HalfSpace(system.ground.frame((0, 0, 0), axis=normal)))
    system.add(spatial.Collisions("sides", shapes, friction=friction))
    motion = run(system, duration, 2e-3, scheme)
    rolling = G * np.sin(slope) / (1 + 0.4 / np.sin(half) ** 2)
    sliding = G * np.sin(slope) - friction * G * np.cos(slope) / np.sin(half)
    acceleration = max(rolling, sliding)
    assert (sliding > rolling) == (friction < 0.1)
    assert motion["ball.vx"][-1].item() == pytest.approx(acceleration * duration, abs=1e-9)
    assert motion["ball.x"][-1].item() == pytest.approx(acceleration * duration**2 / 2, abs=1e-9)


@pytest.mark.few(2)
@SCHEMES
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_wedge_between_two_blocks(friction, scheme):
    half, mass, block, duration = 0.4, 2.0, 1.0, 0.15
    system, contact = da.System("wedge", gravity=(0, -G)), planar.contact
    wedge = system.add(planar.Body("wedge", mass=mass, inertia=0.1, position=(0, 1.0)))
    half_width = 0.4 * np.tan(half)
    outline = [(0, -0.4), (half_width, 0), (-half_width, 0)]
    shapes = {"wedge": [contact.Polygon(wedge, outline)], "blocks": []}
    shapes["floor"] = [contact.HalfPlane(system.ground)]
    for name, side in (("right", 1), ("left", -1)):
        place = (side * (0.2 * np.tan(half) + 0.5), 0.4)
        body = system.add(planar.Body(name, mass=block, inertia=10.0, position=place))
        shapes["blocks"].append(contact.Rectangle(body, (1.0, 0.8)))
    pairs = [contact.Pair(("wedge", "blocks"), friction=friction)]
    system.add(planar.Collisions("faces", shapes, pairs=pairs))
    motion = run(system, duration, 1e-3, scheme)
    across = np.cos(half) - friction * np.sin(half)
    along = np.sin(half) + friction * np.cos(half)
    speed = duration * mass * G / (mass + 2 * block * np.tan(half) * along / across)
    assert motion["wedge.vy"][-1].item() == pytest.approx(-speed, rel=1e-9)
    assert motion["right.vx"][-1].item() == pytest.approx(speed * np.tan(half), rel=1e-9)
    assert motion["left.vx"][-1].item() == pytest.approx(-speed * np.tan(half), rel=1e-9)


def in_a_drum(arm: float, radius: float, friction: float, surface: float, duration: float):
    """Angle of the disc from the bottom, its rate and its spin, of a disc of mass 1."""
    inertia = radius**2 / 2

    def rates(y: np.ndarray, force: float) -> list[float]:
        return [y[1], (force - G * np.sin(y[0])) / arm, force * radius / inertia]

    def sliding(t: float, y: np.ndarray) -> list[float]:
        return rates(y, friction * (G * np.cos(y[0]) + arm * y[1] ** 2))

    def rolling(t: float, y: np.ndarray) -> list[float]:
        return rates(y, G * np.sin(y[0]) / (1 + radius**2 / inertia))

    def slip(t: float, y: np.ndarray) -> float:
        return arm * y[1] + radius * y[2] - surface

    slip.terminal = True
    fine = {"rtol": 1e-10, "atol": 1e-12}
    first = solve_ivp(sliding, (0, duration), [0.0, 0.0, 0.0], events=slip, **fine)
    second = solve_ivp(rolling, (first.t[-1], duration), first.y[:, -1], **fine)
    angle, rate, _ = second.y
    force = G * np.abs(np.sin(angle)) / (1 + radius**2 / inertia)
    assert first.t[-1] < duration / 2
    assert np.all(force < friction * (G * np.cos(angle) + arm * rate**2))
    return second.y[:, -1]


@pytest.mark.parametrize(
    ("scheme", "error"),
    [
        (da.AnticipatedImpacts(), 1e-4),
        pytest.param(da.MoreauJean(), 2e-3, marks=pytest.mark.thorough),
    ],
)
def test_disc_in_a_rotating_drum(scheme, error):
    outer, radius, friction, rate, duration = 1.0, 0.2, 0.3, 2.0, 0.5
    system, contact = da.System("drum", gravity=(0, -G)), planar.contact
    drum = system.add(planar.Body("drum", mass=10.0, inertia=5.0))
    axle = system.add(planar.Revolute("axle", system.ground.center, drum.center))
    system.add(planar.RotationalDriver("motor", axle, rate * da.t))
    start = {"mass": 1.0, "inertia": radius**2 / 2, "position": (0, radius - outer)}
    disc = system.add(planar.Body("disc", **start))
    shapes = [contact.Bore(drum.center, outer), contact.Circle(disc.center, radius)]
    system.add(planar.Collisions("inside", shapes, friction=friction))
    motion = run(system, duration, 4e-3, scheme)
    angle, _, spin = in_a_drum(outer - radius, radius, friction, rate * outer, duration)
    place = (outer - radius) * np.sin(angle)
    assert motion["disc.x"][-1].item() == pytest.approx(place, abs=error)
    assert motion["disc.angular_velocity"][-1].item() == pytest.approx(spin, rel=error)
