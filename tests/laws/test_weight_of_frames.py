"""Weight of frames in mechanisms: consistent with their mass matrix, and conservative."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial, structures

E, AREA, INERTIA, DENSITY = 2e9, 1e-3, 4e-7, 1500.0
Q = DENSITY * AREA * 9.81
PLANE = {"area": AREA, "second_moment": INERTIA, "modulus": E, "density": DENSITY}
SPACE = {"area": AREA, "second_moment_y": INERTIA, "second_moment_z": INERTIA, "modulus": E}
SPACE |= {"torsion_constant": 2 * INERTIA, "shear_modulus": E / 2.6, "density": DENSITY}
SHEAR = {"shear_modulus": E / 2.6, "shear_area": AREA / 1.2}
SPACE_SHEAR = {"shear_area_y": AREA / 1.2, "shear_area_z": AREA / 1.3}
FRAMES = {
    "Frame": (structures.Frame, PLANE),
    "TimoshenkoFrame": (structures.TimoshenkoFrame, PLANE | SHEAR),
    "SpaceFrame": (structures.SpaceFrame, SPACE),
    "TimoshenkoSpaceFrame": (structures.TimoshenkoSpaceFrame, SPACE | SPACE_SHEAR),
}
DOWN = (0.0, -9.81)


def dimension_of(kind: str) -> int:
    return FRAMES[kind][0].dimensions[0]


def gravity_of(kind: str) -> tuple[float, ...]:
    return DOWN if dimension_of(kind) == 2 else (0.0, *DOWN)


def beam(kind: str, end, elements: int = 1, gravity=None, extra=None) -> da.System:
    """A beam from the origin to ``end``, next to a body that makes it a mechanism."""
    cls, numbers = FRAMES[kind]
    system = da.System(kind, gravity=gravity_of(kind) if gravity is None else gravity)
    places = np.linspace(np.zeros(len(end)), end, elements + 1)
    nodes = [system.node(f"n{k}", *place) for k, place in enumerate(places)]
    for k, (i, j) in enumerate(pairwise(nodes)):
        system.add(cls(f"beam{k}", i, j, **(numbers | (extra or {}))))
    ground = system.ground
    if dimension_of(kind) == 2:
        block = system.add(planar.Body("block", mass=1.0, inertia=1.0))
        system.add(planar.Weld("wall", ground.center, block))
    else:
        block = system.add(spatial.Body("block", mass=1.0, inertia=(1, 1, 1)))
        system.add(spatial.Weld("wall", ground.frame(), block.frame()))
    return system


def horizontal(kind: str, length: float) -> tuple[float, ...]:
    return (length, 0.0) if dimension_of(kind) == 2 else (length, 0.0, 0.0)


def bending(kind: str, moment) -> float:
    """The component of a moment in the vertical plane of the beam."""
    return float(np.ravel(moment)[0] if dimension_of(kind) == 2 else -np.ravel(moment)[1])


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", FRAMES)
@pytest.mark.parametrize("seed", [0, 1])
def test_weight_is_the_mass_matrix_times_gravity(kind, seed):
    """All nodes of an undeformed free beam accelerate by the gravity, without rotation."""
    rng = np.random.default_rng(seed)
    d = dimension_of(kind)
    field = tuple(rng.standard_normal(d))
    model = beam(kind, rng.standard_normal(d), 2, gravity=field).build()
    fall = da.solve_dynamics(model, 1e-3, step=1e-3)
    for k in range(3):
        acceleration = fall[f"n{k}.acceleration"].values[0]
        np.testing.assert_allclose(acceleration, field, rtol=1e-9, atol=1e-9)
        rotation = fall[f"n{k}.angular_acceleration"].values[0]
        np.testing.assert_allclose(rotation, 0.0, atol=1e-6)


@pytest.mark.few(2)
@pytest.mark.parametrize("kind", FRAMES)
def test_a_clamped_beam_has_the_reactions_of_the_table(kind):
    """Moments ``± q L²/12`` and forces ``q L/2`` of one element between two clamps."""
    length = 1.7
    system = beam(kind, horizontal(kind, length))
    for name in ("n0", "n1"):
        system.support(system.nodes[name])
    rest = da.solve_equilibrium(system.build())
    for name, sign in (("n0", 1.0), ("n1", -1.0)):
        moment = bending(kind, rest[f"{name}_support.moment"].values[-1])
        assert moment == pytest.approx(sign * Q * length**2 / 12, rel=1e-9)
        force = np.ravel(rest[f"{name}_support.force"].values[-1])[-1]
        assert force == pytest.approx(Q * length / 2, rel=1e-9)


@pytest.mark.few(2)
@pytest.mark.parametrize("elements", [1, 3])
@pytest.mark.parametrize("kind", FRAMES)
def test_a_cantilever_has_the_deflection_of_the_table(kind, elements):
    """``q L⁴/(8 E I) + q L²/(2 G A_s)`` at the tip, exact at the nodes for small deflections."""
    length, stiff = 1.3, 1e4
    moduli = {n: v * stiff for n, v in FRAMES[kind][1].items() if "modulus" in n}
    system = beam(kind, horizontal(kind, length), elements, extra=moduli)
    system.support(system.nodes["n0"])
    rest = da.solve_equilibrium(system.build())
    expected = Q * length**4 / (8 * E * stiff * INERTIA)
    if kind.startswith("Timoshenko"):
        expected += Q * length**2 / (2 * E / 2.6 * stiff * AREA / 1.2)  # element y axis upwards
    deflection = -float(rest[f"n{elements}.u{'xyz'[dimension_of(kind) - 1]}"].values[-1])
    assert deflection == pytest.approx(expected, rel=1e-6)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", FRAMES)
def test_a_swinging_soft_beam_keeps_its_energy(kind):
    """Hinged at one end, with large rotation and bending: the potential is that of the force."""
    soft = {n: v * 1e-4 for n, v in FRAMES[kind][1].items() if "modulus" in n}
    system = beam(kind, horizontal(kind, 1.0), 2, extra=soft)
    system.support(
        system.nodes["n0"], **dict.fromkeys(("ux", "uy", "uz")[: dimension_of(kind)], 0.0)
    )
    integrator = da.DormandPrince853(rtol=1e-10, atol=1e-11)
    motion = da.solve_dynamics(system.build(), 0.6, integrator=integrator, outputs=[0.3, 0.6])
    drop = motion["potential_energy"].values
    assert np.ptp(drop) > 1.0
    total = motion["kinetic_energy"].values + drop
    assert np.ptp(total) < 1e-7 * np.ptp(drop)


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", ["Frame", "SpaceFrame"])
def test_gradients_are_exact(kind):
    """Direct = adjoint = differences, by length, density and stiffness."""
    system = da.System(kind, gravity=gravity_of(kind))
    length = system.parameter("length", 1.1)
    numbers = dict(FRAMES[kind][1])
    numbers["density"] = system.parameter("density", DENSITY)
    numbers["modulus"] = system.parameter("modulus", E * 1e-3)
    rest = (0.0,) * (dimension_of(kind) - 1)
    root, tip = system.node("root", 0.0, *rest), system.node("tip", length, *rest)
    system.add(FRAMES[kind][0]("beam", root, tip, **numbers))
    kinds = planar if dimension_of(kind) == 2 else spatial
    system.add(kinds.Particle("stone", mass=1.0))
    system.support(root)
    model = system.build()
    response = da.final(f"tip.u{'xyz'[dimension_of(kind) - 1]}")
    motion = da.solve_dynamics(model, 0.05, step=1e-3, integrator=da.HHT())
    direct, adjoint, quotients = (
        np.asarray(da.sensitivity(motion, response, method=m).values)
        for m in ("direct", "adjoint", da.FiniteDifference())
    )
    scale = np.array([1.1, DENSITY, E * 1e-3])
    size = np.abs(direct * scale).max()
    assert size > 1e-3
    np.testing.assert_allclose(adjoint * scale, direct * scale, rtol=1e-9, atol=1e-10 * size)
    np.testing.assert_allclose(quotients * scale, direct * scale, rtol=1e-5, atol=1e-6 * size)
