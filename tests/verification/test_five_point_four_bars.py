"""Five points, two pivots: as many four-bars as Morgan and Wampler counted.

A. P. Morgan, C. W. Wampler, *Solving a planar four-bar design problem using continuation*, Journal
of Mechanical Design 112 (1990), 544-550, problem 7: 36 solutions in general, 33 isolated ones for
points on a line, 15 of them real.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert.design.synthesis.precision_points import general_solutions

POINTS = np.array([(0.50, 1.06), (-0.83, -0.27), (-0.34, 0.22), (-0.13, 0.43), (0.22, 0.78)])


@pytest.mark.thorough
def test_number_of_solutions():
    assert len(general_solutions(0)[1]) == 36
    linkages = da.five_point_four_bars(POINTS)
    assert linkages.isolated == 33 and len(linkages.four_bars) == 15
    assert linkages.residual < 1e-12


def test_four_bars_pass_the_points():
    """Those that do so on one branch, by their own loops; others have to be put together anew."""
    linkages = da.five_point_four_bars(POINTS)
    whole = [bar for bar in linkages.four_bars if bar.on_one_branch]
    assert len(whole) >= 2
    for bar in whole:
        np.testing.assert_allclose(bar.linkage.path(bar.crank_angles), POINTS, atol=1e-9)


def test_moved_and_turned_points_have_the_same_four_bars():
    turn = np.array([[0.6, -0.8], [0.8, 0.6]]) * 2.5
    pivots = np.array([(0.0, 0.0), (1.0, 0.0)])
    linkages = da.five_point_four_bars(POINTS @ turn.T + [3, 1], pivots @ turn.T + [3, 1])
    plain = da.five_point_four_bars(POINTS)
    sizes = [sorted(b.linkage.crank for b in r.four_bars) for r in (plain, linkages)]
    np.testing.assert_allclose(sizes[1], np.array(sizes[0]) * 2.5, rtol=1e-6)
    with pytest.raises(da.AnalysisError, match="5 pairs"):
        da.five_point_four_bars(POINTS[:4])
