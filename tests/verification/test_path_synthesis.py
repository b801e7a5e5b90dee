"""Six points on a line by the coupler of a four-bar, in their order, timing free.

Case of J. A. Cabrera, A. Simon, M. Prado (2002), Mechanism and Machine Theory 37, and of S. K.
Acharyya, M. Mandal (2009), MMT 44; best printed design: ant colony search of O. M. J. Itani
(IMECE2019-10262), whose sum of squared distances is 4.08e-5 when recomputed from its dimensions.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da

POINTS = [(20, 20 + 5 * k) for k in range(6)]
LENGTH, PLACE = (5.0, 60.0), (-60.0, 60.0)
BOUNDS = {
    **dict.fromkeys(("ground", "crank", "coupler", "follower"), LENGTH),
    **dict.fromkeys(("x", "y", "u", "v"), PLACE),
}


def test_printed_design():
    """Our four-bar, with the dimensions printed, is as far off as it should be."""
    l, eta, gamma = 47.0469, np.radians(0.0123), np.radians(89.9746)
    printed = da.FourBar(
        **{"ground": 17.9405, "crank": 6.8363, "coupler": 23.5399, "follower": 23.5379},
        **{"x": 60.0, "y": 14.6612, "angle": gamma},
        **{"u": l * np.cos(eta), "v": l * np.sin(eta)},
    )
    turn = np.linspace(0, 2 * np.pi, 400_001)
    path = printed.path(turn)
    off = [((path - point) ** 2).sum(axis=1).min() for point in POINTS]
    assert sum(off) == pytest.approx(4.077e-5, rel=0.02)


@pytest.mark.thorough
def test_better_than_printed():
    synthesis = da.synthesize(da.Target.path(POINTS), bounds=BOUNDS, starts=16)
    best = synthesis.best
    assert best.error <= 4.1e-5
    linkage = best.linkage
    np.testing.assert_allclose(((linkage.path(best.crank_angles) - POINTS) ** 2).sum(), best.error)
    assert linkage.crank_turns
    for name, (lower, upper) in BOUNDS.items():
        assert lower - 1e-6 <= getattr(linkage, name) <= upper + 1e-6
    steps = np.diff(best.crank_angles)
    assert np.all(steps > 0) or np.all(steps < 0)
    assert abs(steps.sum()) < 2 * np.pi


@pytest.mark.thorough
def test_an_ellipse_that_ever_longer_links_draw_better():
    """Acharyya and Mandal's closed path: the search comes to no end, what it reached is a linkage.

    Printed errors are those of links between 5 and 80, 4.7e-3 and more.
    """
    quarter = [(20, 10), (17.66, 15.142), (11.736, 17.878), (5, 16.928), (0.60307, 12.736)]
    ellipse = quarter + [(x, 20 - y) for x, y in reversed(quarter[1:])]
    best = da.synthesize(da.Target.path(ellipse, closed=True), starts=10).best
    off = np.linalg.norm(best.linkage.path(best.crank_angles) - ellipse, axis=1)
    assert best.linkage.crank_turns and best.error < 1e-3
    assert off @ off == pytest.approx(best.error)
