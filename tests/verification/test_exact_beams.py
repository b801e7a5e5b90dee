"""Static cantilevers bent far, against converged and published tips.

- Thick cantilever at 45° with a force and a moment at its tip (Exudyn, geometricallyExactBeam2D):
  converged by spectral elements, independently of this code.
- Slender and thick cantilevers of Nachbagauer (2011), as published with Exudyn's ANCF beams.
- 45° arc out of its plane (Bathe and Bolourchi 1979), as published with GXBeam.
- A moment ``2π E I/L`` rolls a beam up.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

FACTOR = 10 * 1.3 / (12 + 11 * 0.3)
MODULUS = 2.07e11


def thick(shear: float, height: float = 0.5, **more) -> tuple[da.System, planar.Beam]:
    area = 0.1 * height
    system = da.System("cantilever")
    arm = planar.Beam(
        "arm",
        system.ground.center,
        length=2.0,
        axial_rigidity=MODULUS * area,
        shear_rigidity=FACTOR * shear * area,
        bending_rigidity=MODULUS * 0.1 * height**3 / 12,
        **more,
    )
    return system, system.add(arm)


def tip(system: da.System, *measures: str) -> list[float]:
    equilibrium = da.solve_equilibrium(system.build())
    assert equilibrium.status.success
    return [float(equilibrium[f"arm.end.{m}"].values[0]) for m in measures]


def test_force_and_moment_on_a_thick_cantilever():
    system, arm = thick(7.9615e10, angle_i=math.pi / 4, elements=6, mass_per_length=1.0)
    pull = 6.25e7 * math.sqrt(0.5)
    system.add(planar.Force("F", arm.end.center, (pull, -pull)))
    system.add(planar.Torque("M", arm.end, -5e8))
    x, y, angle = tip(system, "x", "y", "angle")
    there = 2 * math.sqrt(0.5)
    assert x - there == pytest.approx(-1.1973740690, abs=1e-6)
    assert y - there == pytest.approx(-2.2094084465, abs=1e-6)
    assert angle - math.pi / 4 == pytest.approx(-4.3066754152, abs=1e-6)


@pytest.mark.parametrize(
    ("scale", "shortened", "deflection"),
    [(1.0, 1.88847418e-7, 8.09900305e-4), (1000.0, 0.15097102, 0.71056836)],
)
def test_thick_cantilever_under_small_and_large_force(scale, shortened, deflection):
    system, arm = thick(MODULUS / 2.6, mass_per_length=1.0)
    system.add(planar.Force("F", arm.end.center, (0.0, -scale * 5e5 * 0.5**3)))
    x, y = tip(system, "x", "y")
    assert 2.0 - x == pytest.approx(shortened, rel=1e-4)
    assert -y == pytest.approx(deflection, rel=1e-4)


def test_slender_cantilever():
    system, arm = thick(1e3 * MODULUS, height=0.1, mass_per_length=1.0)  # shear hardly deforms it
    force = 3 * MODULUS * 0.1**4 / 12 / 4
    system.add(planar.Force("F", arm.end.center, (0.0, -force)))
    x, y = tip(system, "x", "y")
    assert x - 2 == pytest.approx(-0.508537304326, rel=1e-4)
    assert y == pytest.approx(-1.207239854550, rel=1e-4)


def test_a_moment_rolls_it_up():
    system, arm = thick(MODULUS / 2.6, height=0.1, mass_per_length=1.0)
    system.add(planar.Torque("M", arm.end, 2 * math.pi * MODULUS * 0.1**4 / 12 / 2))
    x, y, angle = tip(system, "x", "y", "angle")
    assert [x, y] == pytest.approx([0, 0], abs=1e-4)
    assert angle == pytest.approx(2 * math.pi, rel=1e-6)


@pytest.mark.thorough
def test_arc_bent_out_of_its_plane():
    radius, modulus = 100.0, 1e7
    shear = modulus / 2
    system = da.System("arc", gravity=(0, 0, 0))
    arm = system.add(
        spatial.Beam(
            "arm",
            system.ground.frame((0, 0, 0)),
            length=radius * math.pi / 4,
            curvature=1 / radius,
            axial_rigidity=modulus,
            shear_rigidity=shear,
            torsional_rigidity=shear / 6,
            bending_rigidity_y=modulus / 12,
            bending_rigidity_z=modulus / 12,
            mass_per_length=1.0,
            elements=2,
        )
    )
    system.add(spatial.Force("F", arm.end.center, (0, 0, 600.0)))
    x, y, z = tip(system, "x", "y", "z")
    start = radius * np.array([math.sin(math.pi / 4), 1 - math.cos(math.pi / 4)])
    results = [y - start[1], x - start[0], z]
    expected = [-13.577383726758564, -23.545303336988038, 53.45800757548929]
    np.testing.assert_allclose(results, expected, rtol=3e-3)


@pytest.mark.thorough
def test_lateral_buckling():
    """A strip on edge tips over at ``4.0126 √(E I G J)/L²`` (Michell 1899, Prandtl 1899), raised by
    its deflection before: ``1/√((1 − E I/E I_y)(1 − G J/E I_y))`` (Hodges and Peters 1975)."""
    strong, weak, twist = 60830.0, 608.3, 877.2
    system = da.System("strip")
    load = system.parameter("load", 2000.0)
    strip = system.add(
        spatial.Beam(
            "strip",
            system.ground.frame((0, 0, 0)),
            length=1.0,
            axial_rigidity=73e6,
            shear_rigidity=5.025e6,
            shear_rigidity_z=23.4e6,
            torsional_rigidity=twist,
            bending_rigidity_y=strong,
            bending_rigidity_z=weak,
            mass_per_length=2.68,
            elements=2,
        )
    )
    system.add(spatial.Force("pull", strip.end.center, (0, 0, -load)))
    model = system.build()
    critical = 4.0126 * math.sqrt(weak * twist)
    critical /= math.sqrt((1 - weak / strong) * (1 - twist / strong))
    for share, stable in ((0.995, True), (1.005, False)):
        equilibrium = da.solve_equilibrium(model, parameters={"load": share * critical})
        assert ("not a stable" not in equilibrium.status.message) is stable
