"""Five poses: all Burmester dyads and the defects of their linkages.

The poses are those of random four-bars, whose own pins are two of the dyads (Bottema and Roth
1979: none, two or four are real). Circuits are compared with the connected components of all
positions, by solving the loop at many crank angles.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da

TURN = np.linspace(0, 2 * np.pi, 1800, endpoint=False)


def random_bars(count: int, seed: int = 0):
    rng, results = np.random.default_rng(seed), []
    while len(results) < count:
        sizes = dict(zip(("crank", "coupler", "follower", "ground"), rng.uniform(0.3, 2, 4)))  # noqa: B905
        place = dict(zip(("x", "y", "u", "v"), rng.normal(size=4)))  # noqa: B905
        bar = da.FourBar(**sizes, **place, angle=rng.uniform(0, 6), branch=int(rng.choice([-1, 1])))
        if bar.crank_turns:
            results.append((bar, np.sort(rng.uniform(0, 6, 5))))
    return results


def component(linkage: da.FourBar, theta: float, branch: int) -> tuple[int, int]:
    """Arc of crank angles on which the loop closes; and the branch where it is the whole turn."""
    closed = np.isfinite(linkage.coupler_angle(TURN))
    if closed.all():
        return 0, branch
    opened = np.flatnonzero(~closed)
    at = int(np.rint(theta % (2 * np.pi) / (2 * np.pi) * TURN.size)) % TURN.size
    arcs = np.cumsum(np.roll(~closed, -opened[0]))
    return int(arcs[(at - opened[0]) % TURN.size]), 0


def is_same(one: da.FourBar, other: da.FourBar) -> bool:
    """Whether two four-bars have the same lengths, either pivot called the crank's."""
    sizes = [[*sorted([b.crank, b.follower]), b.ground, b.coupler] for b in (one, other)]
    return bool(np.allclose(*sizes, rtol=1e-6))


def test_pivots_are_among_the_dyads_and_defects_are_right():
    with_defects = 0
    for bar, theta in random_bars(20):
        points, angles = bar.path(theta), bar.coupler_angle(theta)
        linkages = da.pose_linkages(points, angles)
        assert len(linkages.dyads) in (2, 4) and max(d.residual for d in linkages.dyads) < 1e-8
        pivots = complex(bar.x, bar.y) + np.array([0, bar.ground * np.exp(1j * bar.angle)])
        for pivot in pivots:
            assert min(abs(d.center - pivot) for d in linkages.dyads if not d.is_slider) < 1e-6
        assert len(linkages.linkages) == len(linkages.dyads) * (len(linkages.dyads) - 1) // 2
        own = [o for o in linkages.linkages if is_same(o.linkage, bar)]
        assert own and own[0].defects == ()
        for one in linkages.linkages:
            with_defects += bool(one.defects)
            there = one.linkage
            turned = angles - angles[0] + there.coupler_angle(one.crank_angles[0])
            ends = there.points(there.numbers, 1, one.crank_angles), there.points(
                there.numbers, -1, one.crank_angles)  # fmt: skip
            wanted = points @ [1, 1j]
            off = np.array([abs(end - wanted) for end in ends])
            assert np.nanmax(np.nanmin(off, axis=0)) < 1e-5 * np.ptp(abs(wanted - wanted[0]))
            phi = np.array([there.loop(there.numbers, b, one.crank_angles)[0] for b in (1, -1)])
            gap = abs(np.exp(1j * phi) - np.exp(1j * turned))
            branches = np.where(np.argmin(np.nan_to_num(gap, nan=9), axis=0) == 0, 1, -1)
            assert one.branch_defect == bool(np.ptp(branches))
            parts = {
                component(there, t, b) for t, b in zip(one.crank_angles, branches, strict=True)
            }
            assert one.circuit_defect == (len(parts) > 1)
    assert with_defects > 5


def test_counts_are_even():
    rng = np.random.default_rng(1)
    for _ in range(30):
        dyads = da.burmester_dyads(rng.normal(size=(5, 2)), rng.uniform(-3, 3, 5))
        assert len(dyads) in (0, 2, 4)


def test_a_slider_is_a_dyad_too():
    slider = da.SliderCrank(crank=0.4, coupler=1.3, offset=0.2, u=0.5, v=0.3, x=1, y=-1, angle=0.3)
    turn = np.array([0.2, 0.9, 1.7, 2.6, 3.4])
    linkages = da.pose_linkages(slider.path(turn), slider.coupler_angle(turn))
    same = [o.linkage for o in linkages.linkages if isinstance(o.linkage, da.SliderCrank)]
    assert any(abs(s.crank - 0.4) + abs(s.coupler - 1.3) < 1e-6 for s in same)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_fewer_poses_have_families(count):
    rng = np.random.default_rng(count)
    points, angles = rng.normal(size=(count, 2)), rng.uniform(-1, 1, count)
    linkages = da.pose_linkages(points, angles, samples=8)
    assert len(linkages.dyads) >= 8 and max(d.residual for d in linkages.dyads) < 1e-8
    assert linkages.linkages and max(one.residual for one in linkages.linkages) < 1e-6


def test_wrong_poses():
    with pytest.raises(da.AnalysisError, match="two to five"):
        da.pose_linkages(np.zeros((6, 2)), np.arange(6))
    with pytest.raises(da.AnalysisError, match="poses 1 and 2 are equal"):
        da.pose_linkages([(0, 0), (0, 0), (1, 1)], [0, 0, 1])
