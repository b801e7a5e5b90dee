"""Laws of cams whose followers swing: contact, curvature, pressure angle, smallest cams."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da

LIFT = da.CycloidalRise(
    height=0.3, duration=math.pi / 2, dwell=math.pi / 4, fall=math.pi / 2, period=2 * math.pi
)
"""Of a follower that swings [rad]."""
HALF = da.CycloidalRise(
    height=0.15, duration=math.pi / 2, dwell=math.pi / 4, fall=math.pi / 2, period=2 * math.pi
)


def test_swinging_roller_stays_on_its_cam():
    """At every angle the nearest place of the profile is one radius from the roller."""
    cam = da.SwingingRollerCam(
        law=LIFT, base_radius=0.03, arm=0.08, distance=0.09, roller_radius=0.008
    )
    assert not cam.undercut()
    profile, pitch = cam.profile(), cam.pitch()
    near = np.linalg.norm(profile[None] - pitch[::40, None], axis=2).min(axis=1)
    np.testing.assert_allclose(near, 0.008, rtol=1e-4)
    # at rest on the base circle, and the arm keeps its length
    assert np.linalg.norm(profile[0]) == pytest.approx(0.03)
    angles = np.linspace(0, 6, 25)
    pivot = 0.09 * np.exp(-1j * angles)
    arm = abs(cam.pitch(angles) @ [1, 1j] - pivot)
    np.testing.assert_allclose(arm, 0.08, rtol=1e-12)


def test_curvature_and_pressure_angle_of_swinging_followers():
    """Against differences of the profile itself; the angle by Norton's formula."""
    roller = da.SwingingRollerCam(
        law=LIFT, base_radius=0.03, arm=0.08, distance=0.09, roller_radius=0.008
    )
    flat = da.SwingingFlatCam(law=LIFT, base_radius=0.05, distance=0.12, offset=0.01)
    angles = np.linspace(0.05, 1.5, 30)
    for cam in (roller, flat):
        h = 1e-4
        a, b, c = (cam.profile(angles + k * h) @ [1, 1j] for k in (-1, 0, 1))
        rate, bend = (c - a) / (2 * h), (c - 2 * b + a) / h**2
        radius = abs(rate) ** 3 / -(rate.conj() * bend).imag
        np.testing.assert_allclose(cam.radius(angles), radius, rtol=1e-4)
    s, rate, _ = roller.lift(angles)
    psi = roller.start + s
    tangent = (0.08 * (1 + rate) - 0.09 * np.cos(psi)) / (0.09 * np.sin(psi))
    np.testing.assert_allclose(np.tan(roller.pressure_angle(angles)), tangent, rtol=1e-9)


def test_flat_face_that_swings_is_touched_and_never_cut():
    """The face, a line, has the whole cam on one side and touches it where it is said to."""
    cam = da.SwingingFlatCam(law=HALF, base_radius=0.06, distance=0.12, offset=0.01)
    assert not cam.undercut() and cam.face[0] > 0
    profile = cam.profile(np.linspace(0, 2 * math.pi, 20_001)) @ [1, 1j]
    for theta in np.linspace(0, 6, 13):
        psi = cam.start + float(cam.lift(theta)[0])
        outward = 1j * np.exp(-1j * (psi + theta))
        reach = (profile * outward.conjugate()).real.max()
        assert reach == pytest.approx(0.12 * math.sin(psi) - 0.01, rel=1e-6)
    sharp = da.SwingingFlatCam(law=LIFT, base_radius=0.01, distance=0.12)
    assert sharp.undercut()


def test_smallest_cam_of_a_swinging_roller_is_at_its_limit():
    cam = da.SwingingRollerCam.smallest(
        LIFT, pressure_angle=math.radians(30), arm=0.08, roller_radius=0.006
    )
    assert abs(cam.pressure_angle()).max() == pytest.approx(math.radians(30), rel=1e-3)
    assert not cam.undercut()
    for distance in (0.97, 1.03):
        other = da.SwingingRollerCam(
            law=LIFT,
            base_radius=cam.base_radius,
            arm=0.08,
            distance=cam.distance * distance,
            roller_radius=0.006,
        )
        assert abs(other.pressure_angle()).max() > math.radians(30)


def test_swinging_followers_that_cannot_be_are_told():
    with pytest.raises(da.AnalysisError, match="out of reach"):
        da.SwingingRollerCam(law=LIFT, base_radius=0.2, arm=0.08, distance=0.09)
    with pytest.raises(da.AnalysisError, match="pressure angle"):
        da.SwingingRollerCam.smallest(LIFT, pressure_angle=2.0, arm=0.1)
    with pytest.raises(da.AnalysisError, match="do not touch"):
        da.SwingingFlatCam(law=HALF, base_radius=0.2, distance=0.1)
