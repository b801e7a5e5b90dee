"""Impacts among many shapes, located in time, beside closed forms and event-driven motions."""

import numpy as np
import pytest
from scipy.optimize import brentq

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import UnsupportedError

G = 9.81
contact = planar.contact


def bouncing_ball(**law) -> da.System:
    """A ball 1 m above a floor."""
    system = da.System("bounce", gravity=(0.0, -G))
    bounce = system.parameter("bounce", 0.7)
    ball = system.add(planar.Body("ball", mass=1.0, inertia=0.004, position=(0.0, 1.1), angle=0.0))
    shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("hits", shapes, **({"restitution": bounce} | law)))
    return system


def height(t: float, e: float) -> float:
    """Height after bounces of a ball that falls from 1 m."""
    begin, speed = np.sqrt(2 / G), e * np.sqrt(2 * G)
    while t > begin + 2 * speed / G:
        begin, speed = begin + 2 * speed / G, e * speed
    return 1 - G * t**2 / 2 if t < begin else speed * (t - begin) - G * (t - begin) ** 2 / 2


def test_bouncing_ball_until_it_rests():
    times = np.linspace(0.3, 2.3, 8)
    rest = np.sqrt(2 / G) * (1 + 2 * 0.7 / 0.3)  # sum of the geometric series
    motion = da.solve_dynamics(
        bouncing_ball().build(), rest + 0.1, outputs=[*times, rest + 0.1], step=0.02
    )
    assert motion.status.success
    expected = [0.1 + height(t, 0.7) for t in times] + [0.1]
    np.testing.assert_allclose(motion["ball.y"], expected, atol=1e-9)
    assert motion["hits_ball_ground.normal_force"][-1].item() == pytest.approx(G)
    motion = da.solve_dynamics(bouncing_ball().build(), 1.0, outputs=[1.0], step=0.02)
    gradient = da.sensitivity(motion, da.final("ball.y"), method="adjoint")
    slope = (height(1.0, 0.7 + 1e-5) - height(1.0, 0.7 - 1e-5)) / 2e-5
    assert gradient.sel(parameter="bounce").item() == pytest.approx(slope, rel=1e-6)


def test_designs_of_a_batch_bounce():
    heights = da.solve_dynamics(
        bouncing_ball().build(), 1.0, outputs=[1.0], step=0.02, parameters={"bounce": [0.5, 0.7]}
    )["ball.y"]
    np.testing.assert_allclose(heights.values.ravel(), [0.1 + height(1.0, e) for e in (0.5, 0.7)])


RADIUS, WIDTH, HEIGHT = 0.1, 1.2, 0.9


def billiards(x: np.ndarray, v: np.ndarray, e: float, duration: float) -> np.ndarray:
    """Positions after impacts of equal frictionless balls with each other and with four walls."""
    size, t = np.array([WIDTH, HEIGHT]), 0.0
    i, j = np.triu_indices(len(x), 1)
    while True:
        with np.errstate(all="ignore"):
            aim = np.where(
                v > 0, (size - RADIUS - x) / v, np.where(v < 0, (RADIUS - x) / v, np.inf)
            )
            r, u = x[j] - x[i], v[j] - v[i]
            b, uu = (r * u).sum(1), (u * u).sum(1)
            root = b**2 - uu * ((r * r).sum(1) - 4 * RADIUS**2)
            meet = np.where((b < 0) & (root > 0), (-b - np.sqrt(root)) / uu, np.inf)
        first = min(aim.min(), meet.min())
        if t + first >= duration:
            return x + (duration - t) * v
        x, t = x + first * v, t + first
        if aim.min() <= meet.min():
            ball, axis = np.unravel_index(np.argmin(aim), aim.shape)
            v[ball, axis] *= -e
        else:
            k = int(np.argmin(meet))
            normal = (x[j[k]] - x[i[k]]) / (2 * RADIUS)
            push = (1 + e) / 2 * normal * (normal @ (v[i[k]] - v[j[k]]))
            v[i[k]], v[j[k]] = v[i[k]] - push, v[j[k]] + push


@pytest.mark.few(1)
@pytest.mark.parametrize("e", [1.0, 0.8])
def test_billiards(e):
    rng, system = np.random.default_rng(4), da.System("table", gravity=(0.0, 0.0))
    x = np.array([(0.25 + 0.33 * k, 0.3 + 0.3 * m) for m in range(2) for k in range(3)])
    v = rng.normal(size=x.shape)
    shapes = []
    for k in range(len(x)):
        start = {"position": tuple(x[k]), "velocity": tuple(v[k])}
        ball = system.add(planar.Particle(f"ball{k}", mass=1.0, **start))
        shapes.append(contact.Circle(ball.center, RADIUS))
    for place, normal in (((0, 0), (1, 0)), ((0, 0), (0, 1)), ((WIDTH, HEIGHT), (-1, 0))):
        shapes.append(contact.HalfPlane(system.ground.point(*place), normal))
    shapes.append(contact.HalfPlane(system.ground.point(WIDTH, HEIGHT), (0, -1)))
    system.add(planar.Collisions("hits", shapes, restitution=e))
    motion = da.solve_dynamics(system.build(), 0.8, step=0.05)
    assert motion.status.success
    assert motion.statistics["impacts"] >= 15
    end = [[motion[f"ball{k}.{c}"][-1].item() for c in "xy"] for k in range(len(x))]
    np.testing.assert_allclose(end, billiards(x, v.copy(), e, 0.8), atol=1e-9)


def test_superball():
    """Impacts reverse the velocity at the contact (Garwin 1969)."""
    radius, speed, inertia = 0.1, np.array([1.0, 0.3]), 0.4 * 0.1**2
    system = da.System("superball", gravity=(0.0, 0.0, -G))
    start = {"position": (0.0, 0.0, 0.5), "velocity": (*speed, 0.0)}
    ball = spatial.Body("ball", mass=1.0, inertia=(inertia,) * 3, **start)
    floor = spatial.contact.HalfSpace(system.ground.frame())
    shapes = [spatial.contact.Sphere(system.add(ball).center, radius), floor]
    law = {"restitution": 1.0, "tangential": 1.0, "friction": 10.0}
    system.add(spatial.Collisions("hits", shapes, **law))
    begin = np.sqrt(2 * 0.4 / G)
    times = [begin + 0.1, 3 * begin + 0.1]
    motion = da.solve_dynamics(system.build(), times[-1], outputs=times, step=0.02)
    spin, at, after = np.zeros(2), speed, []
    for _ in range(2):  # slip v − r w, with w about the axis across v
        push = -2 * (at - radius * spin) / (1 + radius**2 / inertia)
        at, spin = at + push, spin - radius * push / inertia
        after.append(at)
    np.testing.assert_allclose(motion["ball.velocity"].values[:, :2], after, atol=1e-9)
    energy = motion["energy"].values
    assert np.ptp(energy) <= 1e-9 * energy[0]


def test_ball_in_a_rotating_box():
    """A frictionless ball without weight between four walls that turn at a constant rate."""
    rate, e, half, duration = 1.5, 0.9, 0.5, 2.0
    system = da.System("box", gravity=(0.0, 0.0))
    box = system.add(planar.Body("box", mass=1.0, inertia=1.0, position=(0, 0)))
    system.add(planar.Revolute("O", system.ground.center, box.center))
    system.add(planar.RotationalDriver("motor", system.ground, box, rate * da.t))
    start = {"position": (0.1, 0.05), "velocity": (0.9, 0.4)}
    ball = system.add(planar.Particle("ball", mass=1.0, **start))
    sides = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0)]
    walls = [contact.HalfPlane(box.point(half * a, half * b), (-a, -b)) for a, b in sides]
    system.add(planar.Collisions("hits", [contact.Circle(ball.center, 0.1), *walls], restitution=e))
    motion = da.solve_dynamics(system.build(), duration, step=0.02)
    assert motion.status.success

    def outward(t, side):
        c, s = np.cos(rate * t), np.sin(rate * t)
        return np.array([c * side[0] - s * side[1], s * side[0] + c * side[1]])

    def gap(s, side, t, x, v):
        return half - 0.1 - outward(s, side) @ (x + (s - t) * v)

    x, v, t, count = np.array(start["position"]), np.array(start["velocity"]), 0.0, 0
    while True:
        hits = []
        for side in sides:
            grid, state = np.linspace(t + 1e-7, duration, 2000), (side, t, x, v)
            values = np.array([gap(s, *state) for s in grid])
            down = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
            if down.size:
                around = grid[down[0] : down[0] + 2]
                hits.append((brentq(gap, *around, args=state, xtol=1e-15), side))
        if not hits:
            break
        instant, side = min(hits)
        x, t, count = x + (instant - t) * v, instant, count + 1
        normal = outward(t, side)
        wall = rate * np.array([-x[1], x[0]]) @ normal
        v = v - (1 + e) * (v @ normal - wall) * normal
    end = x + (duration - t) * v
    assert count == motion.statistics["impacts"] >= 3
    np.testing.assert_allclose([motion["ball.x"][-1], motion["ball.y"][-1]], end, atol=1e-9)


@pytest.mark.parametrize(
    ("law", "text"),
    [
        ({"rolling": 0.01}, "rolling"),
        ({"impact_law": "energetic"}, "energetic"),
        ({"friction": 0.2, "static_friction": 0.3}, "static_friction"),
        ({"restitution": 0.0, "law": contact.KelvinVoigt(stiffness=1e5)}, "force law"),
    ],
)
def test_laws_without_located_impacts_are_refused(law, text):
    with pytest.raises(UnsupportedError, match=f"hits: .*{text}.*solve_nonsmooth"):
        da.solve_dynamics(bouncing_ball(**law).build(), 1.0, step=0.02)


def test_pairs_without_contact_are_refused():
    system = da.System("rods")
    rods = [
        system.add(planar.Bar(f"rod{k}", length=1.0, mass=1.0, position=(0, k))) for k in (0, 1)
    ]
    shapes = [contact.Capsule(rod.start, rod.end, 0.1) for rod in rods]
    system.add(planar.Collisions("hits", shapes))
    with pytest.raises(UnsupportedError, match="hits: no contact of Capsule and Capsule"):
        da.solve_dynamics(system.build(), 1.0, step=0.02)


@pytest.mark.thorough
def test_many_pairs_are_refused():
    system = da.System("sand")
    balls = [planar.Particle(f"b{k}", mass=1.0, position=(k, 0)) for k in range(30)]
    shapes = [contact.Circle(system.add(ball).center, 0.1) for ball in balls]
    system.add(planar.Collisions("hits", shapes))
    with pytest.raises(UnsupportedError, match="hits: there are 435 gaps"):
        da.solve_dynamics(system.build(), 1.0, step=0.02)
