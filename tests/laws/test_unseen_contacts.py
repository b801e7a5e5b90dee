"""Analyses that see no rigid contacts say where their results would need them."""

import pytest

import dalembert as da
from dalembert import planar
from dalembert.errors import UnsupportedError


def floor_of(system: da.System, kind: str, body: planar.Body) -> None:
    """A floor at ``y = 0`` for a point 0.1 m below the centre, one of two ways."""
    if kind == "constraint":
        system.add(planar.UnilateralConstraint("floor", body.y - 0.1, restitution=0.5))
    else:
        wall = planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))
        system.add(planar.Collisions("floor", [planar.contact.Circle(body, 0.1), wall]))


def hung(kind: str, peg: float) -> da.Model:
    """A weight on a spring, at rest 0.2962 m below a peg."""
    system = da.System("hung", gravity=(0.0, -9.81))
    body = system.add(planar.Body("weight", mass=1.0, inertia=1.0, position=(0.0, peg - 0.3)))
    spring = {"stiffness": 50.0, "free_length": 0.1}
    system.add(planar.Spring("spring", system.ground.point(0, peg), body.center, **spring))
    system.add(planar.UserConstraint("beside", body.x))
    system.add(planar.UserConstraint("upright", body.angle))
    floor_of(system, kind, body)
    return system.build()


def pressed(kind: str, height: float) -> da.Model:
    """A press that is driven down 0.1 m from a height of its lower side."""
    system = da.System("press", gravity=(0.0, -9.81))
    body = system.add(planar.Body("press", mass=1.0, inertia=1.0, position=(0, 0.1 + height)))
    system.add(planar.UserConstraint("beside", body.x))
    system.add(planar.UserConstraint("upright", body.angle))
    system.add(planar.CoordinateDriver("ram", body.center, 0.1 + height - 0.1 * da.t, (0, 1)))
    floor_of(system, kind, body)
    return system.build()


def rest(model: da.Model) -> list[str]:
    return da.solve_equilibrium(model).warnings


def modes(model: da.Model) -> list[str]:
    return list(da.linearize(model).warnings)


def moved(model: da.Model) -> list[str]:
    return da.solve_kinematics(model, 1.0, step=0.1).warnings


def efforts(model: da.Model) -> list[str]:
    return da.solve_inverse_dynamics(model, 1.0, step=0.1).warnings


SEEING = {"constraint": "solve_dynamics", "collisions": "solve_nonsmooth"}
CASES = [(rest, hung, 0.2, 1.0), (modes, hung, 0.2, 1.0)]
CASES += [(moved, pressed, 0.05, 1.0), (efforts, pressed, 0.05, 1.0)]


@pytest.mark.few(3)
@pytest.mark.parametrize("kind", SEEING)
@pytest.mark.parametrize(("analysis", "mechanism", "low", "high"), CASES)
def test_a_gap_that_is_negative_is_told_and_an_open_one_is_not(
    analysis, mechanism, low, high, kind
):
    messages = [text for text in analysis(mechanism(kind, low)) if "floor" in text]
    assert len(messages) == 1 and "the gap of floor is -" in messages[0]
    assert messages[0].endswith(f"this analysis ignores rigid contacts; use {SEEING[kind]}")
    assert analysis(mechanism(kind, high)) == []


@pytest.mark.parametrize("kind", SEEING)
def test_a_closed_gap_counts_where_its_force_would(kind):
    """The lower side comes to the floor at the end: positions are right, efforts unknown."""
    model = pressed(kind, 0.1)
    assert moved(model) == []
    assert "the gap of floor is closed at t = 1 s" in efforts(model)[0]


def test_modes_beside_a_contact_in_a_motion():
    """About a weight that lies on the floor; in joint coordinates likewise."""
    system = da.System("lying", gravity=(0.0, -9.81))
    body = system.add(planar.Body("weight", mass=1.0, inertia=1.0, position=(0.0, 0.1), angle=0.0))
    floor_of(system, "constraint", body)
    motion = da.solve_dynamics(system.build(), 0.1, step=0.01)
    for coordinates in (da.AbsoluteCoordinates(), da.JointCoordinates()):
        modes = da.linearize(motion.model, motion, coordinates=coordinates)
        assert any("the gap of floor is closed" in text for text in modes.warnings)


def test_steppers_refuse_many_gaps():
    with pytest.raises(UnsupportedError, match="floor: gaps among many shapes"):
        da.Stepper(hung("collisions", 1.0), step=1e-3)
