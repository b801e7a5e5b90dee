"""Changes of temperature: what holds for every kind of element that feels them."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from cell_meshes import places_of
from thorough import crossed, sampled

import dalembert as da
from dalembert.elements.fem.cells import CELLS
from dalembert.elements.fem.registry import ELEMENTS, cell_of

NUMBERS = {
    "area": 0.5,
    "second_moment": 0.04,
    "modulus": 3.0,
    "density": 2.0,
    "shear_area": 0.3,
    "thickness": 0.4,
    "poisson": 0.25,
    "temperature": 0.6,
    "expansion": 0.03,
}
KINDS = [
    (name, d)
    for name, cls in ELEMENTS.items()
    for d in cls.dimensions
    if "temperature" in {f.name for f in cls.quantity_fields()}
]


@functools.cache
def heated(name: str, d: int, held: bool = True, gradients: bool = True):
    """One element that rests on a node or is held at two, heated by itself and by a load case."""
    cls = ELEMENTS[name]
    s = da.Structure(f"{name} in {d}-D")
    points = places_of(CELLS[cell_of(cls)])[:, :d]
    nodes = s.add_nodes("n", points)
    numbers = {
        f.name: s.parameter(f.name, NUMBERS.get(f.name, 0.3))
        for f in cls.quantity_fields()
        if f.metadata["size"] == 1 and (gradients or "gradient" not in f.name)
    }
    element = s.add_elements("e", cls, nodes, [range(len(points))], **numbers)
    last = nodes[len(nodes) - 1]
    if not held:
        s.support(nodes[0])
        for k in range(1, d if not cls.turns else 1):
            s.support(nodes[k], **{f"u{'xyz'[i]}": 0.0 for i in range(k, d)})
        return s.build()
    s.support(nodes[0])
    if d > 1:
        s.support(last, ux=0.0)
        s.load(last, fy=s.parameter("force", 0.02))
    springs = {f"stiffness_{axis}": 0.5 for axis in "xyz"[:d]}
    for k in range(0 if cls.turns else 1, 0 if cls.turns else len(nodes)):
        s.add_elements(f"k{k}", ELEMENTS["GroundSpring"], nodes, [[k]], **springs)
    s.heat(element, temperature=s.parameter("hotter", 0.5))
    return s.build()


@pytest.mark.few(10)
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize(("name", "d"), KINDS)
def test_free_expansion_is_without_stress(name, d, nonlinear):
    """It grows alike in all directions: no stress, no reactions, no energy at small strain."""
    cls = ELEMENTS[name]
    if not cls.turns and cls.node_count == 2 and d > 1:
        return  # a single bar is a mechanism in the plane and in space
    model = heated(name, d, held=False, gradients=False)
    small = {"expansion": 1e-4}
    result = da.solve_statics(model, nonlinear=nonlinear, parameters=small)
    growth = 1e-4 * 0.6
    places = model.structure.nodes["n"].positions
    moved = result.displacement_of(model.structure.nodes["n"])
    apart, before = moved - moved[0], places - places[0]
    lengths = np.linalg.norm(before + apart, axis=1) - np.linalg.norm(before, axis=1)
    np.testing.assert_allclose(lengths, growth * np.linalg.norm(before, axis=1), atol=1e-2 * growth)
    assert np.abs(result.forces).max() < 1e-3 * 3.0 * growth
    assert abs(result.values("strain_energy")[0]) < 1e-3 * 3.0 * growth**2


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "d", "analysis"), crossed(KINDS, ["linear", "nonlinear", "path"]))
def test_gradients_under_heat(name, d, analysis):
    """By temperature, expansion and all else: direct, adjoint and differences."""
    model = heated(name, d)
    if analysis == "path":
        result = da.solve_load_path(model, first=0.5, until=1.0)
    else:
        result = da.solve_statics(
            model,
            nonlinear=analysis == "nonlinear",
            **({"steps": 2} if analysis == "nonlinear" else {}),
        )
    assert result.status.success
    stress = "force" if ELEMENTS[name].node_count == 2 else "sxx"
    last = f"n[{ELEMENTS[name].node_count - 1}]"
    at = result.time[-1]
    responses = [da.at(at, m) for m in ("n[0].fx", f"e[0].{stress}", "strain_energy")]
    if d > 1:
        responses.append(da.at(at, f"{last}.uy"))
    agree(result, responses)


@pytest.mark.parametrize(
    "name", sampled(["Truss", "Frame", "SpaceFrame", "Quadrilateral", "Hexahedron"], 5)
)
def test_vibration_and_buckling_under_heat(name):
    """Frequencies and load factors follow the stress of hindered expansion."""
    model = heated(name, ELEMENTS[name].dimensions[-1])
    for nonlinear in (False, True):
        loaded = da.solve_statics(model, nonlinear=nonlinear)
        modes = da.solve_modes(model, 1, about=loaded)
        agree(modes, [da.at(1, "frequency")])
    agree(da.solve_buckling(model, 1, negative=True), [da.at(1, "load_factor")])


def test_second_derivatives_under_heat():
    for name, nonlinear in (("Frame", False), ("Frame", True), ("Quadrilateral8", True)):
        model = heated(name, 2)
        statics = functools.partial(da.solve_statics, model, nonlinear=nonlinear)
        stress = da.final("e[0].force" if name == "Frame" else "e[0].sxx")
        direction = np.random.default_rng(1).uniform(-0.1, 0.1, model.nominal.size)
        computed = da.hessian_product(statics(), stress, direction).values.ravel()
        step, slopes = 1e-4, []
        for sign in (1, -1):
            p = model.nominal + sign * step * direction
            moved = statics(parameters=dict(zip(model.parameters, p, strict=True)))
            slopes.append(da.sensitivity(moved, stress).values.ravel())
        expected = (slopes[0] - slopes[1]) / (2 * step)
        np.testing.assert_allclose(computed, expected, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({}, "feels no change"),
        ({"temperature_gradient_z": 1.0}, "feels no temperature_gradient_z"),
        ({"temperature": [1.0, 2.0]}, "e.temperature"),
    ],
)
def test_changes_that_cannot_be_are_refused(changes, message):
    s = da.Structure("bar")
    nodes = s.add_nodes("n", [[0.0], [1.0]])
    element = s.add_elements("e", ELEMENTS["Truss"], nodes, [[0, 1]], area=1.0, modulus=1.0)
    with pytest.raises(da.ModelError, match=message):
        s.heat(element, **changes)


def agree(result, responses) -> None:
    adjoint, direct, differences = (
        da.sensitivity(result, responses, method=m).values
        for m in ("adjoint", "direct", "finite-difference")
    )
    scale = np.abs(direct).max(axis=1, keepdims=True)
    assert (scale > 0).all()
    assert (np.abs(adjoint - direct) / scale).max() < 1e-9
    assert (np.abs(differences - direct) / scale).max() < 1e-6
