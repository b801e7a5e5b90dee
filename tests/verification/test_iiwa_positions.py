"""Positions of a seven-joint arm, KUKA LBR iiwa, by the frames of its joints.

Source: ``multibody/benchmarks/kuka_iiwa_robot`` of Drake (Toyota Research Institute), made with
MotionGenesis: frames of the joints in their parents, and with all angles zero the last link's
frame at (0, 0, 1.261) m, not turned. Other angles: products of the transformations.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial

PI, HALF = np.pi, np.pi / 2
JOINTS = [  # origin in the parent, and roll, pitch and yaw
    ((0, 0, 0.1575), (0, 0, 0)),
    ((0, 0, 0.2025), (HALF, 0, PI)),
    ((0, 0.2045, 0), (HALF, 0, PI)),
    ((0, 0, 0.2155), (HALF, 0, 0)),
    ((0, 0.1845, 0), (-HALF, PI, 0)),
    ((0, 0, 0.2155), (HALF, 0, 0)),
    ((0, 0.081, 0), (-HALF, PI, 0)),
]


def transformed(angles) -> list[tuple[np.ndarray, Rotation]]:
    """Origin and orientation of every link."""
    place, turn, results = np.zeros(3), Rotation.identity(), []
    for (origin, tilt), angle in zip(JOINTS, angles, strict=True):
        place = place + turn.apply(origin)
        turn = turn * Rotation.from_euler("xyz", tilt) * Rotation.from_rotvec([0, 0, angle])
        results.append((place, turn))
    return results


def arm(angles) -> da.Model:
    """With guesses of the poses that are off by centimetres and tenths of radians."""
    rng = np.random.default_rng(7)
    system = da.System("iiwa")
    parent = system.ground
    for k, (((x, y, z), (roll, pitch, yaw)), (place, turn), angle) in enumerate(
        zip(JOINTS, transformed(angles), angles, strict=True), start=1
    ):
        link = spatial.Body(
            f"link{k}",
            mass=1.0,
            inertia=(0.01, 0.01, 0.01),
            position=tuple(place + rng.normal(scale=0.02, size=3)),
            rotation=turn * Rotation.from_rotvec(rng.normal(scale=0.1, size=3)),
        )
        system.add(link)
        tilt = da.rotation.euler("zyx", yaw, pitch, roll)
        hinge = system.add(
            spatial.Revolute(f"J{k}", parent.frame((x, y, z), rotation=tilt), link.frame())
        )
        system.add(spatial.RotationalDriver(f"motor{k}", hinge, angle))
        parent = link
    return system.build()


def pose(model: da.Model, link: str) -> tuple[np.ndarray, Rotation]:
    x, y, z, *parameters = da.solve_assembly(model).pose(link).values()
    return np.array([x, y, z]), Rotation.from_quat(parameters, scalar_first=True)


def test_all_angles_zero():
    place, turn = pose(arm(np.zeros(7)), "link7")
    np.testing.assert_allclose(place, (0, 0, 1.261), atol=1e-12)
    np.testing.assert_allclose(turn.as_matrix(), np.eye(3), atol=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("seed", range(3))
def test_any_angles(seed):
    angles = np.random.default_rng(seed).uniform(-2, 2, 7)
    model = arm(angles)
    for k, (place, turn) in enumerate(transformed(angles), start=1):
        computed, orientation = pose(model, f"link{k}")
        np.testing.assert_allclose(computed, place, atol=1e-11)
        np.testing.assert_allclose(orientation.as_matrix(), turn.as_matrix(), atol=1e-11)
