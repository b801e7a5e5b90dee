"""Names behave as keys of a mapping, and arguments without a keyword are counted."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial, structures


def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0, -9.81))
    length = system.parameter("length", 1.0, "m")
    bob = system.add(planar.Bar("bob", length=length, mass=2.0, angle=-1.5))
    system.add(planar.Revolute("O", system.ground.center, bob.start))
    system.derived("double", 2 * length)
    return system.build()


def spring() -> da.StructuralModel:
    structure = da.Structure("spring")
    end = structure.node("end", 0.0)
    structure.add(
        structures.GroundSpring("k", end, stiffness_x=structure.parameter("stiffness", 4.0))
    )
    structure.add(structures.PointMass("m", end, mass=1.0))
    structure.load(end, fx=1.0)
    return structure.build()


RESULTS = {
    "dynamics": lambda: da.solve_dynamics(pendulum(), 0.1, step=0.05),
    "equilibrium": lambda: da.solve_equilibrium(pendulum()),
    "modes": lambda: da.linearize(pendulum()),
    "statics": lambda: da.solve_statics(spring()),
    "vibration": lambda: da.solve_modes(spring(), 1),
    "transient": lambda: da.solve_transient(spring(), 0.1, step=0.05),
}


@pytest.mark.parametrize("kind", RESULTS)
def test_a_result_is_a_mapping_of_measures(kind: str) -> None:
    """What is a key can be read; what is ``in`` can be read; what is not raises a KeyError."""
    result = RESULTS[kind]()
    names = list(result)
    assert names == result.keys() and len(set(names)) == len(names) > 2
    for name in names:
        assert name in result and np.all(np.isfinite(np.asarray(result[name], dtype=float)))
    assert f"2*{names[0]}" in result
    for strange in ("nothing", "2*nothing", "a b", "", 3, None):
        assert strange not in result
    with pytest.raises(KeyError, match="nothing"):
        result["nothing"]


@pytest.mark.parametrize("model", [pendulum(), spring()], ids=["mechanism", "structure"])
def test_a_model_is_a_mapping_of_measures(model) -> None:
    assert all(name in model and model[name] is not None for name in model)
    assert "nothing" not in model and 3 not in model


def test_a_batch_holds_measures_and_designs() -> None:
    many = da.solve_dynamics(pendulum(), 0.1, step=0.05, parameters={"length": [1.0, 2.0]})
    assert "bob.angle" in many and 1 in many and 2 not in many and "nothing" not in many


def test_the_name_of_an_element_leads_to_its_measures() -> None:
    with pytest.raises(KeyError, match=r"'bob' has several measures.*bob\.angle"):
        pendulum()["bob"]


PARTS = {
    f"{module.__name__.rpartition('.')[2]}.{name}": cls
    for module in (planar, spatial, structures)
    for name, cls in vars(module).items()
    if inspect.isclass(cls) and not name.startswith("_")
}


@pytest.mark.parametrize("name", PARTS)
def test_too_many_arguments_are_counted(name: str) -> None:
    """One more argument than have an order: the message names them and one that needs a keyword."""
    wanted = inspect.signature(PARTS[name]).parameters.values()
    ordered = [p.name for p in wanted if p.kind is p.POSITIONAL_OR_KEYWORD]
    by_name = [p.name for p in wanted if p.kind is p.KEYWORD_ONLY]
    if any(p.kind is p.VAR_POSITIONAL for p in wanted):
        pytest.skip("takes any number")
    with pytest.raises(TypeError) as raised:
        PARTS[name](*["x"] * (len(ordered) + 1))
    message = str(raised.value)
    assert f"{len(ordered) + 1} argument(s) without a keyword" in message
    assert all(each in message for each in ordered)
    assert not by_name or any(f"{each}=" in message for each in by_name)


def test_a_name_serves_a_parameter_and_an_element() -> None:
    """The gradient by a parameter called like a body is that by any other name."""
    results = []
    for name in ("bob", "e", "u", "size"):
        system = da.System("pendulum", gravity=(0, -9.81))
        length = system.parameter(name, 0.5, "m")
        bob = system.add(planar.Bar("bob", length=length, mass=2.0, angle=-1.0))
        system.add(planar.Revolute("t", system.ground.center, bob.start))
        motion = da.solve_dynamics(system.build(), 0.2, step=0.02)
        measure = da.final(f"t.force_norm + 3*{name} + 0*t")
        results.append(da.sensitivity(motion, measure).item())
    assert len(set(results)) == 1


def test_reserved_names_state_their_meaning() -> None:
    system = da.System("reserved")
    for name, meaning in (("t", "the time"), ("pi", "the number π"), ("energy", "a measure")):
        for declare in (
            lambda name: system.parameter(name, 1.0),
            lambda name: system.table(name, [0, 1], [0, 1]),
            lambda name: system.derived(name, 1.0),
        ):
            with pytest.raises(da.ModelError, match=f"'{name}' is reserved.*{meaning}"):
                declare(name)
    with pytest.raises(da.ModelError, match=r"'ground' is reserved.*the body at rest"):
        system.add(planar.Bar("ground", length=1.0))


LONG = "b" * 201


@pytest.mark.parametrize(
    "declare",
    [
        lambda system: system.add(planar.Particle(LONG, mass=1.0)),
        lambda system: system.parameter(LONG, 1.0),
        lambda system: system.derived(LONG, "1"),
        lambda system: system.table(LONG, [0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0, 3.0]),
        lambda system: planar.Body("b", mass=1.0, inertia=1.0).add_point(LONG, (0, 0)),
        lambda system: da.Structure("s").node(LONG, 0.0, 0.0),
    ],
)
def test_names_have_a_limited_length(declare):
    with pytest.raises(da.ModelError, match="has 201 characters; 200 at most") as raised:
        declare(da.System("limits"))
    assert len(str(raised.value)) < 150
