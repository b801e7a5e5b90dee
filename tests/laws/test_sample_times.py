"""How responses depend on the times of their samples: what moves when a run ends at an event."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.responses.integrals import Quadrature


@pytest.mark.parametrize("count", [1, 2, 3, 4, 9])
@pytest.mark.parametrize("kind", [da.Integral, da.Mean, da.RMS, da.Final, da.Maximum])
def test_times_of_samples(kind, count):
    """``∂R/∂t_k`` against differences, and the sum of all is zero but for what a shift adds."""
    rng = np.random.default_rng(count)
    times, samples = np.cumsum(0.2 + rng.random(count)), rng.standard_normal(count)
    response = kind("m")

    def change(k, h):
        ahead, behind = (times + s * h * np.eye(count)[k] for s in (1, -1))
        return (response.reduce(ahead, samples) - response.reduce(behind, samples)) / (2 * h)

    expected = [(4 * change(k, 5e-4) - change(k, 1e-3)) / 3 for k in range(count)]
    computed = response.time_weights(times, samples)
    np.testing.assert_allclose(computed, expected, atol=1e-9 * (1 + np.abs(samples).max()))
    assert computed.sum() == pytest.approx(0, abs=1e-12)  # a shift of all times changes nothing


@pytest.mark.parametrize("last", [0.6, 1e-5, 1e-14, -1e-5])
def test_quadrature_of_a_parabola_is_exact(last):
    """Also where the last interval is nearly nothing, and when it turns its sign in a replay."""
    times = np.array([0.0, 0.1, 0.35, 0.4])
    times = np.append(times, 0.4 + last)
    quadrature = Quadrature.over(times)
    assert quadrature.weights @ times**2 == pytest.approx(times[-1] ** 3 / 3, rel=1e-13)
    assert np.abs(quadrature.weights).max() < 1.5
    moved = quadrature.time_weights(times**2)  # m = t² moves with its time by 2 t
    assert (moved + 2 * times * quadrature.weights)[-1] == pytest.approx(times[-1] ** 2, rel=1e-12)


def driven(redundant: bool = False) -> da.Model:
    """A crank that turns a rocker more than once; or three cranks of which one is too many."""
    system = da.System("driven", gravity=(0.0, -9.81))
    length, turn = system.parameter("length", 0.4, "m"), system.parameter("turn", 6.0)
    bases, rocker = ((0, 1, 0.5), 0.4) if redundant else ((0, 1), 0.75)
    coupler = system.add(planar.Bar("coupler", length=1.0 if redundant else 0.9, mass=1.0))
    for k, (base, point) in enumerate(
        zip(bases, (coupler.start, coupler.end, coupler.center), strict=False)
    ):
        size = length if redundant or k == 0 else rocker
        angle = 0.5 if redundant or k == 0 else 1.2
        bar = system.add(planar.Bar(f"bar{k}", length=size, mass=1.0, angle=angle))
        system.add(planar.Revolute(f"foot{k}", system.ground.point(base, 0), bar.start))
        system.add(planar.Revolute(f"head{k}", bar.end, point))
        if k == 0:
            law = 0.5 + (0.2 if redundant else turn) * da.t
            system.add(planar.RotationalDriver("motor", system.ground, bar, law))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("solve", [da.solve_kinematics, da.solve_inverse_dynamics])
def test_instants_between_few_outputs_of_a_driven_motion(solve):
    """They are reached from all positions of the run, not from far away on another branch."""
    few, many = solve(driven(), 2.0, outputs=3), solve(driven(), 2.0)
    times = np.linspace(0, 2, 101)
    for measure in ("bar1.angle", "bar1.angular_velocity"):
        np.testing.assert_allclose(few.at(times)[measure], many.at(times)[measure], atol=1e-9)
    event = da.Event("bar1.angle - 1.5", direction=1)
    responses = [da.event_time(event), da.at_event(event, "bar0.angle", 2), da.at(1.23, "bar1.vy")]
    expected = da.sensitivity(many, responses)
    for method in ("direct", "adjoint", "finite-difference"):
        gradient = da.sensitivity(few, responses, method=method)
        np.testing.assert_allclose(gradient, expected, rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(gradient.response_value, expected.response_value, rtol=1e-9)


def test_instants_of_a_driven_mechanism_with_a_redundant_bar():
    motion = da.solve_inverse_dynamics(driven(redundant=True), 0.5, step=0.05)
    responses = [da.at(0.22, "motor.effort"), da.at(0.2, "motor.effort", name="output")]
    gradient = da.sensitivity(motion, responses, "length")
    assert gradient.response_value[1] == pytest.approx(float(motion["motor.effort"][4]), rel=1e-12)
    check = da.sensitivity(motion, responses, "length", method="finite-difference")
    np.testing.assert_allclose(gradient, check, rtol=1e-8)


@pytest.mark.thorough
@pytest.mark.parametrize(("turn", "few"), [(2.0, 90), (6.0, 160), (300.0, 2000)])
def test_few_outputs_of_a_driven_motion_take_as_many_steps_as_the_way_asks_for(turn, few):
    """A tenth of a radian a step; those asked for are the same as among a thousand."""
    outputs, parameters = np.linspace(0, 2, 14), {"turn": turn}
    seldom = da.solve_kinematics(driven(), 2.0, outputs=outputs, parameters=parameters)
    often = da.solve_kinematics(driven(), 2.0, outputs=outputs, step=0.002, parameters=parameters)
    assert seldom.statistics["steps"] < few and often.statistics["steps"] >= 1000
    for name in ("y", "v", "a"):
        expected = getattr(often.trajectory, name)
        np.testing.assert_allclose(
            getattr(seldom.trajectory, name), expected, atol=1e-9 * (1 + np.abs(expected).max())
        )


WRONG_TIMES = [[0.2, 9.0, 0.1], [0.1, float("nan"), 0.2], [-1.0], [], [[0.1, 0.2]], "x", None, [1j]]


@pytest.mark.parametrize("solve", [da.solve_dynamics, da.solve_nonsmooth, da.solve_kinematics])
def test_samples_lie_within_the_run(solve):
    """Times in any order, each checked; wrong ones are one clear error of every analysis."""
    system = da.System("crank", gravity=(0.0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.5, mass=1.0))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    if solve is da.solve_kinematics:
        system.add(planar.RotationalDriver("motor", system.ground, crank, 3 * da.t))
    else:
        system.add(planar.UnilateralConstraint("floor", crank.end.y + 2.0, restitution=0.0))
    motion = solve(system.build(), 0.5, step=0.1)
    backwards = motion.at([0.35, 0.15])["crank.angle"].values
    assert backwards[::-1] == pytest.approx(motion.at([0.15, 0.35])["crank.angle"].values, abs=0)
    for wrong in WRONG_TIMES:
        with pytest.raises(da.AnalysisError, match=r"leave the run|outside the run|times are"):
            motion.at(wrong)
    with pytest.raises(da.AnalysisError, match="speed is 0"):
        motion.animate(speed=0)


@pytest.mark.parametrize("wrong", [0.7, 2, -3, [], "x", None, float("nan")])
def test_load_cases_are_whole_numbers(wrong):
    bar = da.Structure("bar")
    ends = bar.node("a", 0.0, 0.0), bar.node("b", 1.0, 0.0)
    bar.add(structures.Truss("ab", *ends, area=1e-4, modulus=2e11))
    bar.support(ends[0])
    bar.support(ends[1], uy=0)
    bar.load(ends[1], fx=1.0, case="one")
    bar.load(ends[1], fx=2.0, case="two")
    result = da.solve_statics(bar.build())
    assert result.at(-1)["b.ux"] == pytest.approx(2 * result.at(0)["b.ux"])
    with pytest.raises(da.AnalysisError, match="do not exist"):
        result.at(wrong)
