"""Laws of restitution in time steps: an oblique impact of a rod with a rough plane.

Along an impact the normal impulse ``p`` grows, and velocities of the tip are ``u_N' = a − σ μ b``,
``u_T' = b − σ μ c`` while it slips in the direction ``σ``, with the inverse inertia ``[[a, b], [b,
c]]`` of the tip; where slip ends it sticks, ``u_N' = a − b²/c``, if ``|b| ≤ μ c``, or turns back
(Brach, Mechanical Impact Dynamics, 1991; Stronge, Impact Mechanics, 2000, ch. 3). Poisson's law
ends it at ``(1 + e) p_c``, the energetic law when the work is ``(1 − e²) W_c``.
"""

from __future__ import annotations

import functools
from itertools import pairwise

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import ModelError
from dalembert.io import load

LENGTH, MASS, STEP = 1.0, 2.0, 1e-4


def rod(angle: float, speed, spin: float, mu: float, e: float, law: str) -> da.Model:
    """Its lower end touches the floor."""
    half = np.array([np.cos(angle), np.sin(angle)]) * LENGTH / 2
    system = da.System("rod")
    restitution = system.parameter("restitution", e)
    body = planar.Body(
        "rod",
        mass=MASS,
        inertia=MASS * LENGTH**2 / 12,
        position=tuple(half),
        angle=angle,
        velocity=speed,
        angular_velocity=spin,
    )
    tip = planar.contact.Vertex(system.add(body).point(-LENGTH / 2, 0))
    shapes = [tip, planar.contact.HalfPlane(system.ground)]
    coefficients = {"restitution": restitution, "friction": mu}
    system.add(planar.Collisions("floor", shapes, impact_law=law, **coefficients))
    return system.build()


def tip_of(angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Arm of ``(u_N, u_T)`` by the spin, and the inverse inertia."""
    arm = np.array([-np.cos(angle), np.sin(angle)]) * LENGTH / 2
    return arm, np.eye(2) / MASS + np.outer(arm, arm) * 12 / (MASS * LENGTH**2)


class Course:
    """Impulses of an impact as functions of the normal one, piece by piece."""

    def __init__(self, g: np.ndarray, u: np.ndarray, mu: float):
        a, b, c = g[0, 0], g[0, 1], g[1, 1]
        sense = np.sign(u[1])
        self.rates, self.ends = [(a - sense * mu * b, -sense * mu)], [0.0]
        along = b - sense * mu * c
        if sense * along < 0:
            self.ends.append(-u[1] / along)
            back = np.sign(b)
            after = (a - b**2 / c, -b / c) if abs(b) <= mu * c else (a - back * mu * b, -back * mu)
            self.rates.append(after)
        self.ends.append(np.inf)
        self.speeds = [u[0]]  # at the ends of the pieces
        for (rate, _), (start, end) in zip(self.rates, pairwise(self.ends), strict=True):
            self.speeds.append(self.speeds[-1] + rate * (end - start))

    def piece(self, p: float) -> int:
        return int(np.searchsorted(self.ends[1:-1], p))

    def speed(self, p: float) -> float:
        k = self.piece(p)
        return self.speeds[k] + self.rates[k][0] * (p - self.ends[k])

    def tangential(self, p: float) -> float:
        parts = zip(self.rates, pairwise(self.ends), strict=True)
        return sum(rate * max(0.0, min(p, end) - start) for (_, rate), (start, end) in parts)

    def work(self, p: float) -> float:
        corners = [0.0, *(end for end in self.ends[1:-1] if end < p), p]
        return sum((self.speed(r) + self.speed(s)) / 2 * (s - r) for r, s in pairwise(corners))

    def solve(self, value, lower: float) -> float:
        """Smallest ``p`` above a limit with a value of zero, by bisection."""
        upper = lower + 1e-3
        while value(upper) < 0:
            upper *= 1.5
        for _ in range(200):
            middle = (lower + upper) / 2
            lower, upper = (middle, upper) if value(middle) < 0 else (lower, middle)
        return upper

    def end(self, law: str, e: float) -> float:
        compressed = self.solve(self.speed, 0.0)
        if law == "poisson":
            return (1 + e) * compressed
        if law == "newton":
            return self.solve(lambda p: self.speed(p) + e * self.speeds[0], compressed)
        lost = self.work(compressed)
        return self.solve(lambda p: self.work(p) - (1 - e**2) * lost, compressed)


CASES = {
    "slides": (1.0, (3.0, -1.0), 0.4, 0.1),
    "sticks in compression": (1.2, (0.3, -1.0), 0.4, 0.9),
    "sticks in restitution": (1.3, (1.5, -1.0), 0.4, 0.3),
    "turns back in compression": (0.9, (0.3, -1.0), 0.0, 0.2),
    "turns back in restitution": (0.9, (1.0, -1.0), 0.0, 0.2),
}


def impact(
    name: str, law: str, e: float, scheme=None, step: float = STEP
) -> tuple[da.Motion, np.ndarray]:
    """Motion of a step, and impulses."""
    angle, speed, spin, mu = CASES[name]
    model = rod(angle, speed, spin, mu, e, law)
    scheme = scheme or da.MoreauJean()
    motion = da.solve_nonsmooth(model, step, step=step, integrator=scheme)
    assert motion.status.success
    jumps = [motion[f"rod.v{axis}"].values for axis in "yx"]
    return motion, MASS * np.array([v[-1] - v[0] for v in jumps])


@pytest.mark.few(6)
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("law", ["poisson", "energetic"])
@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
def test_oblique_impact_of_a_rod(name, law, e):
    angle, speed, spin, mu = CASES[name]
    arm, g = tip_of(angle)
    course = Course(g, np.array([speed[1], speed[0]]) + arm * spin, mu)
    normal = course.end(law, e)
    motion, impulses = impact(name, law, e)
    assert impulses == pytest.approx([normal, course.tangential(normal)], rel=1e-7, abs=1e-7)
    if law == "energetic":
        energy = motion.values("kinetic_energy")
        assert energy[-1] <= energy[0] * (1 + 1e-12)


@pytest.mark.few(2)
@pytest.mark.parametrize("step", [1e-2, 1e-4])
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("law", ["poisson", "energetic"])
def test_oblique_impact_in_anticipated_steps(name, law, step):
    """Impacts precede the forces of a step, so that its length does not matter."""
    angle, speed, spin, mu = CASES[name]
    arm, g = tip_of(angle)
    course = Course(g, np.array([speed[1], speed[0]]) + arm * spin, mu)
    for e in (0.6, 1.0):
        normal = course.end(law, e)
        impulses = impact(name, law, e, da.AnticipatedImpacts(), step)[1]
        assert impulses == pytest.approx([normal, course.tangential(normal)], rel=1e-7, abs=1e-7)


def test_the_laws_differ_where_slip_ends_and_agree_where_it_does_not():
    laws = ["newton", "poisson", "energetic"]
    for name in CASES:
        normal = np.array([impact(name, law, 0.6)[1][0] for law in laws])
        if name == "slides":
            assert normal == pytest.approx(normal[0], rel=1e-9)
        else:
            assert min(abs(np.diff([*normal, normal[0]]))) > 1e-3 * normal[0]


@pytest.mark.thorough
def test_energy_of_random_impacts_is_never_gained():
    """Of impacts with friction by the energetic law; Newton's law gains energy in some."""
    rng, gained = np.random.default_rng(8), {"newton": [], "energetic": []}
    for _ in range(15):
        angle, speed = rng.uniform(0.4, 2.7), (rng.uniform(-2, 2), rng.uniform(-1.5, -0.5))
        mu, e = rng.uniform(0.05, 1.0), rng.uniform(0.3, 1.0)
        for law, gains in gained.items():
            model = rod(angle, speed, 0.0, mu, e, law)
            motion = da.solve_nonsmooth(model, STEP, step=STEP, integrator=da.MoreauJean())
            energy = motion.values("kinetic_energy")
            gains.append(energy[-1] / energy[0] - 1)
    assert max(gained["energetic"]) <= 1e-10
    assert max(gained["newton"]) > 1e-3


SCHEMES = [da.MoreauJean(), da.AnticipatedImpacts()]


@functools.cache
def bouncing(law: str, gravity: float, scheme) -> da.Motion:
    """A row of two balls, which bounces on the floor."""
    system = da.System("balls", gravity=(0, -gravity))
    shapes = [planar.contact.HalfPlane(system.ground)]
    for k in range(2):
        ball = planar.Body(f"b{k}", mass=1.0 + k, inertia=0.01, position=(0.0, 0.3 + 0.5 * k))
        ball.velocity = (0.0, -1.0)
        shapes.append(planar.contact.Circle(system.add(ball), 0.1))
    law = {"restitution": 0.7, "friction": 0.3, "impact_law": law}
    system.add(planar.Collisions("hits", shapes, **law))
    return da.solve_nonsmooth(system.build(), 0.6, step=2e-3, integrator=scheme)


@pytest.mark.few(1)
@pytest.mark.parametrize("law", ["poisson", "energetic"])
def test_central_impacts_are_those_of_newtons_law(law):
    expected, motion = (bouncing(name, 9.81, da.MoreauJean()) for name in ("newton", law))
    assert motion.status.success
    np.testing.assert_allclose(motion.trajectory.y, expected.trajectory.y, atol=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("law", ["poisson", "energetic"])
def test_anticipated_central_impacts(law):
    """They come in other steps than those of Newton's law, and leave with the same speeds."""
    expected, motion = (bouncing(name, 9.81, da.AnticipatedImpacts()) for name in ("newton", law))
    assert motion.status.success
    np.testing.assert_allclose(motion.trajectory.y, expected.trajectory.y, atol=2e-2)
    energy = motion.values("energy")
    assert (np.diff(energy) < 1e-9).all()


def elastic(law: str) -> da.Motion:
    """A ball that bounces without loss."""
    system = da.System("ball", gravity=(0, -9.81))
    ball = system.add(planar.Body("ball", mass=1.0, inertia=0.01, position=(0.0, 0.5)))
    shapes = [planar.contact.HalfPlane(system.ground), planar.contact.Circle(ball, 0.1)]
    system.add(planar.Collisions("hits", shapes, restitution=1.0, impact_law=law))
    return da.solve_nonsmooth(system.build(), 2.0, step=2e-3)


@pytest.mark.thorough
@pytest.mark.parametrize("law", ["poisson", "energetic"])
def test_elastic_ball_conserves_its_energy(law):
    energy = elastic(law).values("energy")
    assert energy == pytest.approx(energy[0], rel=1e-9)


@pytest.mark.parametrize("spin", [5.0, 60.0])
@pytest.mark.parametrize("law", ["poisson", "energetic"])
def test_elastic_rod_that_turns_conserves_its_energy(law, spin):
    """Its impact comes before the step in which the gap would close, with other directions."""
    system = da.System("rod")
    start = {"position": (0.0, 0.4), "velocity": (0.0, -2.0), "angle": 0.5}
    rod = planar.Body("rod", mass=1.0, inertia=4e-3, angular_velocity=spin, **start)
    ends = system.add(rod).point(-0.1, 0.0), rod.point(0.1, 0.0)
    shapes = [planar.contact.Capsule(*ends, 0.02), planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("hits", shapes, restitution=1.0, impact_law=law))
    model = system.build()
    for step in (1e-3, 5e-4):
        motion = da.solve_nonsmooth(model, 0.2, step=step)
        assert motion.impulse("hits").max() > 0.5
        assert motion["energy"].values == pytest.approx(motion["energy"].values[0], rel=1e-12)


@pytest.mark.parametrize("law", ["poisson", "energetic"])
def test_contacts_that_press_later_take_part_in_the_impacts(law):
    """A corner that turns towards a face closes its gap after the forces of the step."""
    system, shapes = da.System("tetrahedra"), []
    corners = [(0.1, 0, -0.05), (-0.06, 0.09, -0.05), (-0.06, -0.09, -0.05), (0, 0, 0.12)]
    starts = [
        ((-0.083, -0.135, -0.122), (-1.455, -0.247, 2.064), (-3.388, -1.151, -1.311)),
        ((0.102, 0.12, 0.064), (0.572, -1.033, 0.36), (2.845, 2.853, 1.258)),
    ]
    for k, (place, turn, spin) in enumerate(starts):
        rotation = da.rotation.axis_angle(turn, float(np.linalg.norm(turn)))
        start = {"position": place, "rotation": rotation, "angular_velocity": spin}
        start["velocity"] = tuple((1 - 2 * k) * np.array([0.417, 0.673, 0.611]))
        inertia = ((2e-3, 3e-3, 4e-3), (5e-3, 4e-3, 3e-3))[k]
        body = spatial.Body(f"b{k}", mass=1.0 - 0.3 * k, inertia=inertia, **start)
        shapes.append(spatial.contact.Polyhedron(system.add(body), corners))
    system.add(spatial.Collisions("hits", shapes, restitution=0.0, friction=0.3, impact_law=law))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=1e-3)
    momentum = sum(m * motion[f"b{k}.velocity"].values for k, m in enumerate((1.0, 0.7)))
    assert motion.status.success and motion.impulse("hits").sum() > 1e-3
    np.testing.assert_allclose(momentum - momentum[0], 0.0, atol=1e-9)
    assert np.diff(motion["energy"].values).max() < 1e-6


@pytest.mark.few(2)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("law", ["poisson", "energetic"])
def test_a_ball_on_a_floor_in_space(law, scheme):
    """Oblique, with spin: friction ends or reduces slip, along one direction."""
    system = da.System("ball")
    inertia, e, mu, r = 0.4 * 0.1**2, 0.8, 0.2, 0.1
    start = {"velocity": (1.2, 0.9, -2.0), "angular_velocity": (0.0, 0.0, 5.0)}
    body = spatial.Body("ball", mass=1.0, inertia=(inertia,) * 3, position=(0, 0, r), **start)
    shapes = [spatial.contact.Sphere(system.add(body), r), spatial.contact.HalfSpace(system.ground)]
    coefficients = {"restitution": e, "friction": mu}
    system.add(spatial.Collisions("floor", shapes, impact_law=law, **coefficients))
    motion = da.solve_nonsmooth(system.build(), STEP, step=STEP, integrator=scheme)
    after = np.array([motion[f"ball.v{axis}"][-1].item() for axis in "xyz"])
    change = min(mu * (1 + e) * 2.0, 1.5 / 3.5)
    assert after == pytest.approx([*(np.array([1.2, 0.9]) * (1 - change / 1.5)), e * 2.0], abs=1e-8)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_poisson_of_formulas(scheme):
    """``poisson=True`` of other elements."""
    system = da.System("ball")
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.0), velocity=(0.5, -1)))
    law = {"restitution": 0.5, "friction": 0.1, "poisson": True}
    system.add(planar.UnilateralConstraint("floor", ball.y, ball.vx, **law))
    model = system.build()
    motion = da.solve_nonsmooth(model, STEP, step=STEP, integrator=scheme)
    assert motion["ball.vy"][-1] == pytest.approx(0.5)
    assert motion["ball.vx"][-1] == pytest.approx(0.5 - 0.15)


def test_what_is_not_available():
    with pytest.raises(ModelError, match=r"floor\.impact_law: unknown law 'poison' \(did you"):
        rod(1.0, (0, -1), 0.0, 0.1, 0.5, "poison")
    body = planar.Body("b", mass=1.0, inertia=1.0)
    with pytest.raises(ModelError, match=r"floor\.tangential: the poisson law of impact has no"):
        planar.Collisions(
            "floor", [planar.contact.Circle(body, 0.1)], impact_law="poisson", tangential=0.5
        )


def rods(laws: dict[str, str], together: bool) -> da.Model:
    """Rods that do not touch each other, in one element with pairs or in one element each."""
    system = da.System("rods")
    system.parameter("idle", 1.0)
    floor, groups, pairs = planar.contact.HalfPlane(system.ground), {}, []
    coefficients = {"restitution": 0.6, "friction": 0.9}
    angle, speed, spin, _ = CASES["sticks in compression"]
    half = np.array([np.cos(angle), np.sin(angle)]) * LENGTH / 2
    for k, (name, law) in enumerate(laws.items()):
        start = {"position": (half[0] + 3 * k, half[1]), "angle": angle, "velocity": speed}
        inertia = MASS * LENGTH**2 / 12
        body = planar.Body(name, mass=MASS, inertia=inertia, angular_velocity=spin, **start)
        groups[name] = [planar.contact.Vertex(system.add(body).point(-LENGTH / 2, 0))]
        pairs.append(planar.contact.Pair((name, "floor"), impact_law=law))
        if not together:
            own = {"impact_law": law, **coefficients}
            system.add(planar.Collisions(f"{name}_floor", [*groups[name], floor], **own))
    if together:
        shapes = {**groups, "floor": [floor]}
        system.add(planar.Collisions("all", shapes, pairs=pairs, **coefficients))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("together", [True, False], ids=["pairs", "elements"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_each_pair_or_element_has_its_law(together, scheme):
    laws = {"first": "newton", "second": "poisson", "third": "energetic"}
    motion = da.solve_nonsmooth(rods(laws, together), STEP, step=STEP, integrator=scheme)
    for name, law in laws.items():
        jumps = [motion[f"{name}.v{axis}"].values for axis in "yx"]
        impulses = MASS * np.array([v[-1] - v[0] for v in jumps])
        alone = impact("sticks in compression", law, 0.6, scheme)[1]
        assert impulses == pytest.approx(alone, rel=1e-9)


def bar_on_two_laws(laws: tuple[str, str], scheme) -> tuple[np.ndarray, np.ndarray]:
    """Speeds of a level bar whose ends hit two floors, and its energy."""
    system = da.System("bar")
    bar = planar.Body("bar", mass=1.0, inertia=0.05, velocity=(0.0, -1.0), angular_velocity=0.3)
    ends = {f"end{k}": [system.add(bar).point(x, 0)] for k, x in enumerate((-0.5, 0.5)) if k == 0}
    ends["end1"] = [bar.point(0.5, 0)]
    floor = [planar.contact.HalfPlane(system.ground)]
    pairs = [planar.contact.Pair((f"end{k}", "floor"), impact_law=laws[k]) for k in range(2)]
    shapes = {**ends, "floor": floor}
    system.add(planar.Collisions("hits", shapes, restitution=0.5, pairs=pairs))
    motion = da.solve_nonsmooth(system.build(), STEP, step=STEP, integrator=scheme)
    assert motion.status.success
    speeds = np.array([motion[f"bar.{name}"][-1].item() for name in ("vy", "angular_velocity")])
    return speeds, motion.values("kinetic_energy")


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("laws", [("newton", "poisson"), ("poisson", "energetic")])
def test_laws_in_one_impact(laws, scheme):
    """Contacts of Newton's law reach their speeds, and energy is not gained."""
    (vy, spin), energy = bar_on_two_laws(laws, scheme)
    assert energy[-1] < energy[0]
    left, right = vy - 0.5 * spin, vy + 0.5 * spin
    assert right > 0
    if laws[0] == "newton":
        assert left == pytest.approx(0.5 * 1.15, rel=1e-9)


def test_laws_of_pairs_in_files(tmp_path):
    text = """
format = 1
name = "two balls"
[bodies.low]
mass = 1
inertia = 0.005
position = [0, 0.1]
velocity = [0, -1]
[forces.hits]
type = "Collisions"
restitution = 0.5
pairs = [{ groups = ["balls", "floor"], impact_law = "LAW" }]
[forces.hits.shapes]
balls = [{ type = "Circle", point = "low", radius = 0.1 }]
floor = [{ type = "HalfPlane", point = "ground" }]
"""
    path = tmp_path / "balls.toml"
    path.write_text(text.replace("LAW", "energetic"))
    motion = da.solve_nonsmooth(load(path).build(), STEP, step=STEP)
    assert motion["low.vy"][-1].item() == pytest.approx(0.5)
    path.write_text(text.replace("LAW", "energetics"))
    with pytest.raises(ModelError, match=r"hits\.pairs\[0\]\.impact_law: unknown law 'energetics'"):
        load(path)
