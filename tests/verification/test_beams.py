"""Frames against beam theory."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import structures

E, A, INERTIA, LENGTH, P = 210e9, 2e-3, 4e-6, 2.5, 900.0


def cantilever(count: int, angle: float = 0.0, kind=structures.Frame, **more) -> da.Structure:
    """A straight beam of ``count`` elements, clamped at its start, under any angle."""
    structure = da.Structure("cantilever")
    direction = np.array([np.cos(angle), np.sin(angle)])
    nodes = [structure.node(f"n{k}", *(LENGTH * k / count * direction)) for k in range(count + 1)]
    for k in range(count):
        arguments = {"area": A, "second_moment": INERTIA, "modulus": E} | more
        structure.add(kind(f"e{k}", nodes[k], nodes[k + 1], **arguments))
    structure.support(nodes[0])
    return structure


@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
def test_cantilever_with_a_force_at_its_end(count, angle):
    """Deflection P L³/(3 E I), slope P L²/(2 E I), moment P L, exact for any number of elements."""
    structure = cantilever(count, angle)
    across = np.array([-np.sin(angle), np.cos(angle)])
    end = structure.nodes[f"n{count}"]
    structure.load(end, fx=P * across[0], fy=P * across[1])
    result = da.solve_statics(structure.build())
    tip = np.array([result[f"n{count}.ux"], result[f"n{count}.uy"]])
    deflection = P * LENGTH**3 / (3 * E * INERTIA)
    np.testing.assert_allclose(tip, deflection * across, rtol=1e-9, atol=1e-12)
    assert result[f"n{count}.rz"] == pytest.approx(P * LENGTH**2 / (2 * E * INERTIA), rel=1e-9)
    assert result["n0.mz"] == pytest.approx(-P * LENGTH, rel=1e-9)
    assert result["e0.moment_i"] == pytest.approx(-P * LENGTH, rel=1e-9)


def test_shear_adds_its_own_deflection():
    """Timoshenko: P L³/(3 E I) + P L/(G A_s)."""
    g, shear_area = 80e9, A * 5 / 6
    more = {"shear_modulus": g, "shear_area": shear_area}
    structure = cantilever(2, kind=structures.TimoshenkoFrame, **more)
    structure.load(structure.nodes["n2"], fy=P)
    result = da.solve_statics(structure.build())
    expected = P * LENGTH**3 / (3 * E * INERTIA) + P * LENGTH / (g * shear_area)
    assert result["n2.uy"] == pytest.approx(expected, rel=1e-10)


def test_portal_frame():
    """Clamped portal, sway by a force H at the beam: the slope–deflection solution."""
    structure, h, b, force = da.Structure("portal"), 3.0, 4.0, 5e3
    nodes = [structure.node(f"n{k}", *p) for k, p in enumerate([(0, 0), (0, h), (b, h), (b, 0)])]
    stiff = 1e6 * A  # no axial deformation
    for k in range(3):
        structure.add(
            structures.Frame(
                f"e{k}", nodes[k], nodes[k + 1], area=stiff, second_moment=INERTIA, modulus=E
            )
        )
    structure.support(nodes[0])
    structure.support(nodes[3])
    structure.load(nodes[1], fx=force)
    result = da.solve_statics(structure.build())
    ratio = h / b  # (I/L of the beam) / (I/L of a column)
    foot = force * h / 2 * (1 + 3 * ratio) / (1 + 6 * ratio)
    assert abs(result["n0.mz"]) == pytest.approx(foot, rel=1e-5)
    assert abs(result["e0.moment_j"]) == pytest.approx(force * h / 2 - foot, rel=1e-5)


def test_roll_up_to_a_circle():
    """A moment 2π E I/L bends a slender cantilever to a full circle."""
    gaps = []
    for count in (8, 16, 32):
        structure = cantilever(count)
        end = structure.nodes[f"n{count}"]
        structure.load(end, mz=2 * np.pi * E * INERTIA / LENGTH)
        result = da.solve_statics(structure.build(), nonlinear=True, steps=20)
        assert result.status.success
        assert result[f"n{count}.rz"] == pytest.approx(2 * np.pi, rel=1e-9)
        gaps.append(np.hypot(result[f"n{count}.ux"] + LENGTH, result[f"n{count}.uy"]) / LENGTH)
    assert gaps[-1] < 1e-9  # equal chords of a regular polygon close exactly


def elastica(load: float) -> tuple[float, float]:
    """Tip of a cantilever under a transverse end force ``α = P L²/(E I)``, by shooting."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq

    def flow(s, state):
        return [state[1], -load * np.cos(state[0]), np.cos(state[0]), np.sin(state[0])]

    def shot(curvature):
        return solve_ivp(flow, (0, 1), [0, curvature, 0, 0], rtol=1e-12, atol=1e-13).y[:, -1]

    curvature = brentq(lambda c: shot(c)[1], 0, 20, xtol=1e-13)
    return shot(curvature)[2], shot(curvature)[3]


def test_large_deflection_under_a_force():
    """Against the inextensible elastica; the error falls as the fourth power of the length."""
    errors = []
    for count in (4, 8, 16):
        structure = cantilever(count)
        for element in structure.elements.values():
            element.area = element.area * 1e4  # hardly extensible
        structure.load(structure.nodes[f"n{count}"], fy=5 * E * INERTIA / LENGTH**2)
        result = da.solve_statics(structure.build(), nonlinear=True)
        x, y = elastica(5.0)
        computed = (result[f"n{count}.ux"] + LENGTH) / LENGTH, result[f"n{count}.uy"] / LENGTH
        errors.append(np.hypot(computed[0] - x, computed[1] - y))
    slopes = np.diff(np.log(errors)) / np.log(0.5)
    np.testing.assert_allclose(slopes, 4.0, atol=0.3)
    assert errors[-1] < 2e-5


@pytest.mark.thorough
def test_gradients_at_large_deflection():
    """Adjoint, direct and differences through the nonlinear equilibrium."""
    structure = da.Structure("bent")
    numbers = {"E": 3.0, "I": 0.02, "A": 2.0, "F": 0.08, "l": 0.5, "settle": 0.05}
    q = {name: structure.parameter(name, value) for name, value in numbers.items()}
    nodes = [structure.node(f"n{k}", q["l"] * k, 0.0) for k in range(4)]
    for k in range(3):
        structure.add(
            structures.Frame(
                f"e{k}", nodes[k], nodes[k + 1], area=q["A"], second_moment=q["I"], modulus=q["E"]
            )
        )
    structure.support(nodes[0], ux=0.0, uy=q["settle"], rz=0.0)
    structure.load(nodes[3], fy=q["F"])
    result = da.solve_statics(structure.build(), nonlinear=True, tolerance=1e-13)
    assert result["n3.uy"] > 0.5
    measures = ("n3.ux", "n3.uy", "n0.mz", "e1.moment_i", "compliance", "strain_energy")
    responses = [da.final(m) for m in measures]
    adjoint, direct, differences = (
        da.sensitivity(result, responses, method=m).values
        for m in ("adjoint", "direct", "finite-difference")
    )
    scale = np.abs(direct).max(axis=1, keepdims=True)
    assert (np.abs(adjoint - direct) / scale).max() < 1e-9
    assert (np.abs(differences - direct) / scale).max() < 1e-6


def test_a_lost_load_path_keeps_its_last_equilibrium():
    """A hinged toggle carries no more than its limit load, near the height rise / √3."""
    structure, rise = da.Structure("toggle"), 0.1
    apex = structure.node("apex", 0.0, rise)
    for k, x in enumerate((-1.0, 1.0)):
        foot = structure.node(f"foot{k}", x, 0.0)
        structure.support(foot)
        structure.add(structures.Truss(f"bar{k}", foot, apex, area=1.0, modulus=1.0))
    structure.support(apex, ux=0.0)
    # downwards, y the height: 2 (L0 − L) y / (L L0), largest near y = rise / √3
    y = np.linspace(0, rise, 100_001)
    length, rest = np.hypot(1, y), np.hypot(1, rise)
    limit = (2 * (rest - length) * y / (length * rest)).max()
    structure.load(apex, fy=-0.9 * limit)
    below = da.solve_statics(structure.build(), nonlinear=True)
    assert below.status.success
    height = rise + below["apex.uy"]
    span = np.hypot(1, height)
    assert 2 * (rest - span) * height / (span * rest) == pytest.approx(0.9 * limit, rel=1e-8)
    structure.load(apex, fy=-0.2 * limit)  # 1.1 in all
    beyond = da.solve_statics(structure.build(), nonlinear=True)
    assert beyond.status.outcome is da.Outcome.NOT_CONVERGED
    assert beyond.status.time == pytest.approx(1 / 1.1, abs=1e-5)
    assert rise + beyond["apex.uy"] == pytest.approx(rise / np.sqrt(3), rel=1e-2)
    with pytest.raises(da.AnalysisError, match="no gradient"):
        da.sensitivity(beyond, da.final("apex.uy"))
