"""IFToMM spatial slider–crank: revolute, spherical, universal and prismatic joint in one loop.

Sources: E. J. Haug, *Computer Aided Kinematics and Dynamics of Mechanical Systems*, 1989, pp.
396-401, and B. Masoudi, J. McPhee (2013) in the IFToMM library of computational benchmark problems.
The published history is that of F. González, good to 1e-4; the closer one integrates the equation
of the one freedom.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

HISTORY = np.array(
    [  # t, x of the slider and angle of the crank by one equation, x as published
        (0.0, 0.2, 0.0, 0.2),
        (0.1, 0.226787188553, 0.560031482, 0.226785384),
        (0.2, 0.263038972581, 1.287242327, 0.263034975),
        (0.3, 0.281927022556, 3.070854737, 0.28194126),
        (0.4, 0.222832577664, 4.409540589, 0.222848664),
        (0.5, 0.184952629778, 5.583762553, 0.184952803),
        (0.6, 0.205160055599, 6.405228002, 0.205149298),
        (0.7, 0.233451881715, 6.970053849, 0.233436939),
        (0.8, 0.272270114233, 7.799514229, 0.272248997),
        (0.9, 0.269855199473, 9.724410950, 0.269894777),
        (1.0, 0.211721661394, 10.913590730, 0.211754668),
        (1.5, 0.256907745117, 16.308403002, 0.25696554),
        (2.0, 0.289085197067, 21.072744523, 0.289063554),
        (2.5, 0.256552872782, 26.276849043, 0.256509783),
        (3.0, 0.228484813696, 32.008327756, 0.228450093),
        (3.5, 0.206541782425, 37.851938890, 0.206512886),
        (4.0, 0.188230475579, 43.601753906, 0.188208161),
        (4.5, 0.199255496874, 48.894796799, 0.199295373),
        (5.0, 0.240719573741, 54.333332168, 0.240761815),
    ]
)
TIMES, SLIDER, ANGLE, PUBLISHED = HISTORY.T


def mechanism(rod_length: float = 0.3, angle: float = 0.0, speed: float | None = 6.0) -> da.System:
    """The crank stands upright at no angle and turns about x."""
    system = da.System("spatial slider-crank", gravity=(0.0, 0.0, -9.81))
    pivot = np.array([0.0, 0.1, 0.12])
    turn = da.rotation.axis_angle((1, 0, 0), angle)
    spin = {} if speed is None else {"angular_velocity": (speed, 0, 0)}
    arm = 0.08 * np.array([0.0, -math.sin(angle), math.cos(angle)])
    tip = pivot + arm
    x = math.sqrt(rod_length**2 - tip @ tip)
    along = (np.array([x, 0, 0]) - tip) / rod_length
    across = np.cross((1, 0, 0), along) / np.linalg.norm(along[1:])
    axes = np.column_stack([along, np.cross(across, along), across])
    crank = system.add(
        spatial.Body(
            "crank",
            mass=0.12,
            inertia=(1e-4, 1e-5, 1e-4),
            position=tuple(pivot + arm / 2),
            rotation=turn,
            **spin,
        )
    )
    rod = spatial.Body(
        "rod",
        mass=0.5,
        inertia=(4e-4, 4e-3, 4e-3),
        position=tuple((tip + np.array([x, 0, 0])) / 2),
        rotation=axes,
    )
    slider = spatial.Body("slider", mass=2.0, inertia=(1e-4,) * 3, position=(x, 0, 0))
    system.add(rod)
    system.add(slider)
    half, ahead = rod_length / 2, (1, 0, 0)
    system.add(
        spatial.Revolute(
            "A",
            system.ground.frame(tuple(pivot), axis=ahead, x=(0, 1, 0)),
            crank.frame((0, 0, -0.04), axis=ahead, x=(0, 1, 0)),
        )
    )
    system.add(spatial.Spherical("B", crank.point(0, 0, 0.04), rod.point(-half, 0, 0)))
    system.add(
        spatial.Universal("C", rod.frame((half, 0, 0), axis=(0, 0, 1)), slider.frame(axis=ahead))
    )
    system.add(
        spatial.Prismatic(
            "D",
            system.ground.frame(axis=ahead, x=(0, 1, 0)),
            slider.frame(axis=ahead, x=(0, 1, 0)),
        )
    )
    return system


@pytest.fixture(scope="module")
def motion() -> da.Motion:
    run = da.solve_dynamics(
        mechanism().build(), 5.0, integrator=da.DormandPrince853(1e-10, 1e-10), outputs=TIMES
    )
    assert run.status.success
    return run


def test_start_is_the_published_one(motion):
    """Places and speeds of the rod and the slider follow from the crank."""
    for measure, expected in (
        ("slider.velocity", (0.24, 0, 0)),
        ("rod.velocity", (0.12, -0.24, 0)),
        ("rod.angular_velocity", (1.92, -0.96, 0.48)),
    ):
        np.testing.assert_allclose(motion[measure].values[0], expected, atol=1e-12)


def test_slider_within_1e_6(motion):
    computed = motion["slider.x"].values
    np.testing.assert_allclose(computed, SLIDER, atol=1e-6)
    np.testing.assert_allclose(computed, PUBLISHED, atol=1e-4)


def test_crank_and_energy(motion):
    computed, turns = motion["A.angle"].values, 2 * np.pi
    np.testing.assert_allclose((computed - ANGLE + np.pi) % turns, np.pi, atol=1e-6)
    np.testing.assert_allclose(motion["energy"] - motion["energy"][0], 0.0, atol=1e-7)


SHORTEST = math.hypot(0.1, 0.12) + 0.08
"""√(0.1² + 0.12²) + 0.08 = 0.236204993518, the greatest distance of the crank pin from the axis."""


def driven(rod_length: float) -> da.Motion:
    """One turn of the crank, begun from where the axis is nearest to it."""
    angle = math.pi + math.atan2(-0.1, 0.12)
    system = mechanism(rod_length, angle, None)
    hinge = next(e for e in system.elements.values() if e.name == "A")
    system.add(spatial.RotationalDriver("motor", hinge, angle + 2 * np.pi * da.t))
    return da.solve_kinematics(system.build(), 1.0, step=0.01)


def test_short_rod_locks_up():
    """Haug, ch. 10: the book prints 0.2362 m."""
    length = SHORTEST - 1e-4
    motion = driven(length)
    assert motion.status.outcome is da.Outcome.LOCKED
    turned = np.pi - np.arccos((length**2 - 0.0308) / np.hypot(0.016, 0.0192))
    assert motion.events[-1].time == pytest.approx(turned / (2 * np.pi), abs=1e-6)


def test_longer_rod_runs_through():
    length = SHORTEST + 1e-4
    motion = driven(length)
    assert motion.status.outcome is da.Outcome.COMPLETED
    angle = motion["motor.coordinate"].values + np.pi / 2  # from the y axis
    square = 0.0308 + 0.016 * np.cos(angle) + 0.0192 * np.sin(angle)
    np.testing.assert_allclose(motion["slider.x"], np.sqrt(length**2 - square), atol=1e-9)
    between = np.array([0.1234, 0.5031, 0.777])  # no outputs: reached from the nearest positions
    angle = angle[0] + 2 * np.pi * between
    square = 0.0308 + 0.016 * np.cos(angle) + 0.0192 * np.sin(angle)
    computed = motion.at(between)["slider.x"]
    np.testing.assert_allclose(computed, np.sqrt(length**2 - square), atol=1e-9)
