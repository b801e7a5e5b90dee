"""Rotors in joints: their inertia adds to the diagonal of the mass matrix in joint coordinates.

Featherstone, Rigid Body Dynamics Algorithms (2008), 9.6.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

LENGTH, MASS, MOMENT, ROTOR = 1.2, 2.0, 3.0, 0.7


def arm(space, inertia=ROTOR):
    """Two bars with motors in both joints, in the x-y plane."""
    system = da.System("arm", gravity=(0.0, -9.81) if space is planar else (0.0, -9.81, 0.0))
    options = {"angle": 0.3} if space is planar else {"rotation": da.rotation.bryant(0, 0, 0.3)}
    options |= {} if space is planar else {"radius": 0.05}
    bars = [system.add(space.Bar(name, length=LENGTH, mass=MASS, **options)) for name in ("a", "b")]
    if space is planar:
        ends = [system.ground.center, bars[0].start, bars[0].end, bars[1].start]
    else:
        places = [(-LENGTH / 2, 0, 0), (LENGTH / 2, 0, 0), (-LENGTH / 2, 0, 0)]
        owners = [bars[0], bars[0], bars[1]]
        ends = [system.ground.frame()]
        ends += [body.frame(place) for body, place in zip(owners, places, strict=True)]
    joints = [
        system.add(space.Revolute(name, *ends[2 * k : 2 * k + 2])) for k, name in enumerate("AB")
    ]
    for joint in joints:
        system.add(space.JointActuator(f"motor_{joint.name}", joint, MOMENT, inertia=inertia))
    return system.build()


@pytest.mark.parametrize("space", [planar, spatial])
def test_rotor_adds_to_the_inertia_of_a_bar(space):
    system = da.System("wheel")
    if space is planar:
        wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.5))
        hinge = system.add(planar.Revolute("O", system.ground.center, wheel.center))
    else:
        wheel = system.add(spatial.Body("wheel", mass=1.0, inertia=(0.5, 0.5, 0.5)))
        hinge = system.add(spatial.Revolute("O", system.ground.frame(), wheel.frame()))
    system.add(space.JointActuator("motor", hinge, MOMENT, inertia=ROTOR))
    model = system.build()
    for coordinates in (da.AbsoluteCoordinates(), da.JointCoordinates()):
        motion = da.solve_dynamics(model, 1.0, step=0.005, coordinates=coordinates)
        angle = MOMENT / (0.5 + ROTOR) / 2
        np.testing.assert_allclose(motion["O.angle"][-1], angle, rtol=1e-9)
        np.testing.assert_allclose(motion["kinetic_energy"][-1], MOMENT * angle, rtol=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("space", [planar, spatial])
def test_both_coordinates_agree(space):
    model = arm(space)
    runs = [
        da.solve_dynamics(model, 0.5, step=0.002, coordinates=coordinates)
        for coordinates in (da.AbsoluteCoordinates(), da.JointCoordinates())
    ]
    for name in ("b.x", "b.y", "A.force", "B.force", "kinetic_energy"):
        np.testing.assert_allclose(*(run[name].values for run in runs), atol=1e-7)
    without = da.solve_dynamics(arm(space, 0.0), 0.5, step=0.002)
    assert abs(without["b.x"][-1] - runs[0]["b.x"][-1]) > 0.01


def test_absolute_angles_are_refused():
    coordinates = da.JointCoordinates(angles="absolute")
    with pytest.raises(da.UnsupportedError, match="relative"):
        da.solve_dynamics(arm(planar), 0.1, step=0.1, coordinates=coordinates)


def test_rotors_stay_in_the_tree_of_a_loop():
    system = da.System("four-bar", gravity=(0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.0, angle=1.5))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=2.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=1.5, angle=1.0))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    joint = system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("C", system.ground.point(1, 0), rocker.start))
    system.add(planar.JointActuator("motor", joint, 1.0, inertia=0.2))
    model = system.build()
    runs = [
        da.solve_dynamics(model, 0.5, step=0.002, coordinates=coordinates)
        for coordinates in (da.AbsoluteCoordinates(), da.JointCoordinates())
    ]
    np.testing.assert_allclose(*(run["crank.angle"].values for run in runs), atol=1e-7)
    with pytest.raises(da.UnsupportedError, match="closes a loop"):
        da.solve_dynamics(model, 0.1, step=0.1, coordinates=da.JointCoordinates(cut=("B",)))


def test_rotors_of_joints_whose_frames_are_turned_to_each_other():
    """Bodies start turned by the identity, where the angle of such a joint is not defined."""
    system = da.System("arm")
    body = {"mass": 1.0, "inertia": (0.1, 0.1, 0.1)}
    upper, lower = (system.add(spatial.Body(name, **body)) for name in ("upper", "lower"))
    base = system.ground.frame(axis=(0, 0, 1))
    system.add(spatial.Revolute("shoulder", base, upper.frame(axis=(0, 0, 1))))
    frames = upper.frame((0, 0, 0.1), axis=(0, -1, 0), x=(1, 0, 0)), lower.frame(axis=(1, 0, 0))
    elbow = system.add(spatial.Revolute("elbow", *frames))
    system.add(spatial.JointActuator("motor", elbow, 0.0, inertia=0.2))
    assert not system.build().diagnosis.massless


def test_rotors_on_massless_bodies():
    """A rotor gives a body an inertia about one axis; the range-space method needs the others."""
    system = da.System("gimbal", gravity=(0, 0, -9.81))
    ring = system.add(spatial.Body("ring"))
    load = system.add(spatial.Body("load", mass=2.0, inertia=(0.1, 0.2, 0.3), position=(0.3, 0, 0)))
    base = system.ground.frame(axis=(0, 0, 1))
    yaw = system.add(spatial.Revolute("yaw", base, ring.frame(axis=(0, 0, 1))))
    ends = ring.frame(axis=(0, 1, 0)), load.frame((-0.3, 0, 0), axis=(0, 1, 0))
    pitch = system.add(spatial.Revolute("pitch", *ends))
    system.add(spatial.JointActuator("motor", yaw, 0.5, inertia=ROTOR))
    system.add(spatial.JointActuator("brake", pitch, 0.0, inertia=ROTOR))
    motion = da.solve_dynamics(system.build(), 0.01, step=1e-3, formulation=da.RangeSpace())
    assert motion.status.success
    spin, turn = (motion[f"load.angular_acceleration.{axis}"][0].item() for axis in "zy")
    assert spin == pytest.approx(0.5 / (ROTOR + 0.3 + 2 * 0.3**2), rel=1e-9)
    assert turn == pytest.approx(2 * 9.81 * 0.3 / (ROTOR + 0.2 + 2 * 0.3**2), rel=1e-9)
