"""Laws of linkages: loops close, cognates draw one curve, mechanisms are the linkages."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import dalembert as da

LINKAGES = [
    da.FourBar(crank=0.4, coupler=1.1, follower=0.9, ground=1.2, u=0.5, v=0.6, x=3, y=1, angle=0.4),
    da.FourBar(crank=1.3, coupler=1.1, follower=1.2, ground=0.5, u=0.5, v=-0.3, branch=-1),
    da.SliderCrank(crank=0.4, coupler=1.3, offset=0.2, u=0.5, v=0.3, x=1, y=-1, angle=0.3),
    da.SliderCrank(crank=0.4, coupler=1.3, offset=-0.1, u=1.5, v=0.3, branch=-1),
]
TURN = np.linspace(0.3, 0.3 + 2 * math.pi, 50)


@pytest.mark.parametrize("linkage", LINKAGES, ids=str)
def test_loop_is_closed(linkage):
    q, theta = linkage.numbers, ca.DM(TURN)
    phi, output = (ca.DM(a) for a in linkage.loop(q, linkage.branch, TURN))
    crank, coupler, ground = (linkage.numbers.get(n, 0.0) for n in ("crank", "coupler", "ground"))
    end = crank * np.exp(1j * TURN) + coupler * np.exp(1j * np.array(phi).ravel())
    out = np.array(output).ravel()
    if isinstance(linkage, da.FourBar):
        arm = end - ground * np.exp(1j * linkage.angle)
        np.testing.assert_allclose(arm, linkage.follower * np.exp(1j * out), atol=1e-13)
    else:
        rail = (out + 1j * linkage.offset) * np.exp(1j * linkage.angle)
        np.testing.assert_allclose(end, rail, atol=1e-13)
    (cosine, sine), there = linkage.closed(q, linkage.branch, theta)  # the same for graphs
    direction = np.array(ca.horzcat(cosine, sine)) @ [1, 1j]
    np.testing.assert_allclose(direction, np.exp(1j * np.array(phi).ravel()), atol=1e-12)
    expected = (np.cos(out), np.sin(out)) if isinstance(there, tuple) else (out,)
    listed = there if isinstance(there, tuple) else (there,)
    for graph, value in zip(listed, expected, strict=True):
        np.testing.assert_allclose(np.array(graph).ravel(), value, atol=1e-12)
    sine = np.array(linkage.transmission_sine(q, phi, output)) * linkage.branch
    assert np.all(sine > 0) and linkage.crank_turns
    # the limits of a whole turn say what the turn shows
    least = linkage.transmission()
    assert all(float(ca.DM(g)) > -1e-4 for g in linkage.rotation_conditions(q, least * (1 - 1e-6)))
    assert any(float(ca.DM(g)) < 0 for g in linkage.rotation_conditions(q, least + 1e-3))


@pytest.mark.parametrize("linkage", LINKAGES, ids=str)
def test_mechanism_is_the_linkage(linkage):
    motion = da.solve_kinematics(linkage.system().build(), duration=2 * math.pi, outputs=25)
    theta = linkage.angle + 0.5 + motion.time
    path = np.stack([motion.values("coupler.P.x"), motion.values("coupler.P.y")], axis=1)
    np.testing.assert_allclose(path, linkage.path(theta), atol=1e-9)


@pytest.mark.parametrize("linkage", LINKAGES[:2], ids=str)
def test_cognates(linkage):
    """Roberts–Chebyshev: three four-bars, one coupler curve."""
    left, right = linkage.cognates()
    k = complex(linkage.u, linkage.v) / linkage.coupler
    # the crank of one turns with ours, ahead by the angle of 1 − k
    np.testing.assert_allclose(right.path(TURN + np.angle(1 - k)), linkage.path(TURN), atol=1e-12)
    # the crank of the other is parallel to our coupler, ahead by the angle of k
    phi = linkage.coupler_angle(TURN) + np.angle(k)
    sides = np.stack([
        np.linalg.norm(replace(left, branch=side).path(phi) - linkage.path(TURN), axis=1)
        for side in (1, -1)
    ])  # fmt: skip
    assert np.min(sides, axis=0).max() < 1e-7  # where crank and coupler align its angles are roots
    again = right.cognates()[1]  # of the cognate, by way of the first pivot
    assert sorted([again.crank, again.ground]) != sorted([right.crank, right.ground])
    assert left.kind != "crank-rocker" or linkage.kind != "crank-rocker"


def test_grashof_kinds():
    def kind(crank, coupler, follower, ground):
        return da.FourBar(crank=crank, coupler=coupler, follower=follower, ground=ground).kind

    assert kind(1, 3, 3, 4) == "crank-rocker"
    assert kind(3, 3, 1, 4) == "rocker-crank"
    assert kind(3, 4, 3, 1) == "double crank"
    assert kind(3, 1, 3, 4) == "double rocker"
    assert kind(2, 2, 2, 5) == "triple rocker"
    assert kind(1, 2, 1, 2) == "change point"


@pytest.mark.parametrize(("swing", "advance"), [(40, 0), (60, 10), (90, -15), (50, 20)])
def test_dead_centres(swing, advance):
    """The follower turns by the swing while the crank turns by 180° and the advance."""
    linkage = da.dead_centre_four_bar(math.radians(swing), math.radians(advance), ground=2.0)
    assert linkage.kind == "crank-rocker" and linkage.ground == 2.0
    turn = np.linspace(0, 2 * math.pi, 200_001)
    psi = np.unwrap(linkage.output(turn))
    assert math.degrees(np.ptp(psi)) == pytest.approx(swing, abs=1e-5)
    way = math.degrees(abs(turn[np.argmax(psi)] - turn[np.argmin(psi)]))
    assert min(way, 360 - way) == pytest.approx(180 - abs(advance), abs=0.02)
    assert linkage.transmission() > 0
    if advance == 0:  # the sizes of a centric crank–rocker, and the best of them
        half = math.sin(math.radians(swing) / 2)
        assert linkage.crank**2 + 4.0 == pytest.approx(linkage.coupler**2 + linkage.follower**2)
        assert linkage.crank == pytest.approx(linkage.follower * half)
        f = np.linspace(0.2 / half, 1.99 / half, 100_001)  # no crank below a tenth
        with np.errstate(invalid="ignore"):
            c = np.sqrt(4 + (f * half) ** 2 - f**2)
            best = np.nanmax(np.arccos(2 * half * f / (c * f)))
        assert linkage.transmission() == pytest.approx(best, abs=1e-4)


def test_no_such_dead_centres():
    with pytest.raises(da.AnalysisError, match="swing"):
        da.dead_centre_four_bar(4.0)
