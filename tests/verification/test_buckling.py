"""Buckling of columns, frames and trusses."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.optimize import brentq

import dalembert as da
from dalembert import structures
from dalembert.model.assembled.model import StructuralModel

E, A, INERTIA, LENGTH = 210e9, 2e-3, 4e-6, 2.5


def column(count: int, start: dict, end: dict | None, area: float = A) -> StructuralModel:
    """A column along x, pressed at its end by one newton."""
    structure = da.Structure("column")
    nodes = [structure.node(f"n{k}", LENGTH * k / count, 0.0) for k in range(count + 1)]
    for k in range(count):
        arguments = {"area": area, "second_moment": INERTIA, "modulus": E}
        structure.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **arguments))
    structure.support(nodes[0], **start)
    if end is not None:
        structure.support(nodes[-1], **end)
    structure.load(nodes[-1], fx=-1.0)
    return structure.build()


CLAMPED, PINNED = {}, {"ux": 0, "uy": 0}
# buckling lengths, the third from the first root of tan x = x (Timoshenko and Gere, Theory of
# Elastic Stability, section 2)
COLUMNS = {
    "clamped-free": (CLAMPED, None, np.pi / 2),
    "pinned-pinned": (PINNED, {"uy": 0}, np.pi),
    "clamped-pinned": (CLAMPED, {"uy": 0}, 4.493409458),
    "clamped-clamped": (CLAMPED, {"uy": 0, "rz": 0}, 2 * np.pi),
}


@pytest.mark.parametrize("name", COLUMNS)
def test_euler_columns(name):
    """``P = E I x²/L²``, with an error of the fourth order."""
    start, end, root = COLUMNS[name]
    exact = E * INERTIA * root**2 / LENGTH**2
    errors = [
        da.solve_buckling(column(count, start, end, 1e7 * A), 1).load_factors[0] / exact - 1
        for count in (8, 16)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.15)
    assert errors[1] < 5e-5


@pytest.mark.parametrize("lateral", [0.01, 0.1, 1.0])
def test_a_lateral_load_does_not_change_the_load_factor(lateral):
    """Bending moments do not enter the linear theory of columns in their plane."""
    model = column(16, CLAMPED, None)
    model.structure.load(model.structure.nodes["n16"], fy=lateral)
    exact = E * INERTIA * (np.pi / 2) ** 2 / LENGTH**2
    modes = da.solve_buckling(model.structure.build(), 1)
    assert modes.load_factors[0] == pytest.approx(exact, rel=1e-3)
    assert lateral == 1.0 or not modes.warnings  # for which it bends by its length


def test_portal_frame_that_sways():
    """Pinned feet, columns and beam alike and of one length: ``kh tan kh = 6 I_b h/(I_c b) = 6``
    (Timoshenko and Gere, section 2.16)."""
    structure, count = da.Structure("portal"), 16
    corners = [(0.0, 0.0), (0.0, LENGTH), (LENGTH, LENGTH), (LENGTH, 0.0)]
    arguments = {"area": 1e4 * A, "second_moment": INERTIA, "modulus": E}
    ends = [structure.node(f"c{k}", *place) for k, place in enumerate(corners)]
    for side in range(3):
        last = ends[side]
        for k in range(1, count + 1):
            place = np.array(corners[side]) + k / count * np.subtract(
                corners[side + 1], corners[side]
            )
            node = ends[side + 1] if k == count else structure.node(f"s{side}n{k}", *place)
            structure.add(structures.Frame(f"s{side}e{k}", last, node, **arguments))
            last = node
    for foot in (ends[0], ends[3]):
        structure.support(foot, ux=0, uy=0)
    for top in ends[1:3]:
        structure.load(top, fy=-1.0)
    modes = da.solve_buckling(structure.build(), 1)
    root = brentq(lambda x: x * np.tan(x) - 6.0, 1.0, 1.5)
    assert modes.load_factors[0] == pytest.approx(E * INERTIA * root**2 / LENGTH**2, rel=2e-3)
    sway = modes["c1.ux"].values[0]
    assert modes["c2.ux"].values[0] == pytest.approx(sway, rel=1e-4)


def test_von_mises_truss():
    """Two bars that rise by the angle ``α``, pressed at the top: ``P = 2 E A sin³α/cos²α``.

    Their forces ``N = −P/(2 sin α)`` reduce the stiffness ``2 (E A/L) sin²α`` by
    ``2 (N/L) cos²α``. The third derivative of the energy by the deflection, ``6 (E A/L²) sin α
    cos²α``, includes the change of the angle: with it the load factor is a third. The true limit
    load of a flat pair is ``(2/√27) E A α³``.
    """
    for angle in (0.1, 0.5, 1.0):
        structure, length = da.Structure("two bars"), 2.0
        top = structure.node("top", 0.0, length * np.sin(angle))
        for name, side in (("left", -1), ("right", 1)):
            foot = structure.node(name, side * length * np.cos(angle), 0.0)
            structure.add(structures.Truss(f"bar_{name}", foot, top, area=A, modulus=E))
            structure.support(foot)
        structure.support(top, ux=0.0)
        structure.load(top, fy=-1.0)
        modes = da.solve_buckling(structure.build(), 1)
        exact = 2 * E * A * np.sin(angle) ** 3 / np.cos(angle) ** 2
        np.testing.assert_allclose(modes.load_factors, exact, rtol=1e-10)
        (warning,) = modes.warnings
        stated = float(re.search(r"nearer to (\S+) with", warning)[1])
        assert stated == pytest.approx(exact / 3, rel=0.01)


def test_column_between_springs():
    """A rigid column on its hinge, held at its top by a spring: ``P = k L``."""
    structure, stiffness = da.Structure("leaning column"), 3e3
    foot, top = structure.node("foot", 0.0, 0.0), structure.node("top", 0.0, LENGTH)
    wall = structure.node("wall", 1.0, LENGTH)
    structure.add(structures.Truss("column", foot, top, area=1.0, modulus=1e15))
    structure.add(structures.AxialSpring("spring", top, wall, stiffness=stiffness))
    structure.support(foot)
    structure.support(wall)
    structure.load(top, fy=-1.0)
    computed = da.solve_buckling(structure.build(), 1).load_factors[0]
    assert computed == pytest.approx(stiffness * LENGTH, rel=1e-9)
