"""Gradients of motions in contact of capsules, polygons and discs: direct, adjoint, differences."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

contact, solid = planar.contact, spatial.contact
INSIDE = 1e-7
"""Overlap at the start [m]; rounding does not decide whether the bodies touch."""


def confirmed(motion: da.Motion, *responses) -> np.ndarray:
    """Direct derivatives, equal to the adjoint ones and to differences."""
    direct, adjoint, differences = (
        da.sensitivity(motion, list(responses), method=method).values
        for method in ("direct", "adjoint", da.FiniteDifference("richardson"))
    )
    scale = abs(direct).max()
    np.testing.assert_allclose(adjoint, direct, rtol=1e-8, atol=1e-10 * scale)
    np.testing.assert_allclose(direct, differences, rtol=1e-5, atol=1e-7 * scale)
    return direct


LOWER = {
    "rectangle": lambda g, size: contact.Rectangle(g.point(0.0, -size), (2.0, 2 * size)),
    "polygon": lambda g, size: contact.Polygon(g, [(-1.0, 0.0), (0.0, -size), (1.0, 0.0)]),
    "capsule": lambda g, size: contact.Capsule(g.point(-1.0, -size), g.point(1.0, -size), size),
}
"""Supports with their upper face at y = 0."""
UPPER = {
    "circle": lambda b, size: contact.Circle(b, size),
    "capsule": lambda b, size: contact.Capsule(b.point(-0.1, 0.0), b.point(0.1, 0.0), size),
    "rectangle": lambda b, size: contact.Rectangle(b, (0.4, 2 * size)),
    "polygon": lambda b, size: contact.Polygon(b, [(-0.2, -size), (0.2, -size), (0.0, size)]),
}
"""Bodies that touch at the height ``-size``."""


@pytest.mark.few(1)
@pytest.mark.parametrize("lower", LOWER)
@pytest.mark.parametrize("upper", UPPER)
def test_body_that_slides(lower, upper):
    """Flush faces touch at two points, of which both slide."""
    system = da.System("slider", gravity=(1.0, -9.81))
    size, friction = system.parameter("size", 0.1, "m"), system.parameter("friction", 0.2)
    speed, depth = system.parameter("speed", 0.5, "m/s"), system.parameter("depth", 0.3, "m")
    body = planar.Body(
        "body", mass=2.0, inertia=0.02, position=(0.0, size - INSIDE), velocity=(speed, 0.0)
    )
    shapes = [UPPER[upper](system.add(body), size), LOWER[lower](system.ground, depth)]
    system.add(planar.Collisions("touch", shapes, friction=friction))
    scheme = da.MoreauJean(projection=False)
    motion = da.solve_nonsmooth(system.build(), 0.1, step=1e-2, integrator=scheme)
    assert motion.status.success
    slope = confirmed(motion, da.final("body.x"), da.final("body.angular_velocity"))
    if upper != "circle":  # x = v t + (g_x − μ g) t²/2
        assert slope[0] == pytest.approx([0.0, -9.81 * 0.005, 0.1, 0.0], abs=2e-4)


@pytest.mark.few(1)
@pytest.mark.parametrize("under", ["capsule", "polygon"])
def test_disc_that_rolls_off_a_corner(under):
    """The normal turns with the disc about a rounded end or a sharp corner."""
    system = da.System("corner", gravity=(0.0, -9.81))
    radius, friction = system.parameter("radius", 0.1, "m"), system.parameter("friction", 0.1)
    lean, end = system.parameter("lean", 0.3, "rad"), system.parameter("end", 0.05, "m")
    shapes = {
        "capsule": lambda g: contact.Capsule(g.point(-1.0, -end), g.point(0.0, -end), end),
        "polygon": lambda g: contact.Polygon(g, [(-1.0, 0.0), (-1.0, -1.0), (0.0, 0.0)]),
    }
    arm = radius + (end if under == "capsule" else 0.0) - 5e-3  # remains closed
    middle = -end if under == "capsule" else 0.0
    place = (arm * da.sin(lean), middle + arm * da.cos(lean))
    disc = planar.Body("disc", mass=1.0, inertia=0.005, position=place, angle=0.0)
    disc_shape = contact.Circle(system.add(disc), radius)
    system.add(
        planar.Collisions("touch", [disc_shape, shapes[under](system.ground)], friction=friction)
    )
    options = {"integrator": da.MoreauJean(projection=False)}
    options["solver"] = da.ContactSolver(tolerance=1e-12)  # for differences
    motion = da.solve_nonsmooth(system.build(), 0.08, step=1e-2, **options)
    assert motion.status.success and (motion.impulse("touch")[1:] > 0).all()
    confirmed(motion, da.final("disc.x"), da.final("disc.vy"), da.final("disc.angle"))


SOLIDS = {
    "sphere": lambda b, size: solid.Sphere(b, size),
    "capsule": lambda b, size: solid.Capsule(b.point(-0.1, 0, 0), b.point(0.1, 0, 0), size),
    "capsule across": lambda b, size: solid.Capsule(b.point(0, -1, 0), b.point(0, 1, 0), size),
    "box": lambda b, size: solid.Box(b.center, (0.4, 0.3, 2 * size)),
    "cylinder": lambda b, size: solid.Cylinder(b.point(0, -0.15, 0), b.point(0, 0.15, 0), size),
    "disc": lambda b, size: solid.Cylinder(b.point(0, 0, -size), b.point(0, 0, size), 0.2),
}
"""Solids that touch at the height ``-size``."""


@pytest.mark.few(1)
@pytest.mark.parametrize("lower", ["box", "capsule"])
@pytest.mark.parametrize("upper", SOLIDS)
def test_solid_that_slides(lower, upper):
    """On a box, whose sides a capsule across overhangs, and on a capsule along the motion."""
    system = da.System("slider", gravity=(1.0, 0.0, -9.81))
    size, friction = system.parameter("size", 0.1, "m"), system.parameter("friction", 0.2)
    speed, depth = system.parameter("speed", 0.5, "m/s"), system.parameter("depth", 0.3, "m")
    body = spatial.Body(
        "body",
        mass=2.0,
        inertia=(0.02, 0.03, 0.04),
        position=(0.0, 0.0, size - INSIDE),
        rotation=np.eye(3),
        velocity=(speed, 0.0, 0.0),
    )
    ground = system.ground
    shapes = [SOLIDS[upper](system.add(body), size)]
    if lower == "box":
        shapes.append(solid.Box(ground.point(0.0, 0.0, -depth), (2.0, 1.0, 2 * depth)))
    else:
        ends = ground.point(-1.0, 0.0, -depth), ground.point(1.0, 0.0, -depth)
        shapes.append(solid.Capsule(*ends, depth))
    system.add(spatial.Collisions("touch", shapes, friction=friction))
    scheme = da.MoreauJean(projection=False)
    motion = da.solve_nonsmooth(system.build(), 0.05, step=1e-2, integrator=scheme)
    assert motion.status.success
    confirmed(motion, da.final("body.x"), da.final("body.vx"))
