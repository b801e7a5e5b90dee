"""Inverse problems: forces and drives come back from the motion they cause."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

KNOTS = np.linspace(0, 2, 17)
ANALYSIS = da.Dynamics(2.0, step=0.02)


def wanted(t):
    return 8 * np.sin(2.5 * t) + 4 * t


@pytest.fixture(scope="module")
def pushed():
    system = da.System("pushed")
    push = da.input_history(system, "push", KNOTS, unit="N")
    mass = system.add(planar.Particle("mass", mass=2.0, position=(0.0, 0)))
    system.add(planar.CoordinateDriver("guide", mass.center, 0.0, direction=(0, 1)))
    wall = system.ground.point(-1, 0)
    system.add(planar.Spring("s", wall, mass.center, stiffness=30.0, damping=1.0, free_length=1.0))
    system.add(planar.Force("force", mass.center, (push.value, 0.0)))
    return system.build(), push


def motion(pushed, noise=0.0, seed=0):
    model, push = pushed
    true = dict(zip(push.names, wanted(KNOTS), strict=True))
    run = ANALYSIS.run(model, true)
    x = run.values("mass.x")
    return {"time": run.time, "x": x + noise * np.random.default_rng(seed).normal(size=x.size)}


def test_a_force_is_found_from_perfect_motion(pushed):
    model, push = pushed
    inversion = da.invert(
        *(model, motion(pushed), {"x": "mass.x"}, [push]), analysis=ANALYSIS, smoothing=1e-16
    )
    assert inversion.success
    # the last knots have had no time to move the mass
    np.testing.assert_allclose(inversion.values["push"][:-2], wanted(KNOTS)[:-2], atol=2e-3)
    np.testing.assert_allclose(inversion.predicted[0].ravel(), motion(pushed)["x"], atol=1e-7)


@pytest.mark.thorough
@pytest.mark.parametrize("choice", ["likelihood", "l-curve", "cross-validation", "discrepancy"])
def test_noise_is_smoothed_about_as_well_as_can_be(pushed, choice):
    """Against the best of all smoothings, which only one who knows the truth can choose."""
    model, push = pushed
    data, level = motion(pushed, noise=2e-3), {"x": 2e-3}
    arguments = {"measures": {"x": "mass.x"}, "histories": [push], "analysis": ANALYSIS}

    def error(smoothing):
        inversion = da.invert(model, data, **arguments, noise=level, smoothing=smoothing)
        return np.sqrt(
            np.mean((inversion.values["push"][1:-2] - wanted(KNOTS)[1:-2]) ** 2)
        ), inversion

    best = min(error(mu)[0] for mu in np.logspace(-5, 2, 8))
    off, computed = error(choice)
    assert off < 4 * best and off < 0.15 * np.std(wanted(KNOTS))
    assert computed.misfit_norm == pytest.approx(np.sqrt(101), rel=0.25)
    times = np.array([0.3, 1.1])
    truth = wanted(times)
    assert abs(computed.at("push", times) - truth).max() < 0.2 * np.std(wanted(KNOTS))


def test_a_drive_is_found_from_the_path(pushed):
    """Kinematics: the angle of a crank from where its end was seen, ten samples for 12 knots."""
    system = da.System("crank")
    angle = da.input_history(system, "angle", np.linspace(0, 1, 12), 0.5, "rad")
    crank = system.add(planar.Bar("crank", length=0.5, mass=1.0, angle=0.5))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, angle.law))
    model, times = system.build(), np.linspace(0, 1, 10)
    truth = 0.5 + times**2
    data = {"t": times, "x": 0.5 * np.cos(truth), "y": 0.5 * np.sin(truth)}
    inversion = da.invert(
        *(model, data, {"x": "crank.end.x", "y": "crank.end.y"}, [angle]),
        analysis=da.Kinematics(1.0, outputs=11),
        noise={"x": 1e-4, "y": 1e-4},
        smoothing="discrepancy",
    )
    np.testing.assert_allclose(inversion.at("angle", times), truth, atol=3e-3)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"histories": []}, "nothing to find"),
        ({"smoothing": "guess"}, "unknown smoothing 'guess'"),
        ({"smoothing": -1.0}, "above zero"),
        ({"smoothing": "discrepancy"}, "needs noise"),
        ({"smoothing": "discrepancy", "noise": {"x": 1e-12}}, "times the noise"),
    ],
)
def test_invalid_arguments_are_refused(pushed, more, message):
    model, push = pushed
    arguments = {"measures": {"x": "mass.x"}, "histories": [push], "analysis": ANALYSIS} | more
    with pytest.raises(da.DalembertError, match=message):
        da.invert(model, motion(pushed, 1e-3), **arguments)
    with pytest.raises(da.ModelError, match="four knots"):
        da.input_history(da.System("few"), "f", [0, 1, 2])
