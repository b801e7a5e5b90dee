"""Drawings as mechanisms: random linkages, slots, plates, marks, labels and near misses."""

from __future__ import annotations

import math
import string

import numpy as np
import pytest
from drawings import RADIUS, Linkage, bar_ends
from hypothesis import HealthCheck, assume, given, settings, strategies as st

import dalembert as da
from dalembert.io.imports.registry import import_model

ezdxf = pytest.importorskip("ezdxf")
TIMES = [0.0, 0.01, 0.02]
coordinates = st.floats(100.0, 900.0).map(lambda x: round(x, 3))
points = st.tuples(coordinates, coordinates).map(np.array)


@st.composite
def linkages(draw) -> Linkage:
    """A driven crank and pairs of bars, each of which fixes a new pin to two others."""
    linkage = Linkage(pins=draw(st.lists(points, min_size=2, max_size=3)), fixed=0)
    linkage.fixed = len(linkage.pins)
    names = (f"rod_{letter}" for letter in string.ascii_lowercase)
    linkage.pins.append(draw(points))
    linkage.bars[next(names)] = (0, linkage.fixed)
    for _ in range(draw(st.integers(1, 3))):
        first, second = draw(
            st.lists(st.integers(0, len(linkage.pins) - 1), min_size=2, max_size=2, unique=True)
        )
        assume(first >= linkage.fixed or second >= linkage.fixed)
        linkage.pins.append(draw(points))
        for end in (first, second):
            linkage.bars[next(names)] = (end, len(linkage.pins) - 1)
    used = {pin for ends in linkage.bars.values() for pin in ends}
    assume(used == set(range(len(linkage.pins))) and linkage.is_clear())
    return linkage


def is_well_posed(linkage: Linkage) -> bool:
    """Whether the pairs of bars are far from their singular positions."""
    names = list(linkage.bars)
    for first, second in zip(names[1::2], names[2::2], strict=True):
        a, b = (
            np.diff([linkage.pins[k] for k in linkage.bars[n]], axis=0)[0] for n in (first, second)
        )
        cross = a[0] * b[1] - a[1] * b[0]
        if abs(cross) < 0.3 * np.linalg.norm(a) * np.linalg.norm(b):
            return False
    return True


@pytest.mark.thorough
@settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck))
@given(linkages(), st.booleans(), st.lists(st.booleans(), max_size=7), st.sampled_from([1.0, 0.04]))
def test_random_linkages(tmp_path_factory, linkage, is_dxf, turned, scale) -> None:
    """The degrees of freedom and the motion of pins are those of the linkage built by hand."""
    assume(is_well_posed(linkage))
    folder = tmp_path_factory.mktemp("drawing")
    if is_dxf:
        path = linkage.dxf(
            folder / "drawing.dxf", short=RADIUS * turned.count(True) / 8, turned=turned
        )
    else:
        path = linkage.svg(folder / "drawing.svg", scale=scale)
    imported = import_model(path, speed="1 rad/s")
    assert all("crosses" in omission.content for omission in imported.omissions)
    model, twin = imported.build(), linkage.system().build()
    names = list(linkage.bars)
    assert [body.name for body in model.bodies] == names
    assert model.diagnosis.degrees_of_freedom == twin.diagnosis.degrees_of_freedom
    ends, expected = (bar_ends(each, names, TIMES) for each in (model, twin))
    np.testing.assert_allclose(ends, expected, rtol=0, atol=2e-6)
    written = da.load_model(imported.write(folder / "drawing.toml")).build()
    assert np.array_equal(bar_ends(written, names, TIMES), ends)


# drawings by hand ------------------------------------------------------------------------------
def drawing(tmp_path, *entities: str, body: str = ""):
    """An SVG of 200 by 100 mm with y upwards, from short texts of lines, circles and labels."""
    rows = []
    for entity in entities:
        kind, *words = entity.split()
        options = " ".join(w for w in words if "=" in w)
        plain = [w for w in words if "=" not in w]
        if kind == "line":
            rows.append(f'<polyline points="{" ".join(plain)}" {options}/>')
        elif kind == "text":
            x, y, *text = plain
            content = " ".join(text)
            rows.append(
                f'<text x="{x}" y="{-float(y)}" transform="scale(1 -1)" font-size="4" '
                f'text-anchor="middle" {options}>{content}</text>'
            )
        else:
            x, y, r = plain
            fill = "" if "fill=" in options else 'fill="white"'
            rows.append(f'<circle cx="{x}" cy="{y}" r="{r}" {fill} {options}/>')
    path = tmp_path / "drawn.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="100mm" '
        'viewBox="0 0 200 100"><g transform="matrix(1 0 0 -1 0 100)">'
        f"{''.join(rows)}{body}</g></svg>",
        encoding="utf-8",
    )
    return path


def reasons(imported) -> list[str]:
    return [f"{omission.content}: {omission.reason}" for omission in imported.omissions]


FOUR_BAR = (
    "line 20,20 30,60",
    "line 30,60 120,70",
    "line 120,70 100,20",
    "circle 20 20 2 class='ground'",
    "circle 30 60 2",
    "circle 120 70 2",
    "circle 100 20 2 class='ground'",
)


def test_labels_name_bars_and_pins(tmp_path) -> None:
    path = drawing(
        tmp_path,
        *FOUR_BAR,
        "text 22 40 crank",
        "text 75 70 long coupler",
        "text 33 66 A",
        "text 20 14 motor 90 deg/s",
        "text 117 45 3",
    )
    imported = import_model(path)
    document = imported.document
    assert list(document["bodies"]) == ["crank", "long_coupler", "bar1"]
    assert document["joints"]["A"]["connect"] == ["crank.end", "long_coupler.start"]
    assert document["parameters"]["speed"]["value"] == 90
    assert document["parameters"]["speed"]["unit"] == "deg/s"
    assert document["drivers"]["motor"]["joint"] == "O1"
    assert imported.build().diagnosis.degrees_of_freedom == 1
    lengths = document["parameters"]["crank"], document["parameters"]["long_coupler"]
    assert [length["value"] for length in lengths] == pytest.approx(
        [math.hypot(10, 40), math.hypot(90, 10)], abs=1e-6
    )
    assert not imported.omissions


@pytest.mark.parametrize(
    "ground",
    [
        ["circle 20 20 2 fill='black'", "circle 100 20 2 fill='#333'"],
        ["circle 20 20 2", "circle 20 20 4", "circle 100 20 2", "circle 100 20 3.5"],
        ["circle 20 20 2", "circle 100 20 2", "text 20 14 ground", "text 100 14 Fixed"],
        ["circle 20 20 2", "circle 100 20 2", "line 20,20 100,20 class='frame'"],
        ["circle 20 20 2 id='ground-left'", "circle 100 20 2 class='x-ground'"],
        ["circle 20 20 2", "circle 100 20 2"],
    ],
)
def test_marks_of_fixed_pins(tmp_path, ground) -> None:
    moving = [entity for entity in FOUR_BAR if "ground" not in entity]
    imported = import_model(drawing(tmp_path, *moving, *ground))
    assert len(imported.document["ground"]["points"]) == 2
    diagnosis = imported.build().diagnosis
    assert diagnosis.degrees_of_freedom == 1
    assert len(imported.omissions) == (
        2 if len(ground) == 2 and "fill" not in str(ground) and "class" not in str(ground) else 0
    )


def test_slider_crank_with_a_block_and_with_a_pin(tmp_path) -> None:
    """The stroke is twice the crank; block and pin move alike."""
    crank = (
        "line 40,50 50,50",
        "line 50,50 90,50",
        "circle 40 50 2 fill='black'",
        "circle 50 50 2",
        "circle 90 50 2",
    )
    slot = "line 60,50 120,50 class='slot'"
    block = "line 84,46 96,46 96,54 84,54 84,46 class='piston' id='piston'"
    motor = "text 40 42 motor 60 rpm"
    for extra, bodies in (((slot,), 2), ((slot, block), 3), ((block,), 3)):
        imported = import_model(drawing(tmp_path, *crank, *extra, motor))
        model = imported.build()
        assert len(model.bodies) == bodies
        assert model.diagnosis.degrees_of_freedom == 1
        motion = da.solve_kinematics(model, 1.0, outputs=41)
        x = motion["bar2.end.x"].values
        assert x[0] == pytest.approx(0.09, abs=1e-9)
        assert np.ptp(x) == pytest.approx(0.02, abs=1e-9)


def test_slotted_levers(tmp_path) -> None:
    """A lever on the layer of slots, and a bar with a slot drawn over it."""
    crank = (
        "line 40,60 50,70",
        "circle 40 60 2 fill='black'",
        "circle 50 70 2",
        "circle 40 20 2 fill='black'",
        "text 40 52 motor",
    )
    end = (40 + 1.5 * 10, 20 + 1.5 * 50)
    lever = f"line 40,20 {end[0]},{end[1]}"
    slot = "line 46,50 54,90 class='slot'"
    for extra in ((f"{lever} class='slot'",), (lever, slot)):
        imported = import_model(drawing(tmp_path, *crank, *extra))
        assert sorted(j["type"] for j in imported.document["joints"].values()) == [
            "PinInSlot",
            "Revolute",
            "Revolute",
        ]
        model = imported.build()
        assert model.diagnosis.degrees_of_freedom == 1
        motion = da.solve_kinematics(model, 1.0, outputs=9)
        pin = [motion[f"bar1.end.{axis}"].values for axis in "xy"]
        angle = np.arctan2(pin[1] - 0.02, pin[0] - 0.04)
        np.testing.assert_allclose(motion["bar2.angle"], angle, atol=1e-8)


def test_plates_of_closed_lines_and_groups(tmp_path) -> None:
    """A triangle of one polygon, of three lines in a group, and of three bars move alike."""
    frame = (
        "line 20,20 30,60",
        "line 120,70 100,20",
        "circle 20 20 2 fill='black'",
        "circle 30 60 2",
        "circle 120 70 2",
        "circle 100 20 2 fill='black'",
        "circle 70 90 2",
        "text 20 12 motor",
    )
    corners = [(30, 60), (120, 70), (70, 90)]
    sides = [
        f'<line x1="{a[0]}" y1="{a[1]}" x2="{b[0]}" y2="{b[1]}"/>'
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    polygon = '<polygon id="plate" points="30 60 120 70 70 90"/>'
    group = f'<g id="plate">{"".join(sides)}</g>'
    paths = []
    for body, count in ((polygon, 3), (group, 3), ("".join(sides), 5)):
        model = import_model(drawing(tmp_path, *frame, body=body)).build()
        assert len(model.bodies) == count
        assert model.diagnosis.degrees_of_freedom == 1
        name = "plate" if count == 3 else "bar5"
        points = list(model.bodies[[b.name for b in model.bodies].index(name)].points)
        point = "P1" if "P1" in points else points[0]
        motion = da.solve_kinematics(model, 0.05, outputs=4)
        paths.append([motion[f"{name}.{point}.{axis}"].values for axis in "xy"])
    np.testing.assert_allclose(paths[0], paths[1], atol=1e-9)
    assert paths[0][0][0] == pytest.approx(0.07) and paths[0][1][0] == pytest.approx(0.09)


def test_rigid_corners_and_crossings(tmp_path) -> None:
    """Ends that meet without a circle are one part; crossing lines are not joined."""
    bell_crank = ("line 20,20 60,20", "line 60,20 60,80", "circle 20 20 2 fill='black'")
    crossing = ("line 40,50 100,52", "circle 40 50 2 fill='black'")
    imported = import_model(drawing(tmp_path, *bell_crank, *crossing))
    assert sorted(body["type"] for body in imported.document["bodies"].values()) == ["Bar", "Body"]
    assert any("crosses" in text and "(60, 50.67)" in text for text in reasons(imported))
    assert imported.build().diagnosis.degrees_of_freedom == 2
    plate = next(b for b in imported.document["bodies"].values() if b["type"] == "Body")
    inertia = float(plate["inertia"].removeprefix("rho*").split()[0])
    masses, lengths = np.array([40.0, 60.0]), np.array([40.0, 60.0])
    centers = np.array([[40, 20], [60, 50]])
    middle = masses @ centers / 100
    steiner = masses @ ((centers - middle) ** 2).sum(axis=1)
    assert inertia == pytest.approx((masses * lengths**2 / 12).sum() + steiner)


def test_what_is_not_converted_is_listed(tmp_path) -> None:
    imported = import_model(
        drawing(
            tmp_path,
            *FOUR_BAR,
            "line 30,60 120,70",
            "line 50,10 50,10.01",
            "circle 180 90 2",
            "line 150,40 150,80 class='construction'",
            "text 180 20 2026-11",
            "line 140,10 122.6,68",
            body='<path d="M10 90 C 20 95 30 80 40 90"/><image href="http://example.org/a.png"/>'
            '<use href="#crank"/><ellipse cx="150" cy="20" rx="5" ry="2"/>'
            '<circle cx="160" cy="10" r="2" display="none"/>',
        )
    )
    texts = "\n".join(reasons(imported))
    for expected in (
        "is drawn twice",
        "no length within the tolerance",
        "circle on no line; the nearest one is",
        "its layer or group is no part of the mechanism",
        "'2026-11'",
        "mm from the circle at (120, 70)",
        "is a curve",
        "<image>",
        "<use>",
        "is an ellipse",
        "is hidden",
    ):
        assert expected in texts, expected


def test_units(tmp_path) -> None:
    """Pixels, inches, the unit of a DXF header, and units in place of these."""
    path = drawing(tmp_path, *FOUR_BAR)
    text = path.read_text("utf-8")

    def length(content: str, **options) -> float:
        path.write_text(content, encoding="utf-8")
        model = import_model(path, **options).build()
        return float(model.parameters["bar1"].value)

    expected = math.hypot(10, 40)
    sizes = 'width="200mm" height="100mm"'
    assert length(text) == pytest.approx(expected / 1000)
    assert length(text.replace(sizes, 'width="20cm" height="10cm"')) == pytest.approx(
        expected / 1000
    )
    assert length(text.replace(sizes, "")) == pytest.approx(expected * 0.0254 / 96)
    assert length(text.replace(sizes, 'width="200" height="100"'), unit="in") == pytest.approx(
        expected * 0.0254
    )
    linkage = Linkage([np.array([0.0, 0.0]), np.array([30.0, 0.0])], 1, {"arm": (0, 1)})
    file = linkage.dxf(tmp_path / "arm.dxf")
    for code, metres in ((1, 0.0254), (5, 0.01), (6, 1.0)):
        document = ezdxf.readfile(file)
        document.header["$INSUNITS"] = code
        document.saveas(file)
        assert import_model(file).build().parameters["arm"].value == pytest.approx(30 * metres)
    document.header["$INSUNITS"] = 0
    document.saveas(file)
    imported = import_model(file)
    assert "$INSUNITS = 0" in reasons(imported)[0]
    assert import_model(file, unit="ft").build().parameters["arm"].value == pytest.approx(9.144)


# files of drawing programs ---------------------------------------------------------------------
ARM = '<circle id="ground" cx="10" cy="10" r="2"/><line x1="10" y1="10" x2="50" y2="10"/>'
PAGE = '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="60mm" viewBox="0 0 90 60">'


@pytest.mark.parametrize(
    "content",
    [
        f'<defs><g id="g1">{ARM}</g></defs><use href="#g1" x="3" transform="translate(-3)"/>',
        f'<symbol id="g1">{ARM}</symbol><use href="#g1"/>',
        f'<symbol id="g1" viewBox="0 0 90 60">{ARM}</symbol>'
        '<use href="#g1" transform="translate(0 0)"/>',
        f'<svg x="5" y="4" width="45" height="30" viewBox="10 8 90 60">{ARM}</svg>',
        f"<switch><foreignObject/><g>{ARM}</g></switch>",
    ],
)
def test_clones_symbols_and_nested_pages(tmp_path, content) -> None:
    path = tmp_path / "drawn.svg"
    path.write_text(f"{PAGE}{content}</svg>", encoding="utf-8")
    imported = import_model(path)
    scale = 0.5 if "<svg x" in content else 1.0
    length = imported.document["parameters"]["bar1"]
    assert (length["value"], length["unit"]) == (pytest.approx(40 * scale), "mm")
    assert imported.build().diagnosis.degrees_of_freedom == 1
    expected = ["<foreignObject>"] if "switch" in content else []
    assert [omission.content for omission in imported.omissions] == expected


def test_clones_of_clones_end(tmp_path, capsys) -> None:
    """A clone of itself is listed; ten clones of ten clones, eight deep, are refused."""
    path = tmp_path / "drawn.svg"
    path.write_text(f'{PAGE}{ARM}<g id="a"><use href="#a"/></g></svg>', encoding="utf-8")
    assert [o.content for o in import_model(path).omissions] == ["<use>"]
    inner = [f'<use href="#a{k}"/>' * 10 for k in range(7)]
    groups = "".join(f'<g id="a{k}">{clones}</g>' for k, clones in enumerate(inner, 1))
    text = f'{PAGE}<defs><g id="a0">{ARM}</g>{groups}</defs><use href="#a7"/></svg>'
    path.write_text(text, encoding="utf-8")
    with pytest.raises(da.DalembertError, match="more than"):
        import_model(path)


def four_bar(space, shape: str, layers=("crank", "coupler", "rocker")) -> None:
    corners = [(0, 0), (30, 80), (130, 100), (100, 0)]
    for layer, start, end in zip(layers, corners, corners[1:], strict=False):
        if shape == "3D":
            space.add_polyline3d([(*start, 0), (*end, 0)], dxfattribs={"layer": layer})
        else:
            space.add_line(start, end, dxfattribs={"layer": layer})
    for corner in corners:
        place = {"layer": "ground" if corner[1] == 0 else "pins"}
        if shape == "point":
            space.add_point(corner, dxfattribs=place)
        elif shape == "block":  # mirrored and turned
            at = {"xscale": -1, "yscale": 1, "rotation": 33}
            space.add_blockref("PIN", corner, dxfattribs=place | at)
        else:
            space.add_circle(corner, 2, dxfattribs=place)


@pytest.mark.parametrize("version", ["R12", "R2000", "R2018"])
@pytest.mark.parametrize("shape", ["circle", "point", "block", "3D"])
def test_entities_of_dxf(tmp_path, version, shape) -> None:
    """Contents of blocks on layer 0 belong to the layer of the block, as DXF defines it."""
    document = ezdxf.new(version)
    document.header["$INSUNITS"] = 4
    document.blocks.new("PIN").add_circle((0, 0), 2)
    four_bar(document.modelspace(), shape)
    document.saveas(tmp_path / "drawn.dxf")
    imported = import_model(tmp_path / "drawn.dxf", unit="mm")
    assert list(imported.document["bodies"]) == ["crank", "coupler", "rocker"]
    assert len(imported.document["ground"]["points"]) == 2
    assert imported.build().diagnosis.degrees_of_freedom == 1
    assert not imported.omissions


def test_nothing_of_dxf_is_dropped(tmp_path) -> None:
    """Other layouts, layers that are off, and blocks on frozen layers are listed."""
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 4
    document.blocks.new("PIN").add_circle((0, 0), 2)
    space = document.modelspace()
    four_bar(space, "circle")
    document.paperspace().add_line((0, 0), (9, 9))
    document.layers.add("Sketch").off()
    document.layers.add("Old").freeze()
    space.add_line((0, 50), (9, 90), dxfattribs={"layer": "SKETCH"})
    space.add_blockref("PIN", (50, 50), dxfattribs={"layer": "Old"})
    document.saveas(tmp_path / "drawn.dxf")
    imported = import_model(tmp_path / "drawn.dxf")
    assert [o.content for o in imported.omissions] == ["LINE", "INSERT", "1 entities"]


def test_attributes_of_blocks_are_labels(tmp_path) -> None:
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 4
    document.blocks.new("PIN").add_circle((0, 0), 2)
    space = document.modelspace()
    four_bar(space, "circle")
    pin = space.add_blockref("PIN", (130, 100))
    pin.add_attrib("NAME", "elbow", (132, 103), dxfattribs={"height": 3})
    document.saveas(tmp_path / "drawn.dxf")
    assert "elbow" in import_model(tmp_path / "drawn.dxf").document["joints"]
