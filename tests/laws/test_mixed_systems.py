"""Nodes, finite elements, supports and loads are the same alone and beside rigid bodies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial, structures

SOFT = 2e6
STEEL = {"modulus": SOFT, "density": 1000.0}


def nodes(s: da.System, names: str, places: list[tuple[float, ...]]) -> list[structures.Node]:
    return [s.node(name, *place) for name, place in zip(names, places, strict=True)]


def bars(s: da.System) -> None:
    a, b, c, d = (
        s.node(n, *at) for n, at in zip("ABCD", [(0, 0), (0, 1), (1, 1), (1, 0)], strict=True)
    )
    for k, (i, j) in enumerate(((a, d), (b, c), (a, c), (d, c), (b, d))):
        s.add(structures.Truss(f"bar{k}", i, j, area=1e-3, **STEEL))
    s.support([a, b])
    s.load(d, fx=3.0, fy=-30.0)


def frame(s: da.System) -> None:
    a, b, c, d = (
        s.node(n, *at) for n, at in zip("ABCD", [(0, 0), (0, 0.1), (0.5, 0.2), (1, 0)], strict=True)
    )
    for k, (i, j) in enumerate(((a, c), (b, c), (c, d))):
        s.add(structures.Frame(f"beam{k}", i, j, area=1e-3, second_moment=1e-6, **STEEL))
    s.support(a)
    s.support(b, ux=0, uy=0.001)
    s.load(d, fy=-1.0, mz=0.1)
    s.load(d, fx=0.5)


def plate(s: da.System) -> None:
    mesh = structures.rectangle_mesh((1.0, 0.2), (4, 1))
    skin = s.add_mesh("skin", mesh, thickness=0.01, expansion=1e-4, **STEEL).nodes()
    s.support(skin.where(x=0.0))
    s.load(skin.where(x=1.0), fy=np.array([-0.5, -1.0]))
    s.traction(s.elements["skin"], skin.where(x=1.0), tx=300.0, pressure=20.0)
    s.heat(s.elements["skin"], temperature=10.0)


def space_frame(s: da.System) -> None:
    a, c, d = (
        s.node(n, *at)
        for n, at in zip("ACD", [(0, 0, 0), (0.5, 0.2, 0.1), (1, 0, 0.2)], strict=True)
    )
    numbers = {"area": 1e-3, "second_moment_y": 1e-6, "second_moment_z": 2e-6}
    numbers |= {"torsion_constant": 2e-6, "shear_modulus": SOFT / 2.6}
    for k, (i, j) in enumerate(((a, c), (c, d))):
        s.add(structures.SpaceFrame(f"beam{k}", i, j, **numbers, **STEEL))
    s.support(a)
    s.load(d, fx=0.2, fz=-1.0)


def solid(s: da.System) -> None:
    s.add_nodes("n", [[0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0.2, 0.3]])
    n = s.nodes["n"]
    s.add_elements("cell", structures.Tetrahedron, n, [(0, 1, 2, 3)], poisson=0.3, **STEEL)
    s.support(n[:3])
    s.load(n[3], fz=-400.0)


DRAWN: dict[str, tuple[Callable[[da.System], None], str]] = {
    "bars": (bars, "D"),
    "frame": (frame, "D"),
    "plate": (plate, "skin_nodes[4]"),
    "space frame": (space_frame, "D"),
    "solid": (solid, "n[3]"),
}


def alone(name: str, kind: type = da.System) -> da.StructuralModel:
    system = kind(name)
    DRAWN[name][0](system)
    return system.build()


def beside_a_body(name: str) -> da.Model:
    system = da.System(name)
    DRAWN[name][0](system)
    if system.dimension == 2:
        block = system.add(planar.Body("block", mass=1.0, inertia=1.0))
        system.add(planar.Weld("wall", system.ground.center, block))
    else:
        block = system.add(spatial.Body("block", mass=1.0, inertia=(1, 1, 1)))
        system.add(spatial.Weld("wall", system.ground.frame(), block.frame()))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("name", DRAWN)
def test_a_rigid_body_beside_it_changes_nothing(name):
    structure, mechanism = alone(name), beside_a_body(name)
    assert isinstance(structure, da.StructuralModel) and isinstance(mechanism, da.Model)
    expected, computed = (da.solve_equilibrium(model) for model in (structure, mechanism))
    node = DRAWN[name][1]
    directions = ["ux", "uy", "uz"][: structure.degrees.dimension]
    directions += ["rz"] if name == "frame" else []
    reference = np.array([np.ravel(expected[f"{node}.{d}"])[-1] for d in directions])
    assert np.abs(reference).max() > 1e-5
    got = [float(computed[f"{node}.{d}"].values[-1]) for d in directions]
    np.testing.assert_allclose(got, reference, rtol=1e-9, atol=1e-9 * np.abs(reference).max())


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["bars", "frame", "space frame", "solid"])
def test_vibrations_beside_a_rigid_body_are_those_of_the_structure(name):
    def at_rest(system: da.System) -> None:
        DRAWN[name][0](system)
        system.loads.clear()
        system.supports = {k: v for k, v in system.supports.items() if v.sx.is_zero()}

    structure, mechanism = da.Structure("alone"), da.System("beside")
    at_rest(structure), at_rest(mechanism)
    kinds = planar if structure.dimension == 2 else spatial
    mechanism.add(kinds.Particle("stone", mass=1.0))
    expected = np.sort(da.solve_modes(structure.build(), count=3).data["frequency"].values)
    linear = da.linearize(mechanism.build(), equilibrium=False)
    computed = np.sort(linear.data["frequency"].values)
    computed = computed[computed > 1e-3 * expected[0]][: expected.size]
    np.testing.assert_allclose(computed, expected, rtol=1e-9)


def test_a_body_at_a_node_is_a_point_mass_and_inertia():
    """A block welded to the tip of a frame vibrates as mass and inertia at the node do."""
    structure, mechanism = da.Structure("masses"), da.System("block")
    for system in (structure, mechanism):
        frame(system)
        system.loads.clear(), system.supports.clear()
        system.support(system.nodes["B"])
    tip = structure.nodes["D"]
    structure.add(structures.PointMass("m", tip, mass=0.7))
    structure.add(structures.PointInertia("J", tip, inertia_z=0.02))
    block = mechanism.add(planar.Body("block", mass=0.7, inertia=0.02, position=(1, 0)))
    mechanism.add(planar.Weld("hold", mechanism.nodes["D"], block.center))
    computed = da.solve_modes(structure.build(), count=3).data["frequency"].values
    linear = da.linearize(mechanism.build(), equilibrium=False)
    values = np.sort(linear.data["frequency"].values)[:3]
    np.testing.assert_allclose(values, np.sort(computed), rtol=1e-9)


def test_reactions_and_elements_have_the_same_measures():
    structure, mechanism = alone("bars"), beside_a_body("bars")
    expected, equilibrium = da.solve_equilibrium(structure), da.solve_equilibrium(mechanism)
    for k in range(5):
        computed = float(np.ravel(expected[f"bar{k}.force"])[-1])
        assert equilibrium[f"bar{k}.force"].values[-1] == pytest.approx(computed, rel=1e-9)
    reaction = equilibrium["A_support.force"].values[-1]
    computed = [float(np.ravel(expected[f"A.f{axis}"])[-1]) for axis in "xy"]
    np.testing.assert_allclose(reaction, computed, rtol=1e-9)


def test_a_system_of_finite_elements_is_a_structure():
    one, other = (da.solve_statics(alone("plate", kind)) for kind in (da.System, da.Structure))
    np.testing.assert_array_equal(one.displacements, other.displacements)


def test_nodes_start_as_prescribed():
    system = da.System("plucked")
    a, b = system.node("a", 0.0, 0.0), system.node("b", 1.0, 0.0)
    system.add(structures.Frame("beam", a, b, area=1e-3, second_moment=1e-6, **STEEL))
    system.add(planar.Particle("stone", mass=1.0))
    system.support(a)
    system.initial(b, uy=0.01, vx=0.2, rz=0.015, vrz=-0.1)
    motion = da.solve_dynamics(system.build(), 1e-3, step=1e-4, integrator=da.HHT())
    start = [motion[f"b.{name}"].values[0] for name in ("ux", "uy", "rz", "vx", "vy", "vrz")]
    np.testing.assert_allclose(start, [0.0, 0.01, 0.015, 0.2, 0.0, -0.1], atol=1e-12)


def test_the_start_of_nodes_is_checked():
    def plucked():
        system = da.System("plucked")
        a, b = system.node("a", 0.0, 0.0), system.node("b", 1.0, 0.0)
        system.add(structures.Frame("beam", a, b, area=1e-3, second_moment=1e-6, **STEEL))
        system.add(planar.Particle("stone", mass=1.0))
        system.support(a, ux=0.0, uy=0.0)
        return system, a, b

    for start in ({"value": 0.1}, {}):
        system, _, b = plucked()
        with pytest.raises(da.ModelError, match="b: gets no initial motion; give one of ux, uy"):
            system.initial(b, **start)
    for start in ({}, {"value": 0.1, "vx": 1.0}):
        with pytest.raises(da.ModelError, match="initial: a measure takes one value"):
            system.initial(b.body.x, **start)
    for name in ("vy", "uy"):
        system, a, _ = plucked()
        system.initial(a, **{name: 1.0})
        with pytest.raises(da.ModelError, match=f"initial a.{name}: uy is prescribed"):
            system.build()
    system, a, _ = plucked()
    system.initial(a, vrz=0.2)
    motion = da.solve_dynamics(system.build(), 1e-3, step=1e-4, integrator=da.HHT())
    assert motion["a.vrz"].values[0] == pytest.approx(0.2, abs=1e-12)


def test_modes_are_about_a_result():
    model = alone("plate", da.System)
    for about in (5, ""):
        with pytest.raises(da.AnalysisError, match=r"Modal: about is .*; give a motion of a mech"):
            da.linearize(model, about=about)


def test_forces_may_follow_the_measures_of_nodes():
    """A spring written as a formula of a node's displacement holds as a spring does."""
    system = da.System("formula")
    a, b = system.node("a", 0.0, 0.0), system.node("b", 1.0, 0.0)
    system.add(structures.Truss("bar", a, b, area=1e-3, **STEEL))
    system.support(a)
    system.support(b, uy=0.0)
    pull = 5.0 - 1000.0 * system.formula("b.ux")
    system.add(planar.Force("pull", b, (pull, 0.0)))
    rest = da.solve_equilibrium(system.build())
    assert rest["b.ux"].item() == pytest.approx(5.0 / (1000.0 + 1e-3 * SOFT), rel=1e-9)


def test_the_velocity_of_a_mesh_is_that_of_a_rigid_body():
    system = da.System("thrown")
    mesh = structures.rectangle_mesh((0.4, 0.2), (2, 1))
    numbers = {"thickness": 0.01, **STEEL}
    system.add_mesh("skin", mesh, velocity=(1.0, 2.0), angular_velocity=3.0, **numbers)
    motion = da.solve_dynamics(system.build(), 1e-4, step=1e-5, integrator=da.HHT())
    points = mesh[0]
    for k, (x, y) in enumerate(points):
        start = [motion[f"skin_nodes[{k}].v{axis}"].values[0] for axis in "xy"]
        np.testing.assert_allclose(start, [1.0 - 3.0 * y, 2.0 + 3.0 * x], atol=1e-12)


def beam_with(more: Callable[[da.System, structures.Node], None]) -> da.System:
    system = da.System("mixed")
    a, b = system.node("a", 0.0, 0.0), system.node("b", 1.0, 0.0)
    system.add(structures.Truss("bar", a, b, area=1e-3, **STEEL))
    system.add(planar.Particle("stone", mass=1.0))
    more(system, b)
    return system


REFUSED = [
    (lambda s, b: s.load(b, case="wind", fx=1.0), "load case 'wind': a mechanism has one set"),
    (lambda s, b: s.gravity(0, -9.81, case="weight"), "load case 'weight'"),
    (lambda s, b: s.heat(s.elements["bar"], temperature=1.0), "no thermal expansion"),
    (lambda s, b: s.line_load(s.elements["bar"], qy=1.0), "line_load: is not available in mech"),
    (lambda s, b: s.support(b, rz=0.0), "support b: rz: no element turns this node"),
    (lambda s, b: s.load(b, mz=1.0), "load b: mz: no element turns this node"),
    (lambda s, b: s.support(b) or s.support(b, ux=0.1), "is fixed, and ux is prescribed as 0.1"),
    (lambda s, b: s.support(b, uz=0.0), "b: unknown direction 'uz'; known: ux, uy, rz"),
    (lambda s, b: s.node("stone", 1.0, 1.0), "stone: the name is already used"),
    (lambda s, b: s.node("ground", 1.0, 1.0), "the name 'ground' is reserved"),
    (lambda s, b: s.node("c", 1.0), "c: has 1 coordinates, a has 2"),
    (lambda s, b: s.add(b), r"add\(\) takes an element"),
    (
        lambda s, b: s.support(b) or s.add(planar.Particle("b_support", mass=1.0)),
        "b_support: the name is that of a support or load",
    ),
    (
        lambda s, b: (
            s.add(planar.Spring("spring", s.ground.center, b, stiffness=1.0))
            and s.add(structures.Frame("beam", s.nodes["a"], b, area=1, second_moment=1, modulus=1))
        ),
        "beam: rotates its node b, which is already a point",
    ),
]


@pytest.mark.parametrize(("more", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_missing_features_of_mechanisms_are_named(more, message):
    with pytest.raises(da.ModelError, match=message):
        beam_with(more).build()


def test_nodes_of_one_coordinate_are_no_bodies():
    system = da.System("line")
    a, b = system.node("a", 0.0), system.node("b", 1.0)
    system.add(structures.AxialSpring("spring", a, b, stiffness=1.0))
    system.add(planar.Particle("stone", mass=1.0))
    with pytest.raises(da.UnsupportedError, match="a: a node with one coordinate is no body"):
        system.build()


def test_a_structure_takes_no_rigid_bodies():
    structure = da.Structure("frame")
    with pytest.raises(da.ModelError, match="takes a structural element"):
        structure.add(planar.Particle("stone", mass=1.0))
    node = structure.node("a", 0.0, 0.0)
    structure.add(structures.PointMass("m", node, mass=1.0))
    structure.initial(node.body.x, 0.1)
    with pytest.raises(da.ModelError, match=r"initial\(measure, value\) is for mechanisms"):
        structure.build()


def test_a_flexible_body_takes_a_structure_or_its_model():
    rods = []
    for built in (False, True):
        rod = da.Structure("rod")
        a, b = rod.node("a", 0, 0), rod.node("b", 1, 0)
        rod.add(structures.Frame("beam", a, b, area=1e-3, second_moment=1e-6, **STEEL))
        source = rod.build() if built else rod
        rods.append(planar.FlexibleBody("arm", source, interface={"pin": "a"}, modes=2))
    np.testing.assert_array_equal(rods[0].shapes.displacements, rods[1].shapes.displacements)
