"""Thermal stresses with known solutions.

Timoshenko and Goodier, Theory of Elasticity (1970), chapter 13; Gere and Timoshenko, Mechanics of
Materials (1997), sections 2.5 and 9.11.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import structures

ALPHA, HEAT, MODULUS, AREA, SECOND = 1.2e-5, 40.0, 2e11, 1e-3, 1e-7


def column(count: int, **heat) -> tuple[da.Structure, object]:
    """Clamped at its foot, two metres long, heated; the other end is free."""
    s = da.Structure("column")
    nodes = s.add_nodes("n", np.linspace([0.0, 0.0], [2.0, 0.0], count + 1))
    cells = [(k, k + 1) for k in range(count)]
    numbers = {"area": AREA, "second_moment": SECOND, "modulus": MODULUS, "expansion": ALPHA}
    beams = s.add_elements("e", structures.Frame, nodes, cells, **numbers)
    s.support(nodes[0])
    s.heat(beams, **heat)
    return s, nodes[count]


@pytest.mark.parametrize("nonlinear", [False, True])
def test_clamped_bar(nonlinear):
    """``σ = −E α ΔT`` and nothing moves; on a free end ``α ΔT L`` and no stress."""
    s, end = column(3, temperature=HEAT)
    free = da.solve_statics(s.build(), nonlinear=nonlinear)
    assert free.values("n[3].ux")[0] == pytest.approx(ALPHA * HEAT * 2.0, rel=1e-9)
    assert abs(free.values("e[1].stress")[0]) < 1e-6 * MODULUS * ALPHA * HEAT
    s.support(end)
    held = da.solve_statics(s.build(), nonlinear=nonlinear)
    assert held.values("e[1].stress")[0] == pytest.approx(-MODULUS * ALPHA * HEAT, rel=1e-9)
    assert held.values("n[3].fx")[0] == pytest.approx(-AREA * MODULUS * ALPHA * HEAT, rel=1e-9)
    assert held.values("strain_energy")[0] == pytest.approx(
        AREA * MODULUS * (ALPHA * HEAT) ** 2, rel=1e-9
    )


def test_gradient_over_the_height():
    """A free end moves by ``α T' L²/2`` away from the hot side; clamped, ``M = E I α T'``."""
    rise = 300.0
    s, end = column(4, temperature_gradient=rise)
    model = s.build()
    free = da.solve_statics(model)
    assert free.values("n[4].uy")[0] == pytest.approx(-ALPHA * rise * 2.0, rel=1e-9)
    moment = MODULUS * SECOND * ALPHA * rise
    assert abs(free.values("e[2].moment_j")[0]) < 1e-9 * moment
    s.support(end)
    held = da.solve_statics(s.build())
    assert held.values("e[2].moment_j")[0] == pytest.approx(moment, rel=1e-9)
    assert held.values("n[4].mz")[0] == pytest.approx(moment, rel=1e-9)


def test_heat_makes_a_clamped_column_buckle():
    """``E A α ΔT = 4 π² E I/L²``."""
    s, end = column(16, temperature=HEAT)
    s.support(end)
    modes = da.solve_buckling(s.build(), 1)
    critical = 4 * np.pi**2 * SECOND / (AREA * ALPHA * 2.0**2)
    assert modes.load_factors[0] * HEAT == pytest.approx(critical, rel=1e-4)


@pytest.mark.parametrize("plane_strain", [False, True])
def test_panel_between_walls(plane_strain):
    """Held along x: ``σ_xx = −E α ΔT``, in plane strain ``−E α ΔT/(1 − ν)``."""
    poisson, heat = 0.3, {"temperature": HEAT, "expansion": ALPHA}
    s = da.Structure("panel")
    nodes = s.add_nodes("n", [[0, 0], [1, 0], [1, 1], [0, 1]])
    numbers = {"modulus": MODULUS, "poisson": poisson, "thickness": 0.1} | heat
    s.add_elements(
        "e", structures.Quadrilateral, nodes, [[0, 1, 2, 3]], plane_strain=plane_strain, **numbers
    )
    s.support(nodes, ux=0.0)
    s.support(nodes[[0, 1]], uy=0.0)
    result = da.solve_statics(s.build())
    whole = MODULUS * ALPHA * HEAT
    expected = whole / (1 - poisson) if plane_strain else whole
    assert result.values("e[0].sxx")[0] == pytest.approx(-expected, rel=1e-9)
    assert abs(result.values("e[0].syy")[0]) < 1e-9 * whole


def test_two_bars_of_one_length():
    """Steel between copper (Gere, section 2.5): forces in balance, one elongation."""
    s, inputs = (
        da.Structure("pair"),
        {"steel": (2e11, 1e-4, 12e-6), "copper": (1.2e11, 3e-4, 17e-6)},
    )
    a, b = s.node("a", 0.0), s.node("b", 1.5)
    s.support(a)
    for name, (modulus, area, alpha) in inputs.items():
        numbers = {"area": area, "modulus": modulus, "expansion": alpha}
        s.heat(s.add(structures.Truss(name, a, b, **numbers)), "hot", temperature=HEAT)
    s.load(b, "pulled", fx=1000.0)
    result = da.solve_statics(s.build())
    (e1, a1, k1), (e2, a2, k2) = inputs.values()
    force = (k2 - k1) * HEAT / (1 / (e1 * a1) + 1 / (e2 * a2))
    assert result.values("steel.force")[result.case("hot")] == pytest.approx(force, rel=1e-9)
    assert result.values("copper.force")[result.case("hot")] == pytest.approx(-force, rel=1e-9)
    cold = result.case("pulled")
    share = e1 * a1 / (e1 * a1 + e2 * a2)
    assert result.values("steel.force")[cold] == pytest.approx(1000.0 * share, rel=1e-9)
