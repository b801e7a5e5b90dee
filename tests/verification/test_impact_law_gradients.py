"""Gradients of impacts by Poisson's and the energetic law of restitution.

Of a rod that hits a rough floor, by all parameters, against the derivative of its closed-form
course, in which friction slides, sticks or turns back in either phase; of a ball that bounces, by
the closed form of its height; and impacts in space, whose slip turns, against the differential
equations of Darboux (1880) and Keller (1986).
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.impact_path import impact_impulses
from tests.verification.test_impact_laws import CASES, Course

LENGTH, STEP = 1.0, 1e-4
SCHEMES = [da.MoreauJean(), da.AnticipatedImpacts()]
LAWS = pytest.mark.parametrize("law", ["poisson", "energetic"])


def rod(law: str, values: list[float]) -> da.Model:
    system = da.System("rod")
    names = ["e", "mu", "angle", "vx", "vy", "spin", "mass"]
    p = {name: system.parameter(name, v) for name, v in zip(names, values, strict=True)}
    body = planar.Body(
        "rod",
        mass=p["mass"],
        inertia=p["mass"] * LENGTH**2 / 12,
        position=(da.cos(p["angle"]) * LENGTH / 2, da.sin(p["angle"]) * LENGTH / 2),
        angle=p["angle"],
        velocity=(p["vx"], p["vy"]),
        angular_velocity=p["spin"],
    )
    tip = planar.contact.Vertex(system.add(body).point(-LENGTH / 2, 0))
    coefficients = {"restitution": p["e"], "friction": p["mu"], "impact_law": law}
    shapes = [tip, planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, **coefficients))
    return system.build()


def speeds_after(law: str, values: np.ndarray) -> np.ndarray:
    """Closed form of the speeds after the impact."""
    e, mu, angle, vx, vy, spin, mass = values
    arm = np.array([-np.cos(angle), np.sin(angle)]) * LENGTH / 2
    inverse = 12 / (mass * LENGTH**2)
    g = np.eye(2) / mass + np.outer(arm, arm) * inverse
    course = Course(g, np.array([vy, vx]) + arm * spin, mu)
    normal = course.end(law, e)
    push = np.array([normal, course.tangential(normal)])
    return np.array([vx + push[1] / mass, vy + push[0] / mass, spin + arm @ push * inverse])


@pytest.mark.few(1)
@LAWS
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", CASES)
def test_rough_impact_of_a_rod(name, scheme, law):
    """Slip that turns back has an end that moves with the parameters."""
    angle, (vx, vy), spin, mu = CASES[name]
    values = np.array([0.6, mu, angle, vx, vy, spin, 2.0])
    exact, d = [], 1e-6
    for change in d * np.eye(7):
        pair = (speeds_after(law, values + s * change) for s in (1, -1))
        exact.append(np.subtract(*pair) / (2 * d))
    motion = da.solve_nonsmooth(rod(law, list(values)), STEP, step=STEP, integrator=scheme)
    ends = [da.final(f"rod.{of}") for of in ("vx", "vy", "angular_velocity")]
    gradient = {m: da.sensitivity(motion, ends, method=m).values for m in ("direct", "adjoint")}
    np.testing.assert_allclose(gradient["direct"], np.array(exact).T, atol=1e-7)
    np.testing.assert_allclose(gradient["adjoint"], gradient["direct"], rtol=1e-9, atol=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_no_restitution_of_the_energetic_law_is_noted(scheme):
    """The speed after is ``e |u⁻|``; of Poisson's law, the derivative at ``e = 0`` is known."""
    values = [0.0, 0.1, np.pi / 2, 0.0, -1.0, 0.0, 2.0]
    slopes, notes = {}, {}
    for law, e in (("poisson", 0.0), ("energetic", 0.0), ("energetic", 1e-6)):
        model = rod(law, [e, *values[1:]])
        motion = da.solve_nonsmooth(model, STEP, step=STEP, integrator=scheme)
        result = da.sensitivity(motion, da.final("rod.vy"), "e")
        slopes[law, e], notes[law, e] = result.item(), " ".join(result.attrs["notes"])
    assert slopes["poisson", 0.0] == pytest.approx(1.0, abs=1e-6)
    assert slopes["energetic", 1e-6] == pytest.approx(1.0, abs=1e-4)
    assert "its derivative by the restitution is missing" in notes["energetic", 0.0]
    assert "missing" not in notes["energetic", 1e-6] + notes["poisson", 0.0]


@functools.cache
def bouncing(law: str) -> da.Model:
    system = da.System("ball", gravity=(0.0, -10.0))
    height, e = system.parameter("height", 0.8, "m"), system.parameter("e", 0.7)
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0.0, height)))
    shapes = [planar.contact.Vertex(ball.center), planar.contact.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("floor", shapes, restitution=e, impact_law=law))
    return system.build()


def bounced(law: str, step: float, scheme, end: float) -> da.Motion:
    motion = da.solve_nonsmooth(bouncing(law), end, step=step, integrator=scheme)
    assert motion.status.success
    return motion


def flight(t: float, height: float, e: float) -> np.ndarray:
    """Height and speed of a ball that falls from ``height`` and rebounds to ``e^(2n) height``."""
    g, start, speed = 10.0, np.sqrt(2 * height / 10.0), np.sqrt(2 * height * 10.0)
    while True:
        speed *= e
        if t <= start + 2 * speed / g:
            s = t - start
            return np.array([speed * s - g * s**2 / 2, speed - g * s])
        start += 2 * speed / g


@pytest.mark.thorough
@LAWS
@pytest.mark.parametrize("scheme", SCHEMES)
def test_ball_after_three_bounces(scheme, law):
    """Of first order in the step, as of Newton's law; the second bounce is at 0.96 s."""
    end, values, d = 1.8, np.array([0.8, 0.7]), 1e-6
    exact = np.array(
        [(flight(end, *(values + s)) - flight(end, *(values - s))) / (2 * d) for s in d * np.eye(2)]
    ).T
    ends, errors = [da.final("ball.y"), da.final("ball.vy")], []
    for step in (4e-3, 1e-3):
        motion = bounced(law, step, scheme, end)
        direct = da.sensitivity(motion, ends, method="direct").values
        if not errors:
            adjoint = da.sensitivity(motion, ends, method="adjoint").values
            np.testing.assert_allclose(adjoint, direct, rtol=1e-9)
        errors.append(np.abs(direct - exact).max() / np.abs(exact).max())
    assert errors[1] < 0.01 and errors[1] < 0.5 * errors[0]


def keller(h: np.ndarray, velocity: np.ndarray, mu: float, e: float) -> np.ndarray | None:
    """Impulses of one contact by Poisson's law; None if its slip ends."""

    def rates(_, x):
        push = np.array([1.0, *(-mu * x[1:3] / np.linalg.norm(x[1:3]))])
        return np.concatenate([h @ push, push])

    def compressed(_, x):
        return x[0]

    def stops(_, x):
        return np.linalg.norm(x[1:3]) - 1e-2

    compressed.terminal = stops.terminal = True
    options = {"rtol": 1e-10, "atol": 1e-12}
    first = solve_ivp(rates, [0, 100], [*velocity, 0, 0, 0], events=[compressed, stops], **options)
    if first.t_events[1].size:
        return None
    normal = e * first.t[-1]
    second = solve_ivp(rates, [0, normal], first.y[:, -1], events=[stops], **options)
    return None if second.t_events[0].size else second.y[3:, -1]


@pytest.mark.thorough
def test_slip_that_turns_in_space():
    """Second order in the changes of direction, of which increments have 0.1 rad at most."""
    rng, errors = np.random.default_rng(1), []
    for _ in range(60):
        root = rng.normal(size=(3, 3))
        matrix, mu, e = root @ root.T + 0.5 * np.eye(3), rng.uniform(0.1, 0.6), 0.5
        velocity = np.array([-1.0, *rng.normal(size=2)])
        if (exact := keller(matrix, velocity, mu, e)) is None:
            continue
        coefficients = np.array([[e], [0.0], [1.0], [mu], [mu]])  # 1: the number of Poisson's law
        laws = ContactLaws.of(coefficients, (2,))
        problem = FrictionProblem(matrix, velocity[None], laws.friction, (2,))
        impulses = impact_impulses(problem, laws, da.ContactSolver())[0].impulses[0]
        errors.append(np.abs(impulses - exact).max() / np.abs(exact).max())
    assert len(errors) > 40
    assert max(errors) < 2e-3 and np.median(errors) < 3e-4


@pytest.mark.few(2)
@LAWS
@pytest.mark.parametrize("scheme", SCHEMES)
def test_friction_of_an_impact_from_which_a_force_lifts_the_body(scheme, law):
    """The contact presses in the impact at the start of the step only, ``v_x = 1 − μ (1 + e)``."""
    system = da.System("lifted", gravity=(0, 0))
    mu, e = system.parameter("mu", 0.2), system.parameter("e", 0.5)
    body = system.add(planar.Particle("body", mass=1.0, position=(0, 0), velocity=(1, -1)))
    system.add(planar.Force("lift", body.center, (0, 100)))
    shapes = [planar.contact.Vertex(body.center), planar.contact.HalfPlane(system.ground)]
    coefficients = {"restitution": e, "friction": mu, "impact_law": law}
    system.add(planar.Collisions("floor", shapes, **coefficients))
    motion = da.solve_nonsmooth(system.build(), 1e-3, step=1e-3, integrator=scheme)
    assert motion.values("body.vx")[-1] == pytest.approx(0.7)
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(motion, da.final("body.vx"), ["mu", "e"], method=method)
        np.testing.assert_allclose(gradient.values.ravel(), [-1.5, -0.2], atol=1e-9)
