"""What is told about gradients that do not exist, are one-sided, or do not matter."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar


def swinging(angle: float = 0.0, duration: float = 2.0) -> da.Motion:
    """A driven bar: φ = angle + sin(π t) / swing, with a mass that only forces notice."""
    system = da.System("swinging bar", gravity=(0.0, -9.81))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, 1.0))
    mass = system.parameter("mass", 2.0, "kg", bounds=(2.0, 3.0))
    swing = system.parameter("swing", 2.0)
    shift = system.parameter("shift", angle, "rad")
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=angle))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    law = da.Formula(shift + da.sin(math.pi * da.t) / swing)
    system.add(planar.RotationalDriver("motor", system.ground, bar, law=law))
    return da.solve_kinematics(system.build(), duration, step=0.05)


def four_bar(**choices) -> da.Motion:
    """A parallelogram of two equal bars, flat where the crank lies along the ground."""
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1 = system.parameter("l1", 0.3, "m")
    crank = system.add(planar.Bar("crank", length=l1, mass=1.0, angle=1.2, angular_velocity=3.0))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=2.0, angle=0.0))
    rocker = system.add(planar.Bar("rocker", length=0.3, mass=1.0, angle=1.2))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return da.solve_dynamics(system.build(), step=0.005, **choices)


def notes(motion, *responses, **options) -> list[str]:
    return da.sensitivity(motion, responses, **options).attrs["notes"]


def having(notes: list[str], text: str) -> list[str]:
    return [note for note in notes if text in note]


def test_nothing_to_tell():
    motion = swinging(duration=1.8)
    assert notes(motion, da.final("bar.end.y"), wrt=["shift", "swing"]) == []


def test_parameters_without_influence():
    messages = notes(swinging(0.3), da.final("bar.end.y"), da.mean("bar.end.x"))
    assert having(
        messages, "mass: no influence on final(bar.end.y), mean(bar.end.x) (exactly zero)"
    )
    messages = notes(swinging(0.3), da.final("bar.end.y"), da.mean("bar.angle"))
    assert having(messages, "mass: no influence on final(bar.end.y) (exactly zero)")
    assert having(messages, "length, mass: no influence on mean(bar.angle) (exactly zero)")


def test_negligible_influence():
    """Over a whole period the amplitude of a sine leaves no trace in its mean but round-off."""
    messages = notes(swinging(0.3), da.mean("bar.angle", name="angle"), wrt=["swing", "shift"])
    assert messages == ["swing: negligible influence on angle (of the size of round-off)"]


def test_parameters_at_their_bounds():
    messages = notes(swinging(), da.final("bar.end.y"))
    assert having(messages, "length = 1 is at its upper bound 1")
    assert having(messages, "mass = 2 is at its lower bound 2")
    model = swinging().model
    outside = da.Kinematics(1.0, step=0.1).run(model, {"length": 1.2})
    assert having(notes(outside, da.final("bar.end.y")), "length = 1.2 is beyond its upper bound 1")


def test_ties_are_one_sided():
    """|φ| is largest at two instants, which an offset moves in opposite directions."""
    motion = swinging()
    height = da.absolute(motion.model["bar.angle"])
    messages = notes(motion, da.maximum(height, name="peak"))
    assert (
        "peak: 2 samples share the largest value (first at t = 0.5 s, last at t = 1.5 s)"
        in messages[0]
    )
    assert "smooth" in messages[0]
    assert not having(notes(motion, da.maximum(height, smooth=0.02)), "share")
    assert not having(notes(motion, da.maximum("bar.angle")), "share")
    lowest = notes(motion, da.minimum(-1.0 * height, name="low"))
    assert having(lowest, "low: 2 samples share the smallest value")


def test_ties_that_change_alike_are_none():
    """A constant, and a periodic measure: all samples have the same gradient."""
    motion = swinging(duration=4.0)
    constant = motion.model["length"] * 1.0
    messages = notes(motion, da.maximum(constant, name="c"), da.maximum("bar.angle", name="p"))
    assert not having(messages, "share")


def test_root_mean_square_of_zero():
    motion = swinging(0.0, 2.0)
    model = motion.model
    zero = model["bar.angle"] - model["bar.angle"]
    assert da.sensitivity(motion, da.rms(zero, name="none")).values.tolist() == [[0.0] * 4]
    off = (model["length"] - 1.0) * da.cos(model["bar.angle"])
    with pytest.raises(da.AnalysisError, match=r"response off is zero.*root mean square.*use int"):
        da.sensitivity(motion, da.rms(off, name="off"))
    squares = da.sensitivity(motion, da.mean(off * off, name="off"))
    assert squares.values.tolist() == [[0.0] * 4]


def test_derivatives_that_are_infinite():
    motion = swinging(0.0, 2.0)
    root = da.sqrt(motion.model["length"] - 1.0)
    with pytest.raises(da.AnalysisError, match=r"derivative of root by length is.*as a root has"):
        da.sensitivity(motion, da.final(root, name="root"))


def test_no_parameters():
    system = da.System("bare")
    system.add(planar.Particle("p", mass=1.0))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.1)
    with pytest.raises(da.AnalysisError, match="bare has no parameters to differentiate by"):
        da.sensitivity(motion, da.final("p.x"))


@pytest.mark.thorough
def test_switches_between_independent_speeds():
    motion = four_bar(duration=1.5, formulation=da.VelocityPartitioning(limit=1.5))
    changes = motion.statistics["variant changes"]
    computed = having(notes(motion, da.final("crank.angle")), "independent speeds")
    assert len(computed) == 1
    assert f"{changes} time(s)" in computed[0]
    assert not having(notes(four_bar(duration=0.1), da.final("crank.angle")), "independent")


def test_singular_positions_near_by():
    """A parallelogram is flat twice per turn."""
    motion = four_bar(duration=1.0, formulation=da.AugmentedLagrangian())
    angle = np.unwrap(motion["crank.angle"].values)
    assert angle.min() < math.pi < angle.max()  # passed the flat position
    result = having(notes(motion, da.final("crank.angle")), "singular position")
    assert len(result) == 1
    computed = float(result[0].removeprefix("near t = ").split()[0])
    assert abs(np.sin(np.interp(computed, motion.time, angle))) < 0.1


def test_unstable_equilibria():
    system = da.System("inverted", gravity=(0.0, -9.81))
    length = system.parameter("length", 1.0, "m")
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angle=math.pi / 2))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    rest = da.solve_equilibrium(system.build())
    assert having(notes(rest, da.final("pin.force_norm")), "not stable")


@pytest.mark.parametrize("response", [da.final("pin.force.y"), da.mean("sqrt(-1 - t)")])
@pytest.mark.parametrize("method", ["direct", "adjoint", "finite-difference"])
def test_responses_that_are_not_a_number(response, method):
    """Kinematics knows no forces: their gradients would be those of numbers nobody was given."""
    with pytest.raises(da.AnalysisError, match=r"response .* is nan in this run"):
        da.sensitivity(swinging(0.3), response, method=method)
    with pytest.raises(da.AnalysisError, match=r"response .* is nan in this run"):
        da.hessian_product(swinging(0.3), response, {"length": 1.0})


@pytest.mark.parametrize(
    ("responses", "options", "words"),
    [
        ([], {}, "no response is given"),
        (["bar.angle"], {}, "'bar.angle' is not a response"),
        (da.final("bar.angel"), {}, r"response final\(bar.angel\): no measure 'bar.angel'"),
        (da.final("bar.angle"), {"wrt": []}, "no parameter is chosen; choose some of length"),
        (da.final("bar.angle"), {"wrt": "lenght"}, "unknown parameter 'lenght'"),
        (da.final("bar.angle"), {"method": da.Adjoint}, "method is .*give a name or an object"),
        (da.at(2.1, "bar.angle"), {}, "t = 2.1 s is outside the run 0…2 s"),
    ],
)
def test_wrong_requests(responses, options, words):
    with pytest.raises(da.AnalysisError, match=words):
        da.sensitivity(swinging(0.3), responses, **options)


def test_parameters_count_once():
    motion, response = swinging(0.3), da.final("bar.end.y")
    once = da.sensitivity(motion, response, "length")
    twice = da.sensitivity(motion, response, ["length", "length"], method="finite-difference")
    assert twice.shape == once.shape == (1, 1)


def test_an_equilibrium_has_one_instant():
    system = da.System("hanging", gravity=(0.0, -9.81))
    bar = system.add(planar.Bar("bar", length=system.parameter("l", 1.0), mass=1.0, angle=-1.0))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    rest = da.solve_equilibrium(system.build())
    here = da.sensitivity(rest, da.at(0.0, "bar.end.y"))
    assert here.values == da.sensitivity(rest, da.final("bar.end.y")).values
    with pytest.raises(da.AnalysisError, match="one instant, t = 0 s, and t = 1 s was requested"):
        da.sensitivity(rest, da.at(1.0, "bar.end.y"))


@pytest.mark.parametrize("time", [math.nan, math.inf])
def test_an_instant_that_is_no_number_is_refused_where_it_is_given(time):
    with pytest.raises(da.UnsupportedError, match=rf"^At\(time={time}\): time must be a number"):
        da.at(time, "bar.angle")
