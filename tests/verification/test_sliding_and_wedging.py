"""Rough contacts: a ladder on two rough walls, a wedge between blocks, a block on a plate.

A ladder slips where ``tan θ < (1 − μ²)/(2 μ)`` and then moves by its own equation of motion. A
wedge of the angle ``2 α`` between blocks that are pressed together is expelled where
``2 α > 2 atan μ``, with the acceleration ``a = 2 N (sin α − μ cos α)/M``,
``N = (F − m a tan α)/(cos α + μ sin α)``.
A block on a plate that accelerates until ``t₁`` slips by ``V²/2 (1/(μ g) − 1/A)``, ``V = A t₁``
(Meriam & Kraige, Statics and Dynamics).
"""

from __future__ import annotations

import numpy as np
import pytest
from rigid_contacts import other_warnings
from scipy.integrate import solve_ivp
from thorough import sampled

import dalembert as da
from dalembert import planar

contact = planar.contact
G = 9.81
SCHEMES = pytest.mark.parametrize("scheme", sampled([da.AnticipatedImpacts(), da.MoreauJean()], 2))


def run(system: da.System, duration: float, scheme, step: float = 2e-3) -> da.Motion:
    motion = da.solve_nonsmooth(system.build(), duration, step=step, integrator=scheme)
    assert motion.status.success and not other_warnings(motion)
    return motion


def falling_ladder(theta: float, mu: float, length: float, duration: float) -> float:
    """Angle of a homogeneous ladder that slips on both walls, by the equations of Newton and Euler
    for the angular acceleration and both normal forces, per mass."""

    def rates(t: float, x: np.ndarray) -> list[float]:
        c, s = length / 2 * np.cos(x[0]), length / 2 * np.sin(x[0])
        rows = [  # x = c, y = s: ẍ = R − μ N, ÿ = N + μ R − g, moments about the centre
            [-s, mu, -1.0],
            [c, -1.0, -mu],
            [-(length**2) / 12, -(c - mu * s), mu * c + s],
        ]
        loads = [c * x[1] ** 2, s * x[1] ** 2 - G, 0.0]
        return [x[1], np.linalg.solve(rows, loads)[0]]

    solved = solve_ivp(rates, (0, duration), [theta, 0.0], rtol=1e-10, atol=1e-12)
    return float(solved.y[0, -1])


@SCHEMES
@pytest.mark.parametrize("beyond", [-0.01, 0.01, 0.2])
def test_ladder_between_rough_walls(scheme, beyond):
    mu, length = 0.4, 2.0
    theta = np.arctan((1 - mu**2) / (2 * mu)) - beyond
    system = da.System("ladder", gravity=(0, -G))
    place = (length / 2 * np.cos(theta), length / 2 * np.sin(theta))
    ladder = planar.Bar("ladder", length=length, mass=10.0, position=place, angle=np.pi - theta)
    tips = [contact.Vertex(system.add(ladder).start), contact.Vertex(ladder.end)]
    walls = [
        contact.HalfPlane(system.ground.center, normal=normal) for normal in ((0.0, 1), (1.0, 0))
    ]
    system.add(planar.Collisions("walls", [*tips, *walls], friction=mu))
    motion = run(system, 0.4, scheme)
    moved = np.pi - motion["ladder.angle"][-1].item() - theta
    exact = falling_ladder(theta, mu, length, 0.4) - theta if beyond > 0 else 0.0
    assert moved == pytest.approx(exact, rel=1e-4, abs=1e-9)


@pytest.mark.few(1)
@SCHEMES
@pytest.mark.parametrize("share", [0.98, 1.02])
def test_wedge_between_blocks(scheme, share):
    mu, force, length, duration = 0.3, 50.0, 0.2, 0.2
    alpha, system = np.arctan(mu) * share, da.System("wedge")
    body = system.add(planar.Body("wedge", mass=1.0, inertia=0.01, position=(0, 0)))
    half = length * np.tan(alpha)
    corners = [(0, -length / 2), (half, length / 2), (-half, length / 2)]
    shapes = [contact.Polygon(body, corners)]
    for name, side in (("left", -1), ("right", 1)):
        block = system.add(planar.Body(name, mass=1.0, inertia=0.01, position=(0, 0)))
        rail = planar.Prismatic(f"{name}_rail", system.ground.center, block.center, axis=(1, 0))
        system.add(rail)
        system.add(planar.Force(f"{name}_force", block.center, (-side * force, 0)))
        normal = (-side * np.cos(alpha), np.sin(alpha))
        shapes.append(contact.HalfPlane(block.point(0, -length / 2), normal=normal))
    system.add(planar.Collisions("sides", shapes, friction=mu))
    speed = run(system, duration, scheme)["wedge.vy"][-1].item()
    drive, normal = np.sin(alpha) - mu * np.cos(alpha), np.cos(alpha) + mu * np.sin(alpha)
    exact = 2 * force * drive / (normal + 2 * drive * np.tan(alpha))
    assert speed == pytest.approx(exact * duration if share > 1 else 0.0, rel=1e-6, abs=1e-9)


@SCHEMES
def test_block_on_a_plate_that_accelerates_for_a_while(scheme):
    mu, pull, until = 0.3, 6.0, 0.3
    system = da.System("plate", gravity=(0, -G))
    plate = system.add(planar.Body("plate", mass=5.0, inertia=1.0))
    rail = planar.Prismatic("rail", system.ground.center, plate.center, axis=(1, 0))
    speed = pull * until
    law = da.where(da.t < until, pull * da.t**2 / 2, speed * (da.t - until / 2))
    system.add(planar.TranslationalDriver("drive", system.add(rail), law))
    block = system.add(planar.Body("block", mass=2.0, inertia=0.02, position=(0, 0.1)))
    shapes = [contact.Rectangle(block, (0.3, 0.2)), contact.HalfPlane(plate)]
    system.add(planar.Collisions("top", shapes, friction=mu))
    motion = run(system, 0.65, scheme, 5e-3)
    slip = motion["plate.x"][-1].item() - motion["block.x"][-1].item()
    assert slip == pytest.approx(speed**2 / 2 * (1 / (mu * G) - 1 / pull), rel=1e-4)
