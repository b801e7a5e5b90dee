"""Cams: a disc that turns about a point off its middle is the one cam that everybody knows."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da

TURN = np.linspace(0, 2 * math.pi, 61)
RISE = da.CycloidalRise(
    height=0.02, duration=math.pi / 2, dwell=math.pi / 4, fall=math.pi / 2, period=2 * math.pi
)


def test_flat_face_on_an_eccentric_disc():
    """s = e (1 − cos θ) on a base circle R: a disc of radius R + e, its middle at e."""
    cam = da.FlatFaceCam(law=0.01 * (1 - da.cos(da.t)), base_radius=0.03)
    np.testing.assert_allclose(np.linalg.norm(cam.profile(TURN) - [0, -0.01], axis=1), 0.04)
    np.testing.assert_allclose(cam.radius(TURN), 0.04)
    assert not cam.undercut() and cam.face == pytest.approx((-0.01, 0.01))
    assert np.all(cam.pressure_angle() == 0)


def test_roller_on_an_eccentric_disc():
    """The centre of the roller is at R + r from the middle of the disc."""
    e, disc, r = 0.01, 0.04, 0.006
    law = -e * da.cos(da.t) + ((disc + r) ** 2 - (e * da.sin(da.t)) ** 2) ** 0.5 - (disc - e) - r
    cam = da.RollerCam(law=law, base_radius=disc - e, roller_radius=r)
    middle = [0, -e]
    np.testing.assert_allclose(np.linalg.norm(cam.pitch(TURN) - middle, axis=1), disc + r)
    np.testing.assert_allclose(np.linalg.norm(cam.profile(TURN) - middle, axis=1), disc)
    np.testing.assert_allclose(cam.radius(TURN), disc)
    # the force goes through the middle of the disc
    assert abs(cam.pressure_angle()).max() == pytest.approx(math.asin(e / (disc + r)), rel=1e-5)


@pytest.mark.parametrize("offset", [0.0, 0.008])
def test_curvature_is_that_of_the_points(offset):
    """Radius of the circle through three neighbours, and the roller touches the profile."""
    cam = da.RollerCam(law=RISE, base_radius=0.03, roller_radius=0.005, offset=offset)
    theta = np.array([0.3, 0.7, 1.2, 2.5, 3.0])
    h = 1e-3
    a, b, c = (cam.profile(theta + k * h) for k in (-1, 0, 1))
    sides = [np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a))]
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    np.testing.assert_allclose(-np.prod(sides, axis=0) / (2 * area), cam.radius(theta), rtol=1e-3)
    fine = cam.profile(np.linspace(0, 2 * math.pi, 20_001))
    gap = np.linalg.norm(cam.pitch(theta)[:, None] - fine[None], axis=2).min(axis=1)
    np.testing.assert_allclose(gap, 0.005, rtol=1e-4)


def test_smallest_cams():
    limit = math.radians(30)
    cam = da.RollerCam.smallest(RISE, limit, roller_radius=0.005, minimum_radius=0.002)
    assert abs(cam.pressure_angle()).max() <= limit * (1 + 1e-9) and not cam.undercut()
    centred = da.RollerCam(law=RISE, base_radius=cam.base_radius, roller_radius=0.005)
    assert abs(centred.pressure_angle()).max() >= limit * (1 - 1e-3)  # the offset pays, or is none
    flat = da.FlatFaceCam.smallest(RISE, minimum_radius=0.004)
    assert flat.radius().min() == pytest.approx(0.004)
    tight = da.FlatFaceCam(law=RISE, base_radius=flat.base_radius - 0.005)
    assert tight.undercut() and not flat.undercut()
    assert da.RollerCam(law=RISE, base_radius=0.005, roller_radius=0.03).undercut()


def test_invalid_cams_are_refused():
    with pytest.raises(da.AnalysisError, match="base_radius"):
        da.FlatFaceCam(law=RISE, base_radius=-1)
    with pytest.raises(da.AnalysisError, match="offset"):
        da.RollerCam(law=RISE, base_radius=0.01, offset=0.02)
    with pytest.raises(da.AnalysisError, match="pressure angle"):
        da.RollerCam.smallest(RISE, 2.0)
