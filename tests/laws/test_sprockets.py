"""Toothed wheels of chains: distances of rollers from seats and flanks, all around alike."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar

TEETH, PITCH, ROLLER = 11, 12.7e-3, 7.92e-3
RADIUS = PITCH / (2 * np.sin(np.pi / TEETH))
TOOTH = 2 * np.pi / TEETH


def distance():
    """Function of the pose of the wheel and of a place, and its gradient by the place."""
    wheel = planar.Body("wheel", mass=1.0, inertia=1.0)
    sprocket = planar.contact.Sprocket(wheel.center, TEETH, PITCH, ROLLER)
    place = ca.SX.sym("place", 2)
    distance = sprocket.distance(place, False)
    return ca.Function("distance", [wheel.pose, place], [distance, ca.gradient(distance, place)])


def at(angle: float, radius: float = RADIUS) -> np.ndarray:
    return radius * np.array([np.cos(angle), np.sin(angle)])


def test_rollers_sit_loosely_in_every_seat():
    computed = [float(distance()([0, 0, 0], at(k * TOOTH))[0]) for k in range(TEETH)]
    np.testing.assert_allclose(np.array(computed) - ROLLER / 2, 0.005 * ROLLER, rtol=1e-10)


def test_it_turns_and_moves_with_its_body():
    turned, shift = 0.4, np.array([0.3, -0.2])
    place = at(0.13, 1.1 * RADIUS)
    rotated = at(0.13 + turned, 1.1 * RADIUS) + shift
    plain, moved = distance()([0, 0, 0], place)[0], distance()([*shift, turned], rotated)[0]
    assert float(plain) == pytest.approx(float(moved), rel=1e-12)


def test_its_surface_is_smooth_from_seat_to_flank():
    """Where rollers may be, the gradient is a unit vector and distances go on without a jump."""
    angles = np.linspace(0.02, TOOTH - 0.02, 4001)
    function, near = distance(), []
    for angle in angles:
        value, slope = function([0, 0, 0], at(angle, RADIUS + 1e-3))
        near.append(float(value))
        assert np.linalg.norm(slope.full()) == pytest.approx(1.0, abs=1e-9)
    step = (RADIUS + 1e-3) * (angles[1] - angles[0])
    assert np.abs(np.diff(near)).max() <= step * (1 + 1e-9)
    np.testing.assert_allclose(near, near[::-1], atol=1e-12)  # the two flanks are alike


def test_invalid_sprockets_are_refused():
    wheel = planar.Body("wheel", mass=1.0, inertia=1.0)
    with pytest.raises(da.ModelError, match="teeth is 3"):
        planar.contact.Sprocket(wheel.center, 3, PITCH, ROLLER)
    with pytest.raises(da.ModelError, match="give pitch="):
        planar.contact.Sprocket(wheel.center, 11)
