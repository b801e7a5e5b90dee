"""Arguments of a wrong kind, size or number: one error that names the entity."""

from __future__ import annotations

import pytest

import dalembert as da
from dalembert import planar, spatial

HUGE = 10**400


def spring(**options) -> da.Model:
    system = da.System("spring")
    end = system.add(planar.Particle("end", mass=1.0, position=(1, 0)))
    system.add(planar.Spring("s", system.ground.center, end.center, **options))
    return system.build()


def body(**options) -> planar.Body:
    return planar.Body("b", **{"mass": 1.0, "inertia": 1.0} | options)


def solid(**options) -> spatial.Body:
    return spatial.Body("b", **{"mass": 1.0, "inertia": (1.0, 1.0, 1.0)} | options)


def node(*place: object) -> object:
    return da.Structure("s").node("a", *place)


CASES = {
    "mass that no float holds": (lambda: body(mass=HUGE), "b.mass.*1e400.*finite"),
    "parameter that no float holds": (lambda: da.System("x").parameter("a", HUGE), "a: .*1e400"),
    "bound that no float holds": (
        lambda: da.System("x").parameter("a", 1.0, bounds=(0, HUGE)),
        "a: .*1e400",
    ),
    "place that no float holds": (lambda: node(HUGE, 0.0), "1e400"),
    "number of more digits than Python shows": (lambda: body(mass=10**5000), "1e5000"),
    "no stiffness": (lambda: spring(stiffness=None), "s.stiffness: is None.*leave it out"),
    "stiffness in words": (lambda: spring(stiffness="abc"), "s.stiffness: expected a number"),
    "inertia in words": (lambda: body(inertia="abc"), "b.inertia: expected a number"),
    "spatial inertia in words": (lambda: solid(inertia="abc"), "b.inertia: give .Ixx"),
    "points that have no names": (lambda: body(points=3), "b.points: expected a mapping"),
    "frames that have no names": (lambda: solid(frames=[1]), "b.frames: expected a mapping"),
    "gravity of lists": (lambda: da.System("x", gravity=(0, [1], 0)), "gravity.*2 or 3 numbers"),
    "gravity that no float holds": (lambda: da.System("x", gravity=(0, HUGE)), "gravity.*1e400"),
    "law without arguments": (lambda: spring(law=lambda: 1.0), "s.law: must take two arguments"),
    "law of one argument": (lambda: spring(law=lambda x: x), "s.law: must take two arguments"),
    "law of three": (lambda: spring(law=lambda x, v, t: x), "s.law: must take two arguments"),
    "law that fails": (lambda: spring(law=lambda x, v: 1 / 0), "s.law: .*ZeroDivisionError"),
    "law that returns nothing": (lambda: spring(law=lambda x, v: None), "s.law: expected a number"),
    "law that is a number": (lambda: spring(law=3), "s.law: expected a function"),
}


@pytest.mark.parametrize("name", CASES)
def test_wrong_arguments_are_named(name):
    act, words = CASES[name]
    with pytest.raises(da.ModelError, match=words) as caught:
        act()
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"max_iterations": 10**12}, r"max_iterations = 1000000000000 .*1e\+12 rounds"),
        ({"max_iterations": HUGE}, "max_iterations = 1e400: give a whole number"),
        ({"max_iterations": -1}, "max_iterations = -1: give a whole number"),
        ({"max_iterations": 2.5}, "max_iterations = 2.5: give a whole number"),
        ({"tolerance": -1.0}, "tolerance = -1.0: give a number above 0"),
        ({"tolerance": float("nan")}, "tolerance = nan: give a number above 0"),
    ],
)
def test_searches_that_could_not_end_are_refused(options, words):
    structure = da.Structure("spring")
    k = structure.parameter("k", 50.0, bounds=(1, 1e3))
    end = structure.node("end", 0)
    structure.add(da.structures.GroundSpring("spring", end, stiffness_x=k))
    structure.load(end, fx=100.0)
    with pytest.raises((da.UnsupportedError, da.BudgetError), match=words):
        da.optimize(structure.build(), da.final("k"), analysis=da.Statics(), **options)


def test_messages_stay_short_whatever_they_quote():
    text = "x" * 10**6
    for act in (
        lambda: body(mass=text),
        lambda: da.System(text + "\0"),
        lambda: spring(stiffness=1.0)[text],
        lambda: da.System("x").parameter("a", 1.0, unit=text),
        lambda: da.final(text, name="\0").label,
    ):
        with pytest.raises(da.DalembertError) as caught:
            act()
        assert 20 < len(str(caught.value)) < 3000


def test_methods_of_systems_are_not_set() -> None:
    """``system.gravity = (0, -9.81)`` would leave the system without gravity."""
    with pytest.raises(da.ModelError, match=r"gravity is a method: call gravity\(…\)"):
        da.System("pendulum").gravity = (0, -9.81)  # type: ignore[method-assign]


def test_shapes_without_a_size_are_named() -> None:
    body, kit = da.planar.Body("disc", mass=1.0, inertia=0.1), da.planar.contact
    with pytest.raises(da.ModelError, match=r"Circle\.radius: is None; give a number$"):
        kit.Circle(body, None)
    with pytest.raises(da.ModelError, match=r"HalfPlane\.normal: is None; .*, or leave"):
        kit.HalfPlane(body, normal=None)


def test_times_of_results_and_steppers_that_are_texts() -> None:
    system = da.System("crate", gravity=(0, -10))
    crate = system.add(planar.Body("crate", mass=2.0, inertia=0.1, position=(0, 0.1)))
    still = system.build()
    shapes = [planar.contact.Rectangle(crate, (0.4, 0.2)), planar.contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=0.01)
    for act, message in (
        (lambda: motion.contact_forces("x"), "time is 'x'; give a number from 0 to 0.1 s"),
        (lambda: motion.draw("x"), "time is 'x'; give a number of seconds"),
        (lambda: motion.animate(fps="x"), "fps is 'x'; give a positive number"),
        (lambda: da.Stepper(still, step="x"), "step is 'x'; give a positive number of seconds"),
    ):
        with pytest.raises(da.AnalysisError, match=message):
            act()
