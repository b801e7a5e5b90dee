"""A row of rough dominoes on hinges, beside the equations of the row and their impacts.

Each domino turns about its front edge. A tipped domino slides down the back of the next one with
Coulomb friction, and the impact of the front one is inelastic in all contacts (as in J. M. J. van
Leeuwen, The domino effect, Am. J. Phys. 78, 2010, who has these equations without friction). SciPy
integrates from impact to impact; each contact has

    g = p cos φ' − d − h sin(φ − φ'),    s = −p sin φ' + h cos(φ − φ').
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

contact = planar.contact
HEIGHT, THICK, MASS, G = 0.048, 0.0075, 0.01, 9.81
INERTIA = MASS * (HEIGHT**2 + THICK**2) / 12
EDGE = INERTIA + MASS * (HEIGHT**2 + THICK**2) / 4
COUNT, SPACING, DURATION = 3, 0.6 * HEIGHT, 0.15
PITCH = SPACING + THICK


def contacts(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of the distances and of the slips by the tilts."""
    normal, slip = np.zeros((2, q.size - 1, q.size))
    for k, (own, after) in enumerate(pairwise(q)):
        c, s = HEIGHT * np.cos(own - after), HEIGHT * np.sin(own - after)
        normal[k, k : k + 2] = -c, c - PITCH * np.sin(after)
        slip[k, k : k + 2] = -s, s - PITCH * np.cos(after)
    return normal, slip


def acceleration(q: np.ndarray, v: np.ndarray, friction: float) -> np.ndarray:
    weight = MASS * G / 2 * (HEIGHT * np.sin(q) - THICK * np.cos(q))
    if q.size == 1:
        return weight / EDGE
    normal, slip = contacts(q)
    turning = (contacts(q + 1e-7 * v)[0] - contacts(q - 1e-7 * v)[0]) @ v / 2e-7
    push = normal - friction * np.sign(slip @ v)[:, None] * slip
    force = np.linalg.solve(normal @ push.T / EDGE, -turning - normal @ weight / EDGE)
    return (weight + push.T @ force) / EDGE


def row(start: float, friction: float, duration: float = DURATION) -> np.ndarray:
    """Tilts of all dominoes at the end."""
    q, v, t = np.zeros(1), np.array([start]), 0.0
    while t < duration:

        def rate(t, state):
            half = state.size // 2
            own = acceleration(state[:half], state[half:], friction)
            return np.concatenate([state[half:], own])

        def hits(t, state):
            return state[state.size // 2 - 1] - np.arcsin(SPACING / HEIGHT)

        hits.terminal = q.size < COUNT
        span, state = (t, duration), np.concatenate([q, v])
        solution = solve_ivp(rate, span, state, "DOP853", rtol=1e-9, atol=1e-11, events=hits)
        t, (q, v) = solution.t[-1], solution.y[:, -1].reshape(2, -1)
        if t < duration:
            q, v = np.append(q, 0.0), np.append(v, 0.0)
            normal, slip = contacts(q)
            push = normal - friction * np.sign(slip @ v)[:, None] * slip
            v = v + push.T @ np.linalg.solve(normal @ push.T, -normal @ v)
    return q


def hinged(count: int = COUNT) -> da.Model:
    system, groups = da.System("dominoes", gravity=(0.0, -G)), {"blocks": [], "feet": []}
    push, friction = system.parameter("push", 12.0, "rad/s"), system.parameter("friction", 0.2)
    for k in range(count):
        speeds = {"velocity": (push * HEIGHT / 2, push * THICK / 2), "angular_velocity": -push}
        place = {"position": (k * PITCH, HEIGHT / 2), "angle": 0.0} | ({} if k else speeds)
        body = system.add(planar.Body(f"domino{k}", mass=MASS, inertia=INERTIA, **place))
        edge = system.ground.point(k * PITCH + THICK / 2, 0)
        system.add(planar.Revolute(f"edge{k}", edge, body.point(THICK / 2, -HEIGHT / 2)))
        groups["blocks"].append(contact.Rectangle(body, (THICK, HEIGHT)))
        groups["feet"].append(contact.Vertex(body.point(-THICK / 2, -HEIGHT / 2)))
    groups["floor"] = [contact.HalfPlane(system.ground)]
    apart = [("blocks", "floor"), ("blocks", "feet"), ("feet", "feet")]
    pairs = [contact.Pair(pair, touching=False) for pair in apart]
    system.add(planar.Collisions("row", groups, friction=friction, pairs=pairs))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("integrator", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_rough_dominoes(integrator):
    """Both schemes are of first order in the step."""
    motion = da.solve_nonsmooth(hinged(), DURATION, step=1e-3, integrator=integrator)
    assert motion.status.success
    tilts = -np.array([motion[f"domino{k}.angle"].values[-1] for k in range(COUNT)])
    assert tilts == pytest.approx(row(12.0, 0.2), abs=0.01)


@pytest.mark.thorough
def test_gradient_by_the_push():
    """The impact lifts the foot of the second domino, which carried it until then."""
    duration, scheme = 0.08, da.MoreauJean()
    motion = da.solve_nonsmooth(hinged(2), duration, step=1e-3, integrator=scheme)
    slope = da.sensitivity(motion, da.final("domino0.angle"), method="adjoint")
    exact = (row(12.01, 0.2, duration)[0] - row(11.99, 0.2, duration)[0]) / 0.02
    assert -slope.sel(parameter="push").item() == pytest.approx(exact, rel=0.01)
