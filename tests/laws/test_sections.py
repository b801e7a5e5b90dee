"""Cross-sections by quadrature over their shapes, and what they hand to elements."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import structures

SHAPES = {
    "rectangle": (structures.rectangle(0.3, 0.5), lambda z, y: (abs(z) < 0.15) & (abs(y) < 0.25)),
    "circle": (structures.circle(0.6), lambda z, y: np.hypot(z, y) < 0.3),
    "tube": (
        structures.tube(0.6, 0.1),
        lambda z, y: (np.hypot(z, y) < 0.3) & (np.hypot(z, y) > 0.2),
    ),
    "i": (
        structures.i_section(0.4, 0.6, 0.08, 0.05),
        lambda z, y: (abs(z) < 0.2) & (abs(y) < 0.3) & ((abs(y) > 0.22) | (abs(z) < 0.025)),
    ),
}


@pytest.mark.few(2)
@pytest.mark.parametrize("name", SHAPES)
def test_area_and_second_moments(name):
    section, inside = SHAPES[name]
    side = (np.arange(2000) + 0.5) / 2000 - 0.5
    z, y = np.meshgrid(side, side)
    points = inside(z, y) / side.size**2
    integrals = [points.sum(), (points * z**2).sum(), (points * y**2).sum()]
    properties = [section.area, section.second_moment_y, section.second_moment_z]
    np.testing.assert_allclose(properties, integrals, rtol=4e-3)


def test_torsion_constants():
    """A square 0.1406 a⁴ (Timoshenko and Goodier), a thin strip b t³/3, a circle π d⁴/32."""
    assert structures.rectangle(1.0, 1.0).torsion_constant == pytest.approx(0.1406, rel=2e-3)
    assert structures.rectangle(100.0, 1.0).torsion_constant == pytest.approx(100 / 3, rel=7e-3)
    assert structures.rectangle(1.0, 2.0).torsion_constant == pytest.approx(
        structures.rectangle(2.0, 1.0).torsion_constant
    )
    assert structures.circle(2.0).torsion_constant == pytest.approx(np.pi / 2)


def test_elements_take_what_they_need_and_follow_parameters():
    s = da.Structure("beam")
    width, height = s.parameter("wide", 0.02), s.parameter("high", 0.05)
    material = structures.Material(210e9, 0.3, 7850)
    cls = structures.TimoshenkoSpaceFrame
    a, b = s.node("a", 0, 0, 0), s.node("b", 1.0, 0, 0)
    section = structures.rectangle(width, height)
    s.add(cls("beam", a, b, **material.of(cls), **section.of(cls), orientation=(0, 1, 0)))
    s.support(a)
    s.load(b, fy=-100.0)
    result = da.solve_statics(s.build())
    bending = 100 / (3 * 210e9 * 0.02 * 0.05**3 / 12)
    shear = 100 / (210e9 / 2.6 * 5 / 6 * 1e-3)
    assert result["b.uy"] == pytest.approx(-bending - shear, rel=1e-10)
    gradient = da.sensitivity(result, da.final("b.uy"), method="adjoint").values[0]
    np.testing.assert_allclose(
        gradient, [(bending + shear) / 0.02, (3 * bending + shear) / 0.05], rtol=1e-9
    )
    assert set(section.of(structures.Frame)) == {"area", "second_moment"}
    with pytest.raises(da.ModelError, match="AxialSpring: has no area"):
        section.of(structures.AxialSpring)


def test_texts_with_units():
    """Numbers of shapes and materials may be texts, as those of elements; others are refused."""
    steel, same = structures.Material("210 GPa", 0.3, "7.85 g/cm^3"), structures.Material(210e9)
    assert steel.shear_modulus == same.shear_modulus and steel.density == pytest.approx(7850)
    for text, number in (
        (structures.rectangle("10 mm", "2 cm"), structures.rectangle(0.01, 0.02)),
        (structures.circle("10 mm"), structures.circle(0.01)),
        (structures.tube("10 mm", "1 mm"), structures.tube(0.01, 0.001)),
        (structures.i_section("1 m", 2, "1 cm", 0.02), structures.i_section(1, 2, 0.01, 0.02)),
    ):
        np.testing.assert_allclose(list(vars(text).values()), list(vars(number).values()))
    with pytest.raises(da.ExpressionError, match=r"Material.modulus: 210 mm does not fit"):
        structures.Material("210 mm")
    with pytest.raises(da.ExpressionError, match=r"tube: wall: .*unknown name 'thin'"):
        structures.tube(0.1, "thin")
