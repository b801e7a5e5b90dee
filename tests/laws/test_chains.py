"""Laws of six-bars, five-bars, swinging followers: what a mechanism does is found again."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da

SLIDER = da.SliderCrank(crank=0.4, coupler=1.3, offset=0.2, u=0.5, v=0.3, x=1.0, angle=0.3)
TURN = np.linspace(0, 2 * math.pi, 25)[:-1]

SIX_BARS = {
    "watt I": (
        {"B": (0, 0), "F": (4, 0), "A": (1, 0.5), "D": (4.5, 3)}
        | {"C": (1.5, 0.2), "E": (4, 5), "G": (5.5, 3)},
        "outer",
    ),
    "watt II": (
        {"B": (0, 0), "A": (4, 0), "C": (8, 0), "F": (1, 0.5)}
        | {"D": (4.5, 3), "E": (6.5, 2.2), "G": (9, 3)},
        "upper",
    ),
    "stephenson I": (
        {"A": (0, 0), "D": (4, 0), "B": (1, 0.3), "E": (4.3, 3)}
        | {"C": (0.8, -0.5), "F": (6, 2.5), "G": (4.5, -1.5)},
        "outer",
    ),
    "stephenson II": (
        {"G": (0, 0), "F": (5, 0), "C": (0.8, 0.2), "A": (2, 2)}
        | {"B": (3, 0.8), "D": (4.2, 2.5), "E": (5, 1.5)},
        "second",
    ),
    "stephenson III": (
        {"A": (0, 0), "B": (3, 0), "C": (5.5, 0), "D": (0.6, 0.2)}
        | {"E": (3.2, 2.5), "F": (2, 3), "G": (6, 4.5)},
        "upper",
    ),
}


def six_bar(kind: str) -> tuple[da.Model, str]:
    joints, link = SIX_BARS[kind]
    at = joints[da.INVERSIONS[kind].chain[link][1]]
    return da.six_bar(kind, joints, {link: {"P": at}}, reach=0.4).build(), f"{link}.P"


def far_from(model: da.Model, point: str) -> tuple[np.ndarray, np.ndarray]:
    """A path of the same six-bar with other dimensions, and its angles."""
    rng = np.random.default_rng(3)
    other = {n: p.value + 0.1 * rng.uniform(-1, 1) for n, p in model.parameters.items()}
    run = da.solve_kinematics(model, 2 * math.pi, outputs=13, parameters=other)
    assert run.status.success
    xy = np.array([run.values(f"{point}.{axis}") for axis in "xy"]).T
    return xy[:-1], run.time[:-1]


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", SIX_BARS)
def test_path_of_a_six_bar_is_found(kind):
    model, point = six_bar(kind)
    assert model.diagnosis.summary.startswith("1 degree of freedom")
    xy, angles = far_from(model, point)
    synthesis = da.synthesize_mechanism(da.Target.path(xy, angles), model, point=point, starts=1)
    assert synthesis.best.error < 1e-8
    assert synthesis.best.motion.status.success


def test_five_inversions_are_all_there_are():
    """Every link of both chains once at rest: two of Watt's, three of Stephenson's differ."""
    from dalembert.design.synthesis.chains import STEPHENSON, WATT

    def kind_of(chain, ground: str) -> tuple:
        """Joints of the links beside the one at rest, and its own."""
        beside = sorted(
            len(own) for link, own in chain.items() if link != ground and {*own} & {*chain[ground]}
        )
        return len(chain[ground]), tuple(beside)

    messages = {kind_of(i.chain, i.ground) for i in da.INVERSIONS.values() if i.chain is STEPHENSON}
    assert messages == {kind_of(STEPHENSON, link) for link in STEPHENSON} and len(messages) == 3
    messages = {kind_of(i.chain, i.ground) for i in da.INVERSIONS.values() if i.chain is WATT}
    assert messages == {kind_of(WATT, link) for link in WATT} and len(messages) == 2


@pytest.mark.parametrize("ratio", [-2.0, 1.0])
def test_geared_five_bar(ratio):
    joints = {"O1": (0, 0), "O2": (3, 0), "A": (0.5, 0.5), "B": (3.6, 0.8), "C": (2, 3.5)}
    model = da.geared_five_bar(joints, ratio, {"left": {"P": (2, 3.5)}}, reach=0.3).build()
    run = da.solve_kinematics(model, 2 * math.pi, outputs=25)
    assert run.status.success
    np.testing.assert_allclose(run.values("gear.angle"), ratio * run.time, atol=1e-9)
    xy, angles = far_from(model, "left.P")
    synthesis = da.synthesize_mechanism(da.Target.path(xy, angles), model, point="left.P", starts=1)
    assert synthesis.best.error < 1e-8


def test_functions_and_poses_of_a_six_bar():
    model, _ = six_bar("watt II")
    rng = np.random.default_rng(5)
    other = {n: p.value + 0.05 * rng.uniform(-1, 1) for n, p in model.parameters.items()}
    run = da.solve_kinematics(model, 2 * math.pi, outputs=13, parameters=other)
    angles, outputs = run.time[2:9], run.values("outer.angle")[2:9]
    function = da.Target.function(angles, outputs + 0.4)
    synthesis = da.synthesize_mechanism(function, model, output="outer.angle", starts=1)
    assert synthesis.best.error < 1e-10
    xy = np.array([run.values(f"upper.P.{axis}") for axis in "xy"]).T[2:9]
    poses = da.Target.motion(xy, run.values("upper.angle")[2:9], angles)
    synthesis = da.synthesize_mechanism(poses, model, point="upper.P", body="upper", starts=1)
    assert synthesis.best.error < 1e-10


def test_a_mechanism_of_ones_own_with_free_timing():
    """A slider–crank built by hand: its parameters need not be joints."""
    model = SLIDER.system().build()
    vary = ["crank_length", "coupler_length", "offset_length", "point_u", "point_v"]
    bounds = {n: (model.parameters[n].value - 0.1, model.parameters[n].value + 0.1) for n in vary}
    xy, _ = SLIDER.scaled(1.0).path(TURN), None
    begun = {n: p.value * 1.05 for n, p in model.parameters.items() if n in vary}
    other = da.SliderCrank(
        crank=begun["crank_length"],
        coupler=begun["coupler_length"],
        offset=begun["offset_length"],
        u=begun["point_u"],
        v=begun["point_v"],
        x=1.0,
        angle=0.3,
    )
    synthesis = da.synthesize_mechanism(
        da.Target.path(xy, closed=True),
        other.system().build(),
        point="coupler.P",
        vary=vary,
        bounds=bounds,
        starts=1,
    )
    assert synthesis.best.error < 1e-10


def test_questions_about_mechanisms_that_cannot_be_answered():
    model, _ = six_bar("watt II")
    path = da.Target.path([(0, 0), (1, 1)])
    with pytest.raises(da.AnalysisError, match="point="):
        da.synthesize_mechanism(path, model)
    with pytest.raises(da.AnalysisError, match="two finite bounds"):
        da.synthesize_mechanism(path, SLIDER.system().build(), point="coupler.P", vary=["point_u"])
    with pytest.raises(da.ModelError, match="unknown six-bar"):
        da.six_bar("watt III", {})
    with pytest.raises(da.ModelError, match="the joint 'G' has no position"):
        da.six_bar("watt I", dict.fromkeys("ABCDEF", (0, 1)))
    with pytest.raises(da.AnalysisError, match="synthesize_mechanism"):
        da.synthesize(path, model)
