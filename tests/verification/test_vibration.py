"""Frequencies of beams, bars, frames and plates in their plane."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import structures
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.structural.modes import VibrationModes

E, A, INERTIA, LENGTH, DENSITY = 210e9, 2e-3, 4e-6, 2.5, 7850.0


def beam(count: int, *supports: dict, kind=structures.Frame, **more) -> StructuralModel:
    """A straight beam of ``count`` elements with supports at its two ends."""
    structure = da.Structure("beam")
    nodes = [structure.node(f"n{k}", LENGTH * k / count, 0.0) for k in range(count + 1)]
    arguments = {"area": A, "second_moment": INERTIA, "modulus": E, "density": DENSITY} | more
    for k in range(count):
        structure.add(kind(f"e{k}", nodes[k], nodes[k + 1], **arguments))
    for node, held in zip((nodes[0], nodes[-1]), supports, strict=True):
        if held is not None:
            structure.support(node, **held)
    return structure.build()


def bending(modes: VibrationModes) -> np.ndarray:
    """Angular frequencies of the modes that bend, in units of ``√(E I/(ρ A L⁴))``."""
    across = modes["effective_mass.ux"].values < 1e-6
    unit = np.sqrt(E * INERTIA / (DENSITY * A * LENGTH**4))
    return modes["angular_frequency"].values[across] / unit


CLAMPED, PINNED, ROLLING = {}, {"ux": 0, "uy": 0}, {"uy": 0}
# roots (βL)² of the frequency equations, e.g. cos βL cosh βL = −1 (Blevins, Formulas for Natural
# Frequency and Mode Shape, table 8-1)
BEAMS = {
    "clamped-free": ((CLAMPED, None), [1.87510407, 4.69409113, 7.85475744]),
    "pinned-pinned": ((PINNED, ROLLING), [np.pi, 2 * np.pi, 3 * np.pi]),
    "clamped-pinned": ((CLAMPED, ROLLING), [3.92660231, 7.06858275, 10.21017612]),
    "clamped-clamped": ((CLAMPED, {"uy": 0, "rz": 0}), [4.73004074, 7.85320462, 10.99560784]),
}


@pytest.mark.parametrize("name", BEAMS)
def test_beams_converge_with_the_fourth_order(name):
    supports, roots = BEAMS[name]
    exact = np.array(roots) ** 2
    errors = [
        bending(da.solve_modes(beam(count, *supports), 8))[:3] / exact - 1 for count in (4, 8, 16)
    ]
    assert (errors[0] > 0).all()  # a consistent mass bounds frequencies from above
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders[1] - 4) < 0.15)
    assert np.abs(errors[2]).max() < 2e-4


def test_lumped_masses_err_to_the_other_side():
    exact = np.array(BEAMS["pinned-pinned"][1]) ** 2
    computed = bending(da.solve_modes(beam(16, PINNED, ROLLING), 8, lumped=True))[:3]
    assert np.all(np.abs(computed / exact - 1) < 1e-2)


@pytest.mark.parametrize("lumped", [False, True])
def test_axial_bar(lumped):
    """Fixed-free: ``ω = (2k − 1)/2 π c/L``; two-node elements err by ``±(ω h/c)²/24``."""
    structure, count = da.Structure("bar"), 20
    nodes = [structure.node(f"n{k}", LENGTH * k / count) for k in range(count + 1)]
    for k in range(count):
        bar = structures.Truss(f"e{k}", nodes[k], nodes[k + 1], area=A, modulus=E, density=DENSITY)
        structure.add(bar)
    structure.support(nodes[0])
    modes = da.solve_modes(structure.build(), 3, lumped=lumped)
    exact = (np.arange(1, 4) - 0.5) * np.pi
    computed = modes["angular_frequency"].values * LENGTH / np.sqrt(E / DENSITY)
    leading = (exact / count) ** 2 / 24
    np.testing.assert_allclose(computed / exact - 1, -leading if lumped else leading, rtol=0.05)


def test_timoshenko_beam():
    """Simply supported: lower root of ``ρA ρI/(G A_s) ω⁴ − (ρA + …) ω² + E I k⁴ = 0`` (1921)."""
    g, shear_area = 80e9, A * 5 / 6
    more, ends = {"shear_modulus": g, "shear_area": shear_area}, (PINNED, ROLLING)
    coarse, fine = (
        bending(da.solve_modes(beam(n, *ends, kind=structures.TimoshenkoFrame, **more), 6))[:3]
        for n in (32, 64)
    )
    k = np.arange(1, 4) * np.pi / LENGTH
    mass, rotary, stiff, shear = DENSITY * A, DENSITY * INERTIA, E * INERTIA, g * shear_area
    a, b, c = mass * rotary / shear, mass + k**2 * (rotary + stiff * mass / shear), stiff * k**4
    exact = np.sqrt((b - np.sqrt(b**2 - 4 * a * c)) / (2 * a))
    unit = np.sqrt(E * INERTIA / (DENSITY * A * LENGTH**4))
    np.testing.assert_allclose(fine * unit, exact, rtol=1e-4)
    np.testing.assert_allclose((4 * fine - coarse) / 3 * unit, exact, rtol=2e-6)


def test_tension_stiffens_a_beam():
    """Pinned: ``ω² = (kπ/L)² (N + E I (kπ/L)²)/(ρ A)``."""
    structure, count, force = da.Structure("string"), 32, 5e5
    nodes = [structure.node(f"n{k}", LENGTH * k / count, 0.0) for k in range(count + 1)]
    arguments = {"area": 1e3 * A, "second_moment": INERTIA, "modulus": E, "density": DENSITY / 1e3}
    for k in range(count):  # stiff along its axis, so that it keeps its length
        structure.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **arguments))
    structure.support(nodes[0], ux=0, uy=0)
    structure.support(nodes[-1], uy=0)
    structure.load(nodes[-1], fx=force)
    model = structure.build()
    k = np.arange(1, 4) * np.pi / LENGTH
    exact = np.sqrt(k**2 * (force + E * INERTIA * k**2) / (DENSITY * A))
    for nonlinear in (False, True):
        loaded = da.solve_statics(model, nonlinear=nonlinear)
        computed = da.solve_modes(model, 3, about=loaded)["angular_frequency"].values
        np.testing.assert_allclose(computed, exact, rtol=2e-3)


def test_cross_of_beams():
    """NAFEMS FV2, pin-ended double cross of eight arms of 5 m, 0.125 m square, with four elements
    each: 11.336, 17.687 (2), 17.715 (5), 45.345, 57.390 (2), 57.683 Hz (5) (Selected Benchmarks
    for Natural Frequency Analysis, 1987; target values for such a mesh)."""
    structure, width, arm = da.Structure("FV2"), 0.125, 5.0
    middle = structure.node("m", 0.0, 0.0)
    arguments = {
        "area": width**2,
        "second_moment": width**4 / 12,
        "modulus": 200e9,
        "density": 8000.0,
    }
    count = 4
    for a in range(8):
        direction = np.array([np.cos(a * np.pi / 4), np.sin(a * np.pi / 4)])
        last = middle
        for k in range(1, count + 1):
            node = structure.node(f"a{a}n{k}", *(arm * k / count * direction))
            structure.add(structures.Frame(f"a{a}e{k}", last, node, **arguments))
            last = node
        structure.support(last, ux=0, uy=0)
    modes = da.solve_modes(structure.build(), 16)
    expected = [11.336] + [17.687] * 2 + [17.715] * 5 + [45.345] + [57.390] * 2 + [57.683] * 5
    np.testing.assert_allclose(modes.frequencies, expected, rtol=5e-3)


def tapered_membrane(across: int, along: int, kind) -> StructuralModel:
    """NAFEMS FV32: 10 m long, 5 m deep at its root and 1 m at its tip, 0.05 m thick."""
    structure = da.Structure("FV32")
    s, t = np.meshgrid(np.linspace(0, 1, along + 1), np.linspace(-1, 1, across + 1), indexing="ij")
    places = np.stack([10 * s, t * (2.5 - 2 * s)], axis=-1).reshape(-1, 2)
    nodes = structure.add_nodes("n", places)
    first = np.array([i * (across + 1) + j for i in range(along) for j in range(across)])
    cells = first[:, None] + np.array([0, across + 1, across + 2, 1])
    structure.add_elements(
        "cell", kind, nodes, cells, thickness=0.05, modulus=200e9, poisson=0.3, density=8000.0
    )
    structure.support(nodes.where(x=0.0))
    return structure.build()


def quadratic_membrane(across: int, along: int) -> StructuralModel:
    """The same by cells with nodes in the middles of their edges."""
    structure = da.Structure("FV32")
    s, t = np.meshgrid(
        np.linspace(0, 1, 2 * along + 1), np.linspace(-1, 1, 2 * across + 1), indexing="ij"
    )
    i, j = np.indices(s.shape)
    there = ~((i % 2 == 1) & (j % 2 == 1))
    number = np.where(there, np.cumsum(there).reshape(there.shape) - 1, -1)
    places = np.stack([10 * s, t * (2.5 - 2 * s)], axis=-1)[there]
    nodes = structure.add_nodes("n", places)
    round_ = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    cells = [
        [number[2 * a + step, 2 * b + db] for step, db in round_]
        for a in range(along)
        for b in range(across)
    ]
    kind = structures.Quadrilateral8
    structure.add_elements(
        "cell", kind, nodes, cells, thickness=0.05, modulus=200e9, poisson=0.3, density=8000.0
    )
    structure.support(nodes.where(x=0.0))
    return structure.build()


def test_tapered_membrane():
    """NAFEMS FV32: 44.623, 130.03, 162.70, 246.05, 379.90, 391.44 Hz (Selected Benchmarks for
    Natural Frequency Analysis, 1987)."""
    expected = np.array([44.623, 130.03, 162.70, 246.05, 379.90, 391.44])
    coarse, fine = (
        da.solve_modes(tapered_membrane(n, 2 * n, structures.Quadrilateral), 6).frequencies
        for n in (12, 24)
    )
    np.testing.assert_allclose(fine, expected, rtol=5e-3)
    assert np.all(np.abs((4 * fine - coarse) / 3 / expected - 1) < 1e-3)  # error of second order
    quadratic = da.solve_modes(quadratic_membrane(8, 16), 6).frequencies
    np.testing.assert_allclose(quadratic, expected, rtol=2e-4)
