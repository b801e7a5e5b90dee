"""Modes that coincide: what of them has a gradient, and slopes of what has none."""

from __future__ import annotations

import numpy as np
import pytest
from structure_models import model_of
from test_structural_modes import check_gradients

import dalembert as da
from dalembert import structures
from dalembert.model.assembled.model import StructuralModel


def square_truss() -> tuple[StructuralModel, da.Structure]:
    """A node held by four equal bars: equal frequencies in both directions."""
    structure = da.Structure("cross")
    density = structure.parameter("density", 2.0, "kg/m^3")
    modulus = structure.parameter("E", 3.0, "Pa")
    middle = structure.node("m", 0, 0)
    for name, place in {"e": (1, 0), "n": (0, 1), "w": (-1, 0), "s": (0, -1)}.items():
        area = structure.parameter(f"A_{name}", 1.0, "m^2")
        end = structure.node(name, *place)
        bar = structures.Truss(
            f"bar_{name}", middle, end, area=area, modulus=modulus, density=density
        )
        structure.add(bar)
        structure.support(end)
    return structure.build(), structure


def test_one_of_two_equal_modes_has_no_gradient():
    modes = da.solve_modes(square_truss()[0], 2)
    np.testing.assert_allclose(modes.frequencies[0], modes.frequencies[1], rtol=1e-14)
    for response in (da.at(1, "frequency"), da.at(2, "m.ux"), da.mean("m.ux")):
        with pytest.raises(da.SingularityError, match=r"modes 1 and 2 coincide.*mean"):
            da.sensitivity(modes, response)
    with pytest.raises(da.SingularityError, match="modes 1 and 2 coincide"):
        da.sensitivity(da.solve_modes(square_truss()[0], 1), da.at(1, "frequency"))


def test_what_does_not_tell_equal_modes_apart_has_a_gradient():
    """Means of eigenvalues, and sums of effective masses: ``K = 3 A``, ``M = ρ Σ A/3``."""
    modes = da.solve_modes(square_truss()[0], 2)
    responses = [
        da.mean("frequency"),
        da.integral("effective_mass.ux"),
        da.rms("angular_frequency"),
    ]
    check_gradients(modes, responses)
    total = da.evaluate(modes, da.integral("effective_mass.ux"))
    assert total == pytest.approx(2.0 * (4 / 3 + 2 / 3) ** 2 / (4 / 3), rel=1e-12)
    derivative = da.sensitivity(modes, da.mean("frequency"), ["E", "density"]).values.ravel()
    half = modes.frequencies[0] / 2
    np.testing.assert_allclose(derivative, [half / 3.0, -half / 2.0], rtol=1e-12)


def test_slopes_of_equal_modes_are_one_sided():
    model = square_truss()[0]
    modes = da.solve_modes(model, 2)
    slopes = da.eigenvalue_slopes(modes, "A_e")
    assert slopes.attrs["units"] == "Hz/(m^2)"
    step = 1e-5
    beyond = [
        da.solve_modes(model, 2, parameters={"A_e": 1 + k * step}).frequencies for k in (1, 2)
    ]
    computed = (4 * beyond[0] - beyond[1] - 3 * modes.frequencies) / (2 * step)
    np.testing.assert_allclose(slopes.values, computed, rtol=1e-7)
    mean = da.sensitivity(modes, da.mean("frequency"), ["A_e"]).values.item()
    assert slopes.values.mean() == pytest.approx(mean, rel=1e-12)
    with pytest.raises(da.AnalysisError, match="depends on the shape"):
        da.eigenvalue_slopes(modes, "A_e", "m.ux")


def test_slopes_of_single_modes_are_the_gradient():
    model = model_of("Truss 2-D")
    modes = da.solve_modes(model, 3)
    for name in ("modulus01", "x10", "density12"):
        numbers = range(1, modes.numbers.size + 1)
        single = [da.at(k, "eigenvalue", name=f"{k}") for k in numbers]
        np.testing.assert_allclose(
            da.eigenvalue_slopes(modes, name, "eigenvalue").values,
            da.sensitivity(modes, single, [name]).values.ravel(),
            rtol=1e-9,
        )


def test_beam_of_square_section_in_space():
    """Bending modes come in pairs; a section that is no square any more parts them."""
    structure = da.Structure("square beam")
    breadth = structure.parameter("b", 0.1, "m")
    depth = structure.parameter("d", 0.1, "m")
    length = structure.parameter("L", 2.0, "m")
    nodes = [structure.node(f"n{k}", length * k / 4, 0, 0) for k in range(5)]
    for k in range(4):
        beam = structures.SpaceFrame(
            f"e{k}",
            nodes[k],
            nodes[k + 1],
            area=breadth * depth,
            second_moment_y=breadth**3 * depth / 12,
            second_moment_z=breadth * depth**3 / 12,
            torsion_constant=0.141 * (breadth * depth) ** 2,
            modulus=210e9,
            shear_modulus=81e9,
            density=7850.0,
        )
        structure.add(beam)
    structure.support(nodes[0])
    model = structure.build()
    modes = da.solve_modes(model, 4)
    frequencies = modes.frequencies
    np.testing.assert_allclose(frequencies[::2], frequencies[1::2], rtol=1e-10)
    with pytest.raises(da.SingularityError, match="modes 3 and 4 coincide"):
        da.sensitivity(modes, da.at(3, "frequency"))
    check_gradients(modes, [da.mean("frequency"), da.integral("effective_mass.uy")])
    # f = (βL)²/(2π L²) √(E d²/12 ρ): one of a pair grows with the depth, the other does not
    slopes = da.eigenvalue_slopes(modes, "d").values
    np.testing.assert_allclose(
        slopes, [0, frequencies[0] / 0.1, 0, frequencies[2] / 0.1], atol=1e-6
    )
