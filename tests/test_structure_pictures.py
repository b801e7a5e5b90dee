"""Pictures of structures: the right things in the right places, whatever they come from."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import pytest

import dalembert as da
from dalembert import structures
from dalembert.elements.fem.registry import ELEMENTS
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.scene import automatic_scale, load_symbols, support_symbols
from dalembert.results.structural.states import element_field, smoothed

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import LineCollection, PolyCollection

STEEL = {"modulus": 210e9}
BEAM = {"area": 5e-3, "second_moment": 6e-5, **STEEL}


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


def cantilever(angle: float = 0.0) -> da.Structure:
    """A beam of 2 m at an angle, a force across its end and a moment."""
    structure = da.Structure("cantilever")
    ends = structure.node("a", 0, 0), structure.node("b", 2 * np.cos(angle), 2 * np.sin(angle))
    structure.add(structures.Frame("beam", *ends, **BEAM))
    structure.support(ends[0])
    force = -1e4 * np.array([-np.sin(angle), np.cos(angle)])
    structure.load(ends[1], fx=force[0], fy=force[1])
    structure.load(ends[1], "twist", mz=3e4)
    return structure


def plate() -> da.Structure:
    structure = da.Structure("plate")
    mesh = structure.add_mesh(
        "plate", structures.rectangle_mesh((2, 1), (4, 2)), thickness=0.01, **STEEL
    )
    structure.support(mesh.nodes().where(x=0))
    structure.load(mesh.nodes().where(x=2), fy=-1e3)
    return structure


def box() -> da.Structure:
    structure = da.Structure("box")
    mesh = structure.add_mesh("box", structures.box_mesh((2, 1, 1), (3, 2, 2)), **STEEL)
    structure.support(mesh.nodes().where(x=0))
    structure.load(mesh.nodes().where(x=2), fz=-1e3)
    return structure


def springs() -> da.Structure:
    structure = da.Structure("springs")
    nodes = [structure.node(f"n{k}", k) for k in range(3)]
    for name, i, j in (("s1", 0, 1), ("s2", 1, 2), ("long", 0, 2)):
        structure.add(structures.AxialSpring(name, nodes[i], nodes[j], stiffness=100.0))
    structure.support(nodes[0])
    structure.load(nodes[2], fx=3.0)
    return structure


BUILDERS = {"beam": cantilever, "plate": plate, "box": box, "springs": springs}


def solved(name: str):
    return da.solve_statics(BUILDERS[name]().build())


def collections(ax, kind) -> list:
    return [c for c in ax.collections if type(c) is kind]


# geometry -----------------------------------------------------------------------------------
@pytest.mark.parametrize("case", ["", "twist"])
@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
def test_beams_are_drawn_as_they_bend(angle: float, case: str) -> None:
    result = da.solve_statics(cantilever(angle).build())
    drawing = StructuralDrawing(result.model, result.parameters)
    moved = drawing.displaced(result.displacements[:, result.case(case)])
    curve = drawing.lines[0].vertices[0]
    axis = np.array([np.cos(angle), np.sin(angle)])
    x = drawing.rest[curve, :2] @ axis
    across = moved[curve, :2] @ np.array([-axis[1], axis[0]])
    rigidity = STEEL["modulus"] * BEAM["second_moment"]
    expected = -1e4 * x**2 * (6 - x) / (6 * rigidity) if not case else 3e4 * x**2 / (2 * rigidity)
    np.testing.assert_allclose(across, expected, atol=1e-12)
    np.testing.assert_allclose(moved[curve, :2] @ axis, 0, atol=1e-12)


def test_a_beam_bent_to_half_a_circle_keeps_its_ends_and_tangents() -> None:
    structure = da.Structure("arc")
    count = 24  # elements keep the length of their chord, not of their arc
    nodes = [structure.node(f"n{k}", k / count, 0) for k in range(count + 1)]
    for k in range(count):
        structure.add(structures.Frame(f"f{k}", nodes[k], nodes[k + 1], **BEAM))
    structure.support(nodes[0])
    structure.load(nodes[-1], mz=np.pi * STEEL["modulus"] * BEAM["second_moment"])
    result = da.solve_statics(structure.build(), nonlinear=True, steps=20)
    drawing = StructuralDrawing(result.model, result.parameters)
    moved = drawing.displaced(result.displacements[:, 0], result.large)
    places = drawing.rest + moved
    radius = np.linalg.norm(places[:, :2] - [0, 1 / np.pi], axis=1)
    np.testing.assert_allclose(radius, 1 / np.pi, rtol=2e-3)


def test_faces_inside_a_solid_are_left_out() -> None:
    result = solved("box")
    drawing = StructuralDrawing(result.model, result.parameters)
    assert sum(len(s.elements) for s in drawing.faces) == 2 * (3 * 2 + 3 * 2 + 2 * 2)
    assert len(drawing.outline()) == 4 * (3 + 2 + 2)  # the edges of the box


def test_springs_beside_one_another_do_not_overlap() -> None:
    result = solved("springs")
    drawing = StructuralDrawing(result.model, result.parameters)
    heights = [drawing.rest[line][:, 1] for shape in drawing.lines for line in shape.vertices]
    assert heights[0].max() < heights[2].max() / 2
    moved = drawing.displaced(result.displacements[:, 0])
    ends = drawing.lines[0].vertices[:, [0, -1]]
    expected = np.array([[0, 1], [1, 2], [0, 2]])
    np.testing.assert_allclose(moved[ends, 0], result.displacements[:, 0][expected], atol=1e-15)


@pytest.mark.parametrize("cls", list(ELEMENTS.values()), ids=list(ELEMENTS))
def test_every_element_is_drawn(cls) -> None:
    """As lines, faces or points with the displacements of its nodes."""
    dimension = max(cls.dimensions)
    structure = da.Structure("one")
    cell = getattr(cls, "cell", None)
    rng = np.random.default_rng(1)
    places = np.array(cell.nodes) if cell else rng.random((cls.node_count, dimension))
    nodes = structure.add_nodes("n", places)
    scalar = [f.name for f in cls.quantity_fields() if f.metadata["size"] == 1]
    numbers = dict.fromkeys(scalar, 0.3)
    structure.add_elements("e", cls, nodes, [list(range(cls.node_count))], **numbers)
    model = structure.build()
    drawing = StructuralDrawing(model, model.nominal)
    u = rng.random(len(model.degrees))
    moved = drawing.displaced(u)
    np.testing.assert_allclose(drawing.nodes[:, :dimension], places)
    np.testing.assert_allclose(
        moved[: cls.node_count, :dimension], u[model.degrees.table[:, :dimension]]
    )
    assert drawing.lines or drawing.faces or drawing.points


# scale ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("force", [1.0, 3.7e3, 2.1e5])
def test_scale_is_round_and_shows(force: float) -> None:
    structure = cantilever()
    structure.loads.clear()
    structure.load(structure.nodes["b"], fy=-force)
    result = da.solve_statics(structure.build())
    drawing = StructuralDrawing(result.model, result.parameters)
    moved = drawing.displaced(result.displacements[:, 0])
    scale = automatic_scale(drawing, moved)
    assert f"{scale:e}"[0] in "125"
    assert set(f"{scale:e}".split("e")[0]) <= set("125.0")
    shown = scale * np.abs(moved).max() / drawing.extent
    assert 0.02 <= shown <= 0.11


def test_large_displacements_are_drawn_as_they_are() -> None:
    result = da.solve_statics(cantilever().build())
    drawing = StructuralDrawing(result.model, result.parameters)
    assert automatic_scale(drawing, np.full_like(drawing.rest, 0.1)) == 1.0
    assert automatic_scale(drawing, np.zeros_like(drawing.rest)) == 1.0


# pictures -------------------------------------------------------------------------------------
@pytest.mark.few(4)
@pytest.mark.parametrize("name", list(BUILDERS))
@pytest.mark.parametrize("smooth", [False, True])
def test_pictures_tell_scale_and_unit(name: str, smooth: bool) -> None:
    result = solved(name)
    field = {"beam": "moment_i", "plate": "von_mises", "box": "box.von_mises"}.get(name, "force")
    ax = result.draw(field, smooth=smooth)
    assert result.model.name in ax.get_title("left")
    bar = ax.figure.axes[1]
    ax.figure.canvas.draw()
    unit = {"beam": "N m", "springs": "N"}.get(name, "Pa")
    assert field in bar.get_ylabel()
    assert all(label.get_text().endswith(unit) for label in bar.get_yticklabels())
    assert (ax.name == "3d") == (name == "box")


def test_a_plate_has_a_face_for_every_element() -> None:
    result = solved("plate")
    ax = result.draw("plate.sxx", scale=0)
    (faces,) = collections(ax, PolyCollection)
    assert len(faces.get_paths()) == 8
    colours = faces.get_facecolor()
    sxx = result.field("plate.sxx")
    hot, cold = colours[np.argmax(sxx)], colours[np.argmin(sxx)]
    assert hot[0] > hot[2]  # tension red, compression blue
    assert cold[2] > cold[0]
    assert "displacements × 0" in ax.get_title("left")


def test_undeformed_may_be_left_out() -> None:
    result = solved("beam")
    both, alone = result.draw(), result.draw(undeformed=False)
    assert len(collections(both, LineCollection)) == len(collections(alone, LineCollection)) + 1
    (line,) = collections(alone, LineCollection)
    end = line.get_paths()[0].vertices[-1]
    assert end[1] < -0.01


def test_pictures_go_into_given_axes() -> None:
    figure, axes = plt.subplots(1, 2)
    assert solved("beam").draw(ax=axes[1]) is axes[1]
    assert not axes[0].collections
    assert len(figure.axes) == 2


def test_one_case_of_several() -> None:
    result = solved("beam")
    assert "twist" in result.draw(case="twist").get_title("left")
    assert result.draw(case=-1).get_title("left") == result.draw(case="twist").get_title("left")
    for case in ("wind", 2):
        with pytest.raises(da.AnalysisError, match="no load case"):
            result.draw(case=case)


def test_modes_buckling_and_motion_are_drawn_too() -> None:
    structure = da.Structure("column")
    nodes = [structure.node(f"n{k}", 0, k) for k in range(4)]
    for k in range(3):
        structure.add(structures.Frame(f"f{k}", nodes[k], nodes[k + 1], density=7850, **BEAM))
    structure.support(nodes[0])
    structure.load(nodes[3], fy=-1e3)
    model = structure.build()
    modes, buckling = da.Modal(count=2).run(model), da.Buckling(count=1).run(model)
    assert "mode 2" in modes.draw("displacement", 2).get_title("left")
    assert "mode 1" in buckling.draw().get_title("left")
    motion = da.Dynamics(duration=0.1, step=0.01).run(model)
    assert "0.1 s" in motion.draw("moment_i", case=-1).get_title("left")


# symbols --------------------------------------------------------------------------------------
def test_supports_lie_outside() -> None:
    structure = da.Structure("frame")
    places = {"left": (0, 0), "right": (4, 0), "top": (2, 3)}
    nodes = {name: structure.node(name, *at) for name, at in places.items()}
    for k, (i, j) in enumerate((("left", "top"), ("top", "right"), ("left", "right"))):
        structure.add(structures.Truss(f"b{k}", nodes[i], nodes[j], area=1e-3, **STEEL))
    structure.support(nodes["left"])
    structure.support(nodes["right"], uy=0)
    structure.load(nodes["top"], fy=-1e3)
    model = structure.build()
    drawing = StructuralDrawing(model, model.nominal)
    left, right = support_symbols(drawing)
    assert (left["nodes"], left["axis"], left["roller"]) == ([0], [0, -1], False)
    assert (right["nodes"], right["axis"], right["roller"]) == ([1], [0, -1], True)
    assert not (left["clamp"] or right["clamp"])
    (arrow,) = load_symbols(drawing, model.loads[""].values(model.nominal)[:, None])
    assert arrow["node"] == 2
    assert (*arrow["force_x"], *arrow["force_y"]) == (0, -1e3)
    assert all(arrow["inward"])


def test_an_edge_is_held_on_one_side() -> None:
    result = solved("plate")
    drawing = StructuralDrawing(result.model, result.parameters)
    (support,) = support_symbols(drawing)
    assert support["axis"] == [-1, 0]
    assert len(support["nodes"]) == 3
    assert len(load_symbols(drawing, result.applied(0)[:, None])) == 3


def test_a_face_is_held_from_outside() -> None:
    result = solved("box")
    (support,) = support_symbols(StructuralDrawing(result.model, result.parameters))
    assert support["axis"] == [-1, 0, 0]
    assert len(support["nodes"]) == 9


def test_moments_have_a_symbol() -> None:
    result = solved("beam")
    drawing = StructuralDrawing(result.model, result.parameters)
    (twist,) = load_symbols(drawing, result.applied(1)[:, None])
    assert (twist["symbol"], twist["node"]) == ("twist", 1)
    assert twist["moment"] == pytest.approx(3e4)
    assert [text.get_text() for text in result.draw(case="twist").texts] == [r"$\circlearrowleft$"]


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
def test_moments_are_drawn_on_the_side_in_tension(angle: float) -> None:
    result = da.solve_statics(cantilever(angle).build())
    scene = result.page()["scene"]
    (row,) = (row for row in scene["diagrams"] if row["name"] == "moment")
    start, end = (row["sign"] * result["beam.moment_i"][0], result["beam.moment_j"][0])
    assert (abs(start), end) == (pytest.approx(2e4), pytest.approx(0, abs=1e-6))
    load = -np.array([-np.sin(angle), np.cos(angle), 0])
    np.testing.assert_allclose(start / 2e4 * row["across"], -load, atol=1e-9)


@pytest.mark.parametrize("direction", ["y", "z"])
@pytest.mark.parametrize("end", [(2, 0, 0), (0, 0, 2), (1, 1, 1)])
def test_moments_in_space_are_drawn_on_the_side_in_tension(direction: str, end: tuple) -> None:
    structure = da.Structure("arm")
    root, tip = structure.node("root", 0, 0, 0), structure.node("tip", *end)
    profile = {"second_moment_y": 1e-6, "second_moment_z": 2e-6, "torsion_constant": 1e-6}
    profile |= {"area": 1e-3, "modulus": 210e9, "shear_modulus": 80e9}
    structure.add(structures.SpaceFrame("arm", root, tip, **profile))
    structure.support(root)
    rows = da.solve_statics(structure.build()).page()["scene"]["diagrams"]
    (load,) = (row["across"] for row in rows if row["name"] == f"shear {direction}")
    structure.load(tip, **dict(zip(("fx", "fy", "fz"), load, strict=True)))
    result = da.solve_statics(structure.build())
    name = {"y": "moment z", "z": "moment y"}[direction]
    (row,) = (row for row in rows if row["name"] == name)
    start = row["sign"] * result[f"arm.{row['start']}"]
    np.testing.assert_allclose(start * row["across"], -np.linalg.norm(end) * load, atol=1e-9)


# fields -----------------------------------------------------------------------------------------
def test_fields_are_the_measures_one_by_one() -> None:
    result = solved("plate")
    field = result.field("plate.sxx")
    assert field.tolist() == [result[f"plate[{k}].sxx"] for k in range(8)]
    assert field.max() == result["plate.sxx.max"]
    assert result.field("plate[3].sxx").tolist() == [field[3]]


def test_displacements_of_selections() -> None:
    result = solved("plate")
    nodes = result.model.structure.nodes["plate_nodes"]
    right = nodes.where(x=2)
    displacements = result.displacement_of(right)
    assert displacements[:, 1].tolist() == [result[f"{name}.uy"] for name in right.names]
    beam = solved("beam")
    end = beam.model.structure.nodes["b"]
    assert beam.displacement_of(end, "twist")[0, 1] == beam["b.uy"][1]


def test_smoothing_keeps_what_is_constant() -> None:
    result = solved("plate")
    drawing = StructuralDrawing(result.model, result.parameters)
    field = element_field(drawing, result.state(0), "mass")
    ones = smoothed(drawing, type(field)("one", "", np.ones_like(field.values)))
    np.testing.assert_allclose(ones.values, 1.0)


@pytest.mark.parametrize(
    ("field", "words"), [("plate.von_mise", "plate.von_mises"), ("stresss", "sxx|nearest|stress")]
)
def test_unknown_fields_are_told(field: str, words: str) -> None:
    result = solved("plate")
    for ask in (result.field, result.draw):
        with pytest.raises(da.AnalysisError, match=f"{field}.*({words})"):
            ask(field)
