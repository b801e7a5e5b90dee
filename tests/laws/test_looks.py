"""Every element says what it looks like, and every primitive is drawn."""

from __future__ import annotations

import inspect
import re
from importlib import resources

import numpy as np
import pytest
from registry import CASES, model_of
from test_spatial_files import CASES as SPATIAL_CASES, written

import dalembert as da
from dalembert import planar, spatial
from dalembert.elements import look, registry
from dalembert.elements.base import Look
from dalembert.elements.fem.registry import ELEMENTS as ELEMENT_KINDS
from dalembert.elements.point import Point
from dalembert.results.pictures.planar_scene import PlanarPrimitives
from dalembert.results.pictures.primitives import Primitives
from dalembert.results.pictures.scene import motion_scene
from dalembert.results.pictures.spatial_scene import SpatialPrimitives
from dalembert.results.structural.drawing import StructuralDrawing

ELEMENTS = {n: c for table in registry.PLANAR.sections.values() for n, c in table.items()}
PRIMITIVES = {c for _, c in inspect.getmembers(look, inspect.isclass) if issubclass(c, Look)}
SPATIAL = {look.Socket, look.Collar, look.Nut, look.Cross, look.Table, look.Contact}
"""Primitives that no planar element has."""
FLAT = {look.Arrow, look.Twist}
"""Arrows of loads, which all pages draw over the scene."""
PARTS = {look.Segment, look.Ball, look.Disc, look.Block, look.Rail, look.Path}
ABSTRACT = {Look, look.Link, look.Rotary, look.Cells}
STRUCTURAL = {c for c in PRIMITIVES if issubclass(c, look.Cells | look.Support)}
"""Primitives of many finite elements."""


def still(model: da.Model):
    """The start, as a motion."""
    return da.solve_dynamics(model, 1e-6, step=1e-6)


@pytest.mark.few(3)
@pytest.mark.parametrize("name", ELEMENTS)
def test_every_element_looks_like_something(name):
    computed = ELEMENTS[name]
    results = [
        element
        for case in CASES
        for element in model_of(case).parts.elements.values()
        if type(element) is computed
    ]
    if computed is planar.UnilateralConstraint:  # no force, so among no forces
        results = [computed("floor", planar.Particle("ball", mass=1.0).y, restitution=0)]
    if computed is planar.Collisions:
        results = [
            computed("contacts", [planar.contact.Circle(planar.Particle("ball", mass=1.0), 0.1)])
        ]
    assert results or computed is planar.FlexibleBody  # of a structure, see its own laws
    for element in results:
        shown = element.look()
        assert all(isinstance(part, Look) for part in shown)
        assert shown or results[0].not_drawn, "it draws nothing and does not say why"


@pytest.mark.few(10)
@pytest.mark.parametrize("name", CASES)
def test_every_case_can_be_drawn(name):
    motion = still(model_of(name))
    scene = motion_scene(motion, np.arange(motion.time.size))
    drawn = [item for key in ("joints", "links", "symbols") for item in scene[key]]
    assert all({"name", "description", "symbol"} <= item.keys() for item in drawn)
    bodies = {"ground", *(b.name for b in motion.model.bodies)}
    assert {item["body"] for item in drawn if "body" in item} <= bodies
    elements = set(motion.model.parts.elements)
    assert {item["name"] for item in drawn} <= elements
    for item in drawn:
        for key in ("force_x", "at_x", "moment"):
            assert len(item.get(key, motion.time)) == motion.time.size


def test_pages_draw_every_primitive():
    assets = resources.files("dalembert.report") / "assets"
    text = "".join((assets / name).read_text() for name in ("planar_symbols.js", "planar_looks.js"))
    drawn = set(re.findall(r'case "(\w+)"|^  (\w+)\(', text, re.M))
    names = {one or other for one, other in drawn} | {"mark"}  # a mark of no special kind
    wanted = PRIMITIVES - ABSTRACT - PARTS - SPATIAL - FLAT - STRUCTURAL | {look.Support}
    assert {kind.__name__.lower() for kind in wanted} <= names
    assert undrawn(PlanarPrimitives) == STRUCTURAL


def test_pages_of_space_draw_every_primitive():
    """By the tables of solids, where there is one of its name; the rest are shapes and loads."""
    assets = resources.files("dalembert.report") / "assets"
    text = "".join((assets / name).read_text() for name in ("spatial_symbols.js", "solids.js"))
    drawn = set(re.findall(r"^  (\w+): \(|^export function (\w+)", text, re.M))
    drawn = {one or other for one, other in drawn}
    wanted = PRIMITIVES - ABSTRACT - PARTS - FLAT - STRUCTURAL | {look.Support}
    assert {kind.__name__.lower() for kind in wanted} <= drawn
    assert undrawn(SpatialPrimitives) == STRUCTURAL


def test_drawings_of_structures_draw_their_primitives():
    drawn = vars(StructuralDrawing)["draw"].dispatcher.dispatch
    assert {kind for kind in PRIMITIVES if drawn(kind) is not drawn(Look)} >= STRUCTURAL - ABSTRACT
    for kind in ELEMENT_KINDS.values():
        nodes = np.arange(2 * kind.node_count).reshape(2, -1)
        cells = kind.look_of(nodes, np.array([7, 8]))
        assert {type(one) for one in cells} <= STRUCTURAL
        seen = np.unique(np.concatenate([one.vertices.ravel() for one in cells]))
        assert set(seen) == set(nodes.ravel())


@pytest.mark.few(11)
@pytest.mark.parametrize(("section", "name"), SPATIAL_CASES)
def test_every_element_of_space_looks_like_something(section, name, tmp_path):
    if name == "Mesh":
        pytest.importorskip("trimesh")
    path = written(section, name, tmp_path)
    shown, joint = path.look(), vars(path).get("joint")
    assert shown or path.not_drawn, "it draws nothing and does not say why"
    drawn = [vars(kind)["draw"].dispatcher.dispatch for kind in (SpatialPrimitives, Primitives)]
    for part in shown:
        assert any(d(type(part)) is not d(Look) for d in drawn)
        for point in (v for v in vars(part).values() if isinstance(v, Point)):
            assert point.body in {*path.parts(), *(joint.ends() if joint else ())}


def undrawn(primitives: type[Primitives]) -> set[type]:
    """Primitives for which a primitives has no drawing."""
    tables = [vars(kind)["draw"].dispatcher.dispatch for kind in (primitives, Primitives)]
    return {k for k in PRIMITIVES - {Look} if all(d(k) is d(Look) for d in tables)}


def test_places_are_points_whatever_their_dimension():
    """So that a drawing in space is made from the same primitives."""
    for case in CASES:
        for element in model_of(case).parts.elements.values():
            for part in element.look():
                placed = [v for v in vars(part).values() if isinstance(v, Point)]
                assert all(p.dimension == CASES[case].dimension for p in placed)


def test_what_lies_on_a_bar_is_drawn_over_it():
    system = da.System("lever")
    lever = system.add(planar.Bar("lever", length=2.0, mass=1))
    pin = system.add(planar.Bar("pin", length=0.5, mass=1))
    system.add(planar.Revolute("O", system.ground.point(-1, 0), lever.start))
    system.add(planar.PinInSlot("A", lever.center, pin.center))
    scene = motion_scene(still(system.build()), np.array([0]))
    assert [s["kind"] for s in scene["bodies"][0]["shapes"]] == ["bar", "line"]


def slider_with_stop(**limits) -> da.System:
    system = da.System("stopped")
    slider = system.add(planar.Body("slider", mass=1, inertia=1, velocity=(1, 0)))
    system.add(planar.Prismatic("S", system.ground.point(0, 0), slider.center))
    system.add(planar.Stop("stop", slider.x, stiffness=1.0, **limits))
    return system


@pytest.mark.parametrize(("limits", "side"), [({"lower": -0.3}, 1), ({"upper": 0.3}, -1)])
def test_a_wall_stands_where_the_stop_begins(limits, side):
    motion = da.solve_dynamics(slider_with_stop(**limits).build(), 0.1, step=0.01)
    scene = motion_scene(motion, np.arange(motion.time.size))
    (wall,) = scene["symbols"]
    (block,) = [s for s in scene["bodies"][0]["shapes"] if s["kind"] == "block"]
    at = next(iter(limits.values())) - side * block["width"] / 2
    assert np.allclose(wall["at_x"], at) and np.allclose(wall["at_y"], 0)
    assert np.allclose(wall["normal_x"], side)


def test_a_wall_of_an_angle_stands_across_the_limited_way():
    system = da.System("gate")
    gate = system.add(planar.Bar("gate", length=2.0, mass=1, angle=0.1, position=(1, 0)))
    system.add(planar.Revolute("O", system.ground.point(0, 0), gate.start))
    system.add(planar.Stop("stop", gate.angle, upper=np.pi / 2, stiffness=1.0))
    scene = motion_scene(still(system.build()), np.array([0]))
    (wall,) = scene["symbols"]
    assert abs(wall["at_x"][0]) < 1e-9 and 0 < wall["at_y"][0] < 2.0
    assert np.allclose([wall["normal_x"][0], wall["normal_y"][0]], [1, 0])


def test_rotary_looks_stand_on_the_pin_of_their_bodies():
    system = da.System("arm")
    one = system.add(planar.Bar("one", length=1.0, mass=1, position=(0.5, 0)))
    two = system.add(planar.Bar("two", length=1.0, mass=1, position=(1.5, 0)))
    system.add(planar.Revolute("O", system.ground.point(0, 0), one.start))
    system.add(planar.Revolute("A", one.end, two.start))
    system.add(planar.TorsionSpring("k", one, two, stiffness=1.0, damping=0.1))
    system.add(planar.Torque("m", two, 3.0, reaction_on=one))
    scene = motion_scene(still(system.build()), np.array([0, 1]))
    spots = {s["symbol"]: (s["body"], s["point"]) for s in scene["symbols"]}
    assert spots.keys() == {"spiral", "brake", "motor", "twist"}
    elbow = ("two", [-0.5, 0.0])
    assert spots["spiral"] == spots["brake"] == spots["motor"] == elbow
    assert scene["symbols"][-1]["moment"] == [3.0, 3.0]


def test_loads_are_drawn_as_they_are():
    system = da.System("pushed")
    bar = system.add(planar.Bar("bar", length=1.0, mass=1, angle=np.pi / 2))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    system.add(planar.Force("dead", bar.end, (1.0, 2.0)))
    system.add(planar.Force("follower", bar.end, (1.0, 2.0), following=True))
    scene = motion_scene(still(system.build()), np.array([0]))
    loads = {s["name"]: (s["force_x"][0], s["force_y"][0]) for s in scene["symbols"]}
    assert np.allclose(loads["dead"], (1, 2)) and np.allclose(loads["follower"], (-2, 1))


@pytest.mark.parametrize("ratio", [0.5, -2.0])
def test_wheels_of_a_belt_have_its_ratio(ratio):
    system = da.System("belt")
    ground = system.ground
    wheels = []
    for k in (0, 1):
        wheel = system.add(planar.Body(f"w{k}", mass=1, inertia=1, position=(k, 0)))
        system.add(planar.Revolute(f"O{k}", ground.point(k, 0), wheel.center))
        wheels.append(wheel)
    system.add(planar.Coupling("belt", *wheels, ratio=ratio))
    scene = motion_scene(still(system.build()), np.array([0]))
    (belt,) = [joint for joint in scene["joints"] if joint["symbol"] == "belt"]
    one, two = (w["radius"] for w in belt["wheels"])
    assert one / two == pytest.approx(abs(ratio)) and one + two < 1.0
    assert belt["crossed"] == (ratio < 0)


def wheels() -> tuple[da.System, list]:
    """Two wheels on parallel hinges."""
    system, axis, hinges = da.System("wheels"), (0, 1, 0), []
    for k in range(2):
        arguments = {"mass": 1, "inertia": (1, 1, 1), "position": (k, 0, 0)}
        wheel = system.add(spatial.Body(f"w{k}", **arguments))
        seat = system.ground.frame((k, 0, 0), axis=axis)
        hinge = spatial.Revolute(f"O{k}", seat, wheel.frame((0, 0, 0), axis=axis))
        hinges.append(system.add(hinge))
    return system, hinges


@pytest.mark.parametrize("ratio", [0.5, -2.0])
def test_wheels_of_a_belt_in_space_have_its_ratio(ratio):
    system, hinges = wheels()
    system.add(spatial.Coupling("belt", *hinges, ratio=ratio))
    scene = motion_scene(still(system.build()), np.array([0]))
    (belt,) = [joint for joint in scene["joints"] if joint["symbol"] == "belt"]
    one, two = (w["radius"] for w in belt["wheels"])
    assert one / two == pytest.approx(abs(ratio)) and one + two < 1.0
    assert belt["crossed"] == (ratio < 0)
    assert [w["body"] for w in belt["wheels"]] == ["w0", "w1"]


def test_gears_in_space_are_discs_in_mesh():
    system, hinges = wheels()
    system.add(spatial.GearPair("G", *hinges, radius_i=0.4, radius_j=0.6))
    scene = motion_scene(still(system.build()), np.array([0]))
    discs = [s for body in scene["bodies"] for s in body["shapes"] if s["kind"] == "disc"]
    assert [disc["radius"] for disc in discs] == [0.4, 0.6]
    (mesh,) = [joint for joint in scene["joints"] if joint["symbol"] == "mesh"]
    assert {w["body"]: w["radius"] for w in mesh["mesh"]} == {"w0": 0.4, "w1": 0.6}


def test_a_wall_in_space_stands_where_the_stop_begins():
    system = da.System("stopped")
    ball = system.add(spatial.Particle("ball", mass=1, velocity=(1, 0, 0)))
    system.add(spatial.Stop("stop", ball.x, upper=0.3, stiffness=1.0))
    (wall,) = motion_scene(still(system.build()), np.array([0]))["symbols"]
    assert np.allclose([wall[f"at_{axis}"][0] for axis in "xyz"], (0.3, 0, 0))
    assert np.allclose([wall[f"normal_{axis}"][0] for axis in "xyz"], (-1, 0, 0))


def test_rams_in_sliding_joints_are_cylinders_in_space_too():
    system, along = da.System("ram"), {"axis": (1, 0, 0), "x": (0, 0, 1)}
    slab = system.add(spatial.Box("slab", size=(0.3, 0.1, 0.1), density=800, position=(0.5, 0, 0)))
    rail = spatial.Prismatic("P", system.ground.frame((0, 0, 0), **along), slab.frame(**along))
    system.add(rail)
    system.add(spatial.JointActuator("ram", rail, 3.0))
    (link,) = motion_scene(still(system.build()), np.array([0]))["links"]
    assert link["symbol"] == "cylinder" and link["i"]["body"] == "ground"
