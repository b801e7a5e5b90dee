"""Laws of synthesis: what a linkage does is found again, within the limits that were set."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da

BAR = da.FourBar(
    **{"crank": 0.4, "coupler": 1.1, "follower": 0.9, "ground": 1.2},
    **{"u": 0.5, "v": 0.6, "x": 3.0, "y": 1.0, "angle": 0.4},
    branch=-1,
)
SLIDER = da.SliderCrank(crank=0.4, coupler=1.3, offset=0.2, u=0.5, v=0.3, x=1.0, angle=0.3)
TURN = np.linspace(0, 2 * math.pi, 25)[:-1]
PIECE = np.array([0.2, 0.6, 1.1, 1.7])


@pytest.mark.few(1)
@pytest.mark.parametrize("linkage", [BAR, SLIDER], ids=["four-bar", "slider-crank"])
def test_path_of_a_linkage_is_found(linkage):
    kind = type(linkage)
    timed = da.synthesize(da.Target.path(linkage.path(TURN), TURN), kind, starts=12)
    closed = da.synthesize(da.Target.path(linkage.path(TURN), closed=True), kind, starts=12)
    for synthesis in (timed, closed):
        assert synthesis.best.error < 1e-12
        assert synthesis.best.linkage.crank_turns


def test_cognates_are_found_too():
    """A path with timing has two crank-driven four-bars, by the theorem of Roberts."""
    synthesis = da.synthesize(da.Target.path(BAR.path(TURN), TURN), starts=24)
    exact = [s.linkage for s in synthesis.solutions if s.error < 1e-12]
    for wanted in (BAR, BAR.cognates()[1]):
        sizes = [wanted.numbers[n] for n in ("crank", "coupler", "follower", "ground", "u", "v")]
        there = [[e.numbers[n] for n in ("crank", "coupler", "follower", "ground", "u", "v")]
                 for e in exact]  # fmt: skip
        assert any(np.allclose(sizes, other, atol=1e-3) for other in there)


@pytest.mark.thorough
@pytest.mark.parametrize("linkage", [BAR, SLIDER], ids=["four-bar", "slider-crank"])
def test_poses_and_functions_are_found(linkage):
    kind = type(linkage)
    poses = da.Target.motion(linkage.path(PIECE), linkage.coupler_angle(PIECE) - 0.3)
    outputs = linkage.output(PIECE) + 0.7
    for target in (poses, da.Target.function(PIECE - 0.2, outputs)):
        synthesis = da.synthesize(target, kind, starts=16)
        assert synthesis.best.error < 1e-12


def test_freudenstein():
    """Three exact pairs satisfy K₁ cos ψ − K₂ cos θ + K₃ = cos(θ − ψ).

    Source: F. Freudenstein (1955), Transactions of the ASME 77, 853-861.
    """
    inputs, outputs = np.radians([0.0, 30.0, 60.0]), np.radians([0.0, 25.0, 60.0])
    synthesis = da.synthesize(da.Target.function(inputs, outputs), starts=12)
    assert synthesis.best.error < 1e-14
    bar, theta = synthesis.best.linkage, synthesis.best.crank_angles
    psi = np.unwrap(bar.output(theta))
    np.testing.assert_allclose(psi - psi[0], outputs, atol=1e-7)
    rows = np.stack([np.cos(psi), -np.cos(theta), np.ones(3)], axis=1)
    k1, k2, k3 = np.linalg.solve(rows, np.cos(theta - psi))
    d, c, f, g = bar.crank, bar.coupler, bar.follower, bar.ground
    assert [k1, k2] == pytest.approx([g / d, g / f], rel=1e-4)
    assert k3 == pytest.approx((d**2 - c**2 + f**2 + g**2) / (2 * d * f), rel=1e-4)


@pytest.mark.few(1)
@pytest.mark.parametrize(("count", "best_error"), [(6, 2.52e-6), (10, 6.18e-6)], ids=["six", "ten"])
def test_a_few_starts_are_enough_for_a_function(count, best_error):
    """A square over 90°; ``known`` is the best of 300 random starts."""
    share = np.linspace(0, 1, count)
    target = da.Target.function(math.pi / 2 * share, math.pi / 2 * share**2)
    synthesis = da.synthesize(target, crank_turns=False, starts=6)
    assert synthesis.best.error <= best_error


def test_a_path_that_is_met_poorly_has_a_best_linkage():
    """An ellipse against the sense of the crank."""
    theta = TURN[::2]
    for sense in (1, -1):
        points = np.stack([2 * np.cos(theta), sense * np.sin(theta)], axis=1)
        synthesis = da.synthesize(da.Target.path(points, theta), starts=2)
        assert synthesis.best.error < 0.05 and synthesis.best.linkage.crank_turns


@pytest.mark.thorough
def test_linkages_that_differ_by_full_turns_or_names_count_once():
    poses = da.Target.motion(BAR.path(PIECE), BAR.coupler_angle(PIECE))
    synthesis = da.synthesize(poses, starts=8, crank_turns=False)
    assert synthesis.best.error < 1e-20  # exact by Burmester dyads
    places = [np.sort_complex(np.round(s.linkage.joints(s.crank_angles[0])[:4], 3))
              for s in synthesis.solutions]  # fmt: skip
    assert all(np.max(abs(a - b)) > 1e-3 for k, a in enumerate(places) for b in places[:k])


@pytest.mark.thorough
def test_limits_are_kept():
    least = math.radians(40)
    ends = {"x": (2.5, 3.5), "crank": (0.2, 0.5)}
    path = da.Target.path(BAR.path(PIECE))
    synthesis = da.synthesize(path, bounds=ends, transmission=least, starts=12)
    for solution in synthesis.solutions:
        linkage = solution.linkage
        assert linkage.crank_turns and linkage.transmission() > least - 1e-6
        assert all(a - 1e-7 <= getattr(linkage, n) <= b + 1e-7 for n, (a, b) in ends.items())
        steps = np.diff(solution.crank_angles)
        assert np.all(steps > 0) or np.all(steps < 0)
    free = da.synthesize(path, crank_turns=False, starts=8)
    for solution in free.solutions:  # one branch, even where the crank only rocks
        assert solution.linkage.transmission(solution.crank_angles) > 0


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda: da.Target(), "points or outputs"),
        (lambda: da.Target.path([(0, 0)]), "at least two"),
        (lambda: da.Target.path([(0, 0), (1, math.nan)]), "finite"),
        (lambda: da.Target.path([(0, 0), (1, 1)], [0]), "1 entries"),
        (lambda: da.synthesize(da.Target.path([(1, 1), (1, 1)])), "points apart"),
        (lambda: da.synthesize(da.Target.path([(0, 0), (1, 1)]), bounds={"rod": (0, 1)}), "rod"),
        (lambda: da.FourBar(crank=-1, coupler=1, follower=1, ground=1), "positive"),
        (lambda: da.FourBar(crank=1, coupler=1, follower=1, ground=1).cognates(), "on a joint"),
    ],
)
def test_invalid_tasks_are_refused(ask, words):
    with pytest.raises(da.AnalysisError, match=words):
        ask()


@pytest.mark.thorough
def test_progress_covers_the_selection_of_starts():
    """Most of the time of a path with free timing is spent on it."""
    fractions: list[float] = []
    target = da.Target.path([(0, 0), (1, 0.2), (2, 0), (3, 1)])
    da.synthesize(target, starts=2, progress=fractions.append)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1 and np.max(np.diff([0, *fractions])) < 0.03
    fractions.clear()
    turn = np.linspace(0.0, 1.0, 4)
    da.synthesize(da.Target.function(turn, turn**2), starts=4, progress=fractions.append)
    assert fractions == [0.25, 0.5, 0.75, 1.0]


@pytest.mark.thorough
def test_a_failed_search_counts_the_starts_that_it_compared():
    target = da.Target.path([(0, 0), (1, 0.2), (2, 0), (3, 1)])
    with pytest.raises(da.AnalysisError, match="none of 12 starts converges to a FourBar within"):
        da.synthesize(target, starts=2, transmission=1.6)  # above a right angle
