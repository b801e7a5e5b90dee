"""A structure in a mechanism is the structure itself: its statics, vibrations and motions are those
that the analyses of structures find, and its gradients are exact."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import planar, spatial, structures

Build = Callable[[structures.Structure, float], None]
SOFT = 2e6
MATERIAL = {"thickness": 0.01, "modulus": 2e7, "density": 1000.0, "poisson": 0.3}


def bars(s: structures.Structure, modulus) -> None:
    a, b, c, d = (
        s.node(n, x, y) for n, x, y in (("A", 0, 0), ("B", 0, 1), ("C", 1, 1), ("D", 1, 0))
    )
    numbers = {"area": 1e-3, "modulus": modulus, "density": 1000.0}
    for k, (i, j) in enumerate(((a, d), (b, c), (a, c), (d, c), (b, d))):
        s.add(structures.Truss(f"bar{k}", i, j, **numbers))


def frame(s: structures.Structure, modulus) -> None:
    a, b, c, d = (
        s.node(n, x, y) for n, x, y in (("A", 0, 0), ("B", 0, 0.1), ("C", 0.5, 0.2), ("D", 1, 0))
    )
    numbers = {"area": 1e-3, "second_moment": 1e-6, "modulus": modulus, "density": 1000.0}
    for k, (i, j) in enumerate(((a, c), (b, c), (c, d))):
        s.add(structures.Frame(f"beam{k}", i, j, **numbers))


def plate(s: structures.Structure, modulus) -> None:
    places = [(0.5 * x, 0.2 * y) for x in range(3) for y in range(2)]
    nodes = dict(
        zip("ABCEDF", (s.node(n, *p) for n, p in zip("ABCEDF", places, strict=True)), strict=True)
    )
    numbers = {"thickness": 0.01, "modulus": modulus, "poisson": 0.3, "density": 1000.0}
    a, b, c, e, d, f = (nodes[n] for n in "ABCEDF")
    s.add(structures.Quadrilateral("q0", (a, c, e, b), **numbers))
    s.add(structures.Quadrilateral("q1", (c, d, f, e), **numbers))


def solid(s: structures.Structure, modulus) -> None:
    corners = {"A": (0, 0, 0), "B": (0, 1, 0), "C": (0, 0, 1), "D": (1, 0.2, 0.3)}
    nodes = [s.node(n, *p) for n, p in corners.items()]
    numbers = {"modulus": modulus, "poisson": 0.3, "density": 1000.0}
    s.add(structures.Tetrahedron("cell", tuple(nodes), **numbers))


def space_frame(s: structures.Structure, modulus) -> None:
    corners = {"A": (0, 0, 0), "C": (0.5, 0.2, 0.1), "D": (1, 0, 0.2)}
    nodes = {n: s.node(n, *p) for n, p in corners.items()}
    numbers = {"area": 1e-3, "second_moment_y": 1e-6, "second_moment_z": 2e-6}
    numbers |= {"torsion_constant": 2e-6, "modulus": modulus, "shear_modulus": modulus / 2.6}
    for k, (i, j) in enumerate(("AC", "CD")):
        beam = structures.SpaceFrame(f"beam{k}", nodes[i], nodes[j], density=1000.0, **numbers)
        s.add(beam)


SHAPES: dict[str, tuple[Build, str]] = {
    "bars": (bars, "AB"),
    "frame": (frame, "AB"),
    "plate": (plate, "AB"),
    "solid": (solid, "ABC"),
    "space frame": (space_frame, "A"),
}


def held(shape: str, load: float) -> da.Model:
    """In a mechanism, with joints at its feet and a force at D."""
    build, feet = SHAPES[shape]
    system = da.System(shape.replace(" ", "_"))
    modulus = system.parameter("E", SOFT)
    structure = structures.Structure(shape)
    build(structure, modulus)
    d = structure.dimension
    kinds = planar if d == 2 else spatial
    nodes = system.include("S", structure).nodes
    for foot in feet:
        body = nodes[foot]
        place = structure.nodes[foot].position
        point = system.ground.point(*(float(place[k]) for k in range(d)))
        if shape == "frame":
            system.add(planar.Weld(f"hold{foot}", point, body))
        elif shape == "space frame":
            system.support(body)
        else:
            joint = planar.Revolute if d == 2 else spatial.Spherical
            system.add(joint(f"hold{foot}", point, body))
    force = (0.0, -load) if d == 2 else (0.0, 0.0, -load)
    system.add(kinds.Force("F", nodes["D"], force))
    return system.build()


def alone(shape: str, load: float) -> structures.Structure:
    """The same as a structure, with supports and a load."""
    build, feet = SHAPES[shape]
    structure = structures.Structure(shape)
    build(structure, SOFT)
    for foot in feet:
        structure.support(structure.nodes[foot])
    down = {"fy": -load} if structure.dimension == 2 else {"fz": -load}
    structure.load(structure.nodes["D"], **down)
    return structure


def as_elements(shape: str, load: float) -> da.Model:
    """In a mechanism element by element, between nodes that are bodies of it."""
    build, feet = SHAPES[shape]
    system, drawn = da.System(shape), structures.Structure(shape)
    build(drawn, system.parameter("modulus", SOFT))
    kinds = planar if drawn.dimension == 2 else spatial
    kind = kinds.Node if "frame" in shape else kinds.PointNode
    nodes = {n: system.add(kind(n, position=drawn.nodes[n].position)) for n in drawn.nodes}
    for element in drawn.elements.values():
        ties = [nodes[node.name] for node in element.nodes()]
        of_nodes = [f for f in dataclasses.fields(element) if not f.metadata][1:]
        arguments = dict(zip((f.name for f in of_nodes), ties, strict=False))
        if "connectivity" in arguments:
            arguments["connectivity"] = tuple(ties)
        system.add(dataclasses.replace(element, **arguments))
    for foot in feet:
        system.support(nodes[foot])
    system.load(nodes["D"], **{"fy" if drawn.dimension == 2 else "fz": -load})
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("shape", SHAPES)
def test_elements_between_bodies_are_those_of_the_structure(shape):
    whole, parts = (da.solve_equilibrium(builder(shape, 40.0)) for builder in (held, as_elements))
    for axis in "xyz"[: 3 if shape in ("solid", "space frame") else 2]:
        np.testing.assert_allclose(parts[f"D.{axis}"], whole[f"S_D.{axis}"], rtol=1e-9, atol=1e-12)
    integrator = da.RK4() if shape == "space frame" else da.HHT()
    runs = [
        da.solve_dynamics(builder(shape, 40.0), 0.02, step=1e-3, integrator=integrator)
        for builder in (held, as_elements)
    ]
    np.testing.assert_allclose(runs[1]["D.y"], runs[0]["S_D.y"], rtol=1e-9, atol=1e-12)


def test_a_mesh_in_a_system_is_that_of_a_structure():
    mesh, numbers = structures.rectangle_mesh((1.0, 0.2), (4, 1)), dict(MATERIAL)
    system, structure = da.System("plate", gravity=(0, -9.81)), structures.Structure("plate")
    for model in (system, structure):
        nodes = model.add_mesh("plate", mesh, **numbers).nodes()
        model.support(nodes.where(x=0.0))
        model.load(nodes.nearest(1.0, 0.2), fy=-1.0)
    structure.gravity(0, -9.81)
    block = system.add(planar.Body("block", mass=1.0, inertia=1.0))
    system.add(planar.Weld("wall", system.ground.center, block))
    equilibrium = da.solve_equilibrium(system.build())
    done = da.Equilibrium().run(structure.build())
    for k in range(10):
        expected = float(done[f"plate_nodes[{k}].uy"])
        got = equilibrium[f"plate_nodes[{k}].uy"].values[-1]
        assert got == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_supports_may_move():
    """The free end of a light bar follows a foot that a driver moves slowly."""
    system = da.System("driven")
    a, b = (system.add(planar.PointNode(n, position=(x, 0))) for n, x in (("a", 0), ("b", 1)))
    system.add(structures.Truss("bar", a, b, area=1e-4, modulus=1e7, density=1.0))
    system.support(a, ux=0.01 * (1 - da.cos(da.t)), uy=0.0)
    system.support(b, uy=0.0)
    motion = da.solve_dynamics(system.build(), 1.0, step=1e-4, outputs=10)
    expected = 1 + 0.01 * (1 - np.cos(motion["time"].values))
    np.testing.assert_allclose(motion["b.x"], expected, atol=1e-6)


def test_wrong_nodes_supports_and_loads_are_told():
    system = da.System("wrong")
    a = system.add(planar.PointNode("a", position=(0, 0)))
    b = system.add(planar.Node("b", position=(1, 0)))
    body = system.add(planar.Body("body", mass=1.0, inertia=1.0))
    drawn = structures.Structure("drawn")
    other = drawn.node("other", 1.0, 0.0)
    numbers = {"area": 1e-4, "modulus": 1e7}
    with pytest.raises(da.ModelError, match=r"bar: node_j must be a node; got .*body"):
        structures.Truss("bar", a, body, **numbers)
    turned = da.System("turned")
    turned.add(a), turned.add(b)
    turned.add(structures.Frame("beam", a, b, second_moment=1e-8, **numbers))
    with pytest.raises(da.ModelError, match=r"beam: rotates its node a, a point; use planar\.Node"):
        turned.build()
    mixed = da.System("mixed")
    mixed.add(a)
    with pytest.raises(da.ModelError, match=r"bar: is tied to 'other', which is no node of this"):
        mixed.add(structures.Truss("bar", a, other, **numbers))
    placed = da.System("placed")
    c = placed.add(planar.PointNode("c", position=(0, 0)))
    nowhere = placed.add(planar.PointNode("nowhere"))
    placed.add(structures.Truss("bar", c, nowhere, **numbers))
    with pytest.raises(da.ModelError, match="nowhere: needs a position"):
        placed.build()
    with pytest.raises(da.ModelError, match="a: unknown direction 'rz'; known: ux, uy"):
        system.support(a, rz=0.0)
    turning = da.System("turning")
    turning.support(turning.add(spatial.Node("n", position=(0, 0, 0))), rx=0.0)
    with pytest.raises(da.ModelError, match="n: rx cannot be prescribed alone in space"):
        turning.build()
    with pytest.raises(da.ModelError, match="expected nodes"):
        system.support(body)
    with pytest.raises(da.ModelError, match="a: gets no load; give one of fx, fy"):
        system.load(a)
    short = da.System("short")
    ends = [short.add(planar.PointNode(n, position=(1, 1))) for n in "fg"]
    short.add(structures.Truss("bar", *ends, **numbers))
    with pytest.raises(da.ModelError, match="bar: has no length"):
        short.build()


def displacement(motion: da.Motion, structure: structures.Structure, k: int = -1) -> np.ndarray:
    axes = "xyz"[: structure.dimension]
    start = [float(structure.nodes["D"].position[n]) for n in range(len(axes))]
    return np.array([motion[f"S_D.{a}"].values[k] for a in axes]) - start


@pytest.mark.few(2)
@pytest.mark.parametrize("shape", SHAPES)
def test_statics_are_those_of_the_structure(shape):
    structure = alone(shape, 40.0)
    done = da.Equilibrium().run(structure.build())
    equilibrium = da.solve_equilibrium(held(shape, 40.0))
    axes = "xyz"[: structure.dimension]
    expected = [float(done[f"D.u{a}"]) for a in axes]
    np.testing.assert_allclose(displacement(equilibrium, structure), expected, rtol=1e-7)
    assert np.abs(expected).max() > 1e-4


@pytest.mark.few(1)
@pytest.mark.parametrize("shape", SHAPES)
def test_vibrations_are_those_of_the_structure(shape):
    expected = np.sort(da.solve_modes(alone(shape, 0.0).build(), count=3).data["frequency"].values)[
        :3
    ]
    computed = np.sort(da.linearize(held(shape, 0.0)).data["frequency"].values)
    computed = computed[computed > 1e-6 * expected[0]][: expected.size]
    np.testing.assert_allclose(computed, expected, rtol=1e-8)


def test_it_turns_as_a_rigid_body_does():
    """Thrown with a spin, a stiff frame turns on about its mass centre."""
    system, structure = da.System("thrown"), structures.Structure("frame")
    frame(structure, 1e9)
    system.include("S", structure, velocity=(0.3, -0.2), angular_velocity=2.0)
    model = system.build()
    motion = da.solve_dynamics(model, 0.5, step=1e-3, integrator=da.HHT())
    energy = motion["kinetic_energy"].values
    assert energy[-1] == pytest.approx(energy[0], rel=1e-4)
    assert motion["S_D.angle"].values[-1] == pytest.approx(1.0, abs=2e-3)


@pytest.mark.thorough
def test_a_thrown_space_frame_keeps_its_momenta_and_its_energy():
    system, structure = da.System("thrown"), structures.Structure("frame")
    space_frame(structure, 2e7)
    motion = {"velocity": (0.3, 0.1, -0.2), "angular_velocity": (1.0, 2.0, -1.5)}
    system.include("S", structure, **motion)
    model = system.build()
    run = da.solve_dynamics(model, 0.1, step=1e-4, integrator=da.RK4(), outputs=3)
    energy = run["energy"].values
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
    e = model.equations
    masses = ca.Function("masses", [e.y], [e.inertia.matrix])
    totals = []
    for y, v in zip(run.trajectory.y.T, run.trajectory.v.T, strict=True):
        momenta = (masses(y).full() @ v).reshape(-1, 6)
        poses = y.reshape(len(model.bodies), 7)
        axes = Rotation.from_quat(poses[:, [4, 5, 6, 3]])
        spin = np.cross(poses[:, :3], momenta[:, :3]) + axes.apply(momenta[:, 3:])
        totals.append([*momenta[:, :3].sum(axis=0), *spin.sum(axis=0)])
    np.testing.assert_allclose(totals, np.tile(totals[0], (3, 1)), atol=1e-10)


@pytest.mark.thorough
def test_a_pinned_bar_turns_on_stretched_by_its_own_pull():
    """One element about a slanted axis past half a turn.

    With the cubic deflections of an element of length L the pull is
    ``m ω² (13/35 r − 3/140 L) = E A (r/L − 1)``.
    """
    system, omega, modulus, area, density = da.System("bar"), 3.0, 1e6, 1e-4, 1000.0
    axis, along = np.array([1.0, 2.0, 2.0]) / 3, np.array([2.0, 1.0, -2.0]) / 3
    pull = density * omega**2 / modulus
    stretched = (1 - 3 / 140 * pull) / (1 - 13 / 35 * pull)
    spin = tuple(omega * axis)
    a, b = (
        system.add(
            spatial.Node(
                name,
                position=tuple(k * along),
                velocity=tuple(k * stretched * np.cross(spin, along)),
                rotation=da.rotation.axis_angle((1, 2 * k, 3), 0.4),
                angular_velocity=spin,
            )
        )
        for k, name in enumerate("ab")
    )
    system.add(
        structures.SpaceFrame(
            "bar",
            a,
            b,
            area=area,
            second_moment_y=area**2 / 12,
            second_moment_z=area**2 / 12,
            torsion_constant=area**2 / 6,
            modulus=modulus,
            shear_modulus=modulus / 2.6,
            density=density,
        )
    )
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), a.center))
    for k, name in enumerate("xyz"):
        system.initial(getattr(b, name), stretched * along[k])
    motion = da.solve_dynamics(system.build(), 1.2, step=1e-3, integrator=da.RK4(), outputs=5)
    turns = [Rotation.from_rotvec(omega * now * axis) for now in motion["time"].values]
    expected = [stretched * turn.apply(along) for turn in turns]
    np.testing.assert_allclose(motion["b.position"].values, expected, atol=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("shape", ["bars", "plate", "solid"])
def test_gradients_are_exact(shape):
    motion = da.solve_dynamics(held(shape, 40.0), 0.02, step=1e-3, integrator=da.HHT())
    response = da.final("S_D.y")
    direct, adjoint, quotient = (
        float(da.sensitivity(motion, response, method=m).values.ravel()[0])
        for m in ("direct", "adjoint", da.FiniteDifference())
    )
    assert adjoint == pytest.approx(direct, rel=1e-9)
    assert quotient == pytest.approx(direct, rel=1e-5)


def test_weight_and_measures():
    """A hanging bar of its own weight: the force at its middle is that of the lower half."""
    system, structure = da.System("rope", gravity=(0, -10)), structures.Structure("rope")
    top, low = structure.node("A", 0.0, 0.0), structure.node("D", 0.0, -1.0)
    structure.add(structures.Truss("bar", top, low, area=1e-3, modulus=SOFT, density=1000.0))
    copied = system.include("S", structure)
    system.add(planar.Revolute("hold", system.ground.center, copied.nodes["A"]))
    equilibrium = da.solve_equilibrium(system.build())
    assert equilibrium["S_bar.force"].values[0] == pytest.approx(5.0, rel=1e-9)


def test_unsupported_structures_are_refused():
    system, supported = da.System("whole"), alone("bars", 1.0)
    with pytest.raises(da.ModelError, match="S: the included model has supports"):
        system.include("S", supported)
    own = structures.Structure("own")
    frame(own, own.parameter("E", 1.0))
    with pytest.raises(da.ModelError, match=r"parameters of its own \(E\)"):
        system.include("S", own)
    with pytest.raises(da.ModelError, match=r"include\(\) takes a model of finite elements"):
        system.include("S", None)
