"""Nothing depends on units: a mechanism in nanometres is built like one in kilometres."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from registry import CASES
from spatial_registry import SPATIAL_CASES, any_model_of
from units import Units, in_other_units

import dalembert as da
from dalembert import planar

OTHERS = [
    Units(length=1e-9),
    Units(length=1e9),
    Units(mass=1e-9, time=1e9),
    Units(length=1e-9, mass=1e9, time=1e-9),
]
PAIRS = [
    pytest.param(name, units, marks=() if k % 4 == n else (pytest.mark.thorough,))
    for k, name in enumerate([*CASES, *SPATIAL_CASES])
    for n, units in enumerate(OTHERS)
]
"""Every model in one other system of units; ``pytest -m thorough`` takes all systems."""
LENGTHS = [1e-11, 1e-9, 1e-3, 1.0, 1e3, 1e9]


@functools.cache
def converted(name: str, units: Units) -> da.Model:
    """The model of a case in other units."""
    return in_other_units(any_model_of(name).parts, units).build()


def facts(model: da.Model) -> dict:
    """All that the diagnosis says without a unit."""
    document = model.diagnosis.to_dict()
    tables = set(document.pop("element_warnings"))  # with numbers that have units
    levels = [
        (m["level"], m["text"].partition(":")[0])
        for m in document.pop("messages")
        if m["text"] not in tables
    ]
    for name in ("corrections", "velocity_corrections"):
        document[name] = sorted(document[name])
    return document | {"messages": levels, "rows": model.closure.rows, "held": held(model)}


def held(model: da.Model) -> list:
    recipe = model.closure.recipe
    return [recipe.positions.indices, recipe.speeds.indices, recipe.projected]


@pytest.mark.few(8)
@pytest.mark.parametrize(("name", "units"), PAIRS)
def test_start_and_diagnosis_change_with_the_units_only(name, units):
    one, other = any_model_of(name), converted(name, units)
    assert facts(other) == facts(one)
    sizes = np.array([units(unit) for unit in one.guesses.units])
    scale = one.scales.coordinates
    np.testing.assert_allclose(other.start.y / sizes / scale, one.start.y / scale, atol=1e-11)
    rates = np.array([units.of_rates(unit) for unit in one.guesses.speed_units])
    scale = one.scales.displacements
    fast = np.abs(one.start.v / scale).max(initial=0.0) or 1.0
    np.testing.assert_allclose(
        other.start.v / rates / scale, one.start.v / scale, atol=1e-11 * fast
    )


@pytest.mark.few(9)
@pytest.mark.parametrize(("name", "units"), PAIRS)
def test_forces_change_with_the_units_only(name, units):
    one, other = any_model_of(name), converted(name, units)

    def forces(model, time):
        e = model.all_equations
        f = ca.Function("f", [e.t, e.y, e.v, e.p], [e.force])
        start = model.start
        return f(time, start.y, start.v, model.nominal).full().ravel()

    owners = [c.speed_units for c in one.coordinates]
    factors = [units("N" if unit == "m" else "N m") for own in owners for unit in own]
    computed, wanted = forces(other, 0.3 * units.time) / factors, forces(one, 0.3)
    np.testing.assert_allclose(computed, wanted, atol=1e-9 * (1 + np.abs(wanted).max(initial=0)))


def triangle(size: float, longest: float) -> da.System:
    """Three bars pinned to each other: sides 1, 1 and ``longest``, times the size."""
    system = da.System("triangle")
    sides = [1.0, 1.0, longest]
    bars = [
        system.add(planar.Bar(f"b{k}", length=size * side, mass=1.0, angle=2.0 * k))
        for k, side in enumerate(sides)
    ]
    system.add(planar.Revolute("A", bars[0].end, bars[1].start))
    system.add(planar.Revolute("B", bars[1].end, bars[2].start))
    system.add(planar.Revolute("C", bars[2].end, bars[0].start))
    return system


@pytest.mark.parametrize("size", LENGTHS)
def test_a_possible_triangle_closes_at_any_size(size):
    model = triangle(size, 1.9).build()
    assert model.start.residual < 1e-11 * size
    assert model.diagnosis.degrees_of_freedom == 3 and not model.diagnosis.massless


@pytest.mark.few(1)
@pytest.mark.parametrize("size", LENGTHS)
def test_an_impossible_triangle_is_refused_at_any_size(size):
    with pytest.raises(da.AssemblyError):
        triangle(size, 2.1).build()


@pytest.mark.parametrize("size", LENGTHS)
def test_a_body_without_mass_is_found_at_any_size(size):
    system = triangle(size, 1.5)
    system.elements["b1"].mass = system.elements["b1"].inertia = system.elements["b0"].mass * 0
    loose = system.add(planar.Body("loose", points={"P": (size, 0.0)}))
    system.add(planar.Revolute("D", system.elements["b0"].end, loose.point("P")))
    assert system.build().diagnosis.massless == ("loose",)
