"""One four-bar linkage as different programs write it: bodies, lengths, pins and omissions."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

import dalembert as da

LENGTHS = {"crank": 50.0, "coupler": math.hypot(120, 20), "rocker": math.hypot(20, 70)}
PINS = {"O1": (100, 100), "A": (100, 150), "B": (220, 170), "O2": (240, 100)}
NAMESPACES = (
    'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
)
SIZE = 'width="400mm" height="300mm" viewBox="0 0 400 300"'
BARS = (
    '<path d="M 100,200 L 100,150"/><line x1="100" y1="150" x2="220" y2="130"/>'
    '<polyline points="220,130 240,200"/>'
)
MOVING = '<circle cx="100" cy="150" r="3"/><circle cx="220" cy="130" r="3"/>'
FIXED = "".join(f'<circle cx="{x}" cy="200" r="{r}"/>' for x in (100, 240) for r in (3, 5))
ALL = BARS + MOVING + FIXED
CLASSES = "<style>.cls-1{fill:none;stroke:#1d1d1b}.cls-2{fill:#1d1d1b}</style>"
STYLED = ALL.replace('" r="5"', '" r="5" class="cls-2"')
DRAWN_TWICE = "drawn twice"
HIDDEN = '<line x1="0" y1="0" x2="50" y2="50" {}/>'
SVG = {
    "groups of Inkscape with transforms": (
        '<g inkscape:groupmode="layer" inkscape:label="Layer 1" transform="translate(-50,20)">'
        f'<g transform="matrix(1 0 0 1 50 -20)">{ALL}</g></g>',
        [],
    ),
    "layers and classes of Illustrator": (
        f'<defs>{CLASSES}</defs><g id="Layer_1-2" data-name="Layer 1">{STYLED}</g>',
        [],
    ),
    "views of FreeCAD": (f'<g id="DrawingContent"><g id="ProjectionView001">{ALL}</g></g>', []),
    "circles as ellipses and arcs": (
        f'{BARS}<ellipse cx="100" cy="150" rx="3" ry="3"/>'
        f'<path d="m 223,130 a 3,3 0 1 1 -6,0 3,3 0 1 1 6,0 z"/>{FIXED}',
        [],
    ),
    "symbols": (
        '<defs><symbol id="p" overflow="visible"><circle r="3"/></symbol></defs>'
        f'{BARS}<use xlink:href="#p" x="100" y="150"/>'
        '<use href="#p" transform="translate(220 130)"/>'
        f"{FIXED}",
        [],
    ),
    "gaps": (
        '<path d="M 100,199.96 L 100.03,150"/><path d="M100 150.05L219.97 130"/>'
        f'<path d="M220,130.04 240,199.97"/>{MOVING}{FIXED}',
        [],
    ),
    "duplicates": (ALL + BARS + MOVING, [DRAWN_TWICE] * 5),
    "a background": (f'<rect width="400" height="300" fill="white"/>{ALL}', ["frame around"]),
    "invisible lines": (
        ALL + HIDDEN.format('style="display:none"') + HIDDEN.format('opacity="0"'),
        ["is hidden"] * 2,
    ),
    "notes and pictures": (
        f'{ALL}<text x="5" y="20">Drawing No 17</text><image href="data:image/png;base64,AAAA"/>',
        ["<image>", "Drawing No 17"],
    ),
}


def check(file: Path, expected: list[str]) -> None:
    """Three bars, four pins, one degree of freedom, the lengths, places and omissions."""
    imported = da.import_model(file)
    omitted = [str(omission) for omission in imported.omissions]
    assert len(omitted) == len(expected), omitted
    for part in expected:
        assert sum(part in text for text in omitted) == expected.count(part), omitted
    table, model = tomllib.loads(imported.text), imported.build()
    assert "1 degree of freedom" in str(model.diagnosis)
    assert sorted(table["joints"]) == ["A", "B", "O1", "O2"]
    values = {p.name: float(p.value) for p in model.parameters.values()}
    lengths = sorted(values[name] for name in values if name.startswith("bar"))
    np.testing.assert_allclose(lengths, np.sort(list(LENGTHS.values())) / 1e3, rtol=1e-3)
    for name in ("O1", "O2"):
        place = [values[f"{name}_x"], values[f"{name}_y"]]
        np.testing.assert_allclose(place, np.array(PINS[name]) / 1e3, atol=1e-4)


@pytest.mark.parametrize("name", SVG)
def test_svg_of_programs(name, tmp_path):
    body, omissions = SVG[name]
    file = tmp_path / "a.svg"
    file.write_text(f'<svg {NAMESPACES} {SIZE}><g fill="none" stroke="#000">{body}</g></svg>')
    check(file, omissions)


def test_user_units_of_an_svg(tmp_path):
    """Two user units per millimetre; inches."""
    file = tmp_path / "a.svg"
    for size, factor in (('width="400mm" viewBox="0 0 800 600"', 2), ('width="40in"', 1 / 25.4)):
        box = "" if "viewBox" in size else ' height="30in" viewBox="0 0 40 30"'
        height = ' height="300mm"' if "viewBox" in size else ""
        group = f'<g fill="none" transform="scale({factor})">{ALL}</g>'
        if not height:
            group = group.replace("scale", f"translate(0 {30 - 300 / 25.4}) scale")
        file.write_text(f"<svg {NAMESPACES} {size}{height}{box}>{group}</svg>")
        check(file, [])


def circles(scale):
    """Centre and radius of each circle; those of fixed pins are doubled."""
    radii = {"A": (3,), "B": (3,), "O1": (3, 5), "O2": (3, 5)}
    for name, place in PINS.items():
        for radius in radii[name]:
            yield np.array(place) * scale, radius * scale


def by_circles(space, scale, layer):
    for place, radius in circles(scale):
        space.add_circle(place, radius, dxfattribs={"layer": layer})


def by_arcs(space, scale, layer):
    for place, radius in circles(scale):
        space.add_arc(place, radius, 0, 180)
        space.add_arc(place, radius, 180, 360)


def by_ellipses(space, scale, layer):
    for place, radius in circles(scale):
        space.add_ellipse(place, (radius, 0), 1.0)


def by_bulges(space, scale, layer):
    for (x, y), radius in circles(scale):
        ends = [(x - radius, y, 1), (x + radius, y, 1)]
        space.add_lwpolyline(ends, format="xyb", close=True)


def by_blocks(space, scale, layer):
    block = space.doc.blocks.new("PIN")
    block.add_circle((0, 0), 1)
    for place, radius in circles(scale):
        scales = {"xscale": radius, "yscale": radius, "rotation": 30}
        space.add_blockref("PIN", place, dxfattribs=scales)


def by_mirrored_circles(space, scale, layer):
    for (x, y), radius in circles(scale):
        space.add_circle((-x, y), radius, dxfattribs={"extrusion": (0, 0, -1)})


DXF = {
    "QCAD in inches": (by_circles, 1, 1 / 25.4, "0"),
    "metres": (by_circles, 6, 1e-3, "0"),
    "Inventor": (by_circles, 4, 1.0, "Visible (ISO)"),
    "Onshape": (by_circles, 4, 1.0, "VISIBLE_NARROW"),
    "LibreCAD with polylines": (by_bulges, 4, 1.0, "0"),
    "blocks": (by_blocks, 4, 1.0, "0"),
    "exploded arcs": (by_arcs, 4, 1.0, "0"),
    "ellipses": (by_ellipses, 4, 1.0, "0"),
    "turned normals": (by_mirrored_circles, 4, 1.0, "0"),
}


def dxf_file(path, unit, scale, layer, add_circles):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = unit
    space = document.modelspace()
    for first, second in (("O1", "A"), ("A", "B"), ("B", "O2")):
        ends = [np.array(PINS[name]) * scale for name in (first, second)]
        space.add_line(*ends, dxfattribs={"layer": layer})
    add_circles(space, scale, layer)
    document.saveas(path)
    return path


@pytest.mark.parametrize("name", DXF)
def test_dxf_of_programs(name, tmp_path):
    add_circles, unit, scale, layer = DXF[name]
    check(dxf_file(tmp_path / "a.dxf", unit, scale, layer, add_circles), [])


def test_arcs_that_are_no_circle_are_listed(tmp_path):
    def half(space, scale, layer):
        by_circles(space, scale, layer)
        space.add_arc((10, 10), 5, 0, 180)
        space.add_ellipse((50, 50), (8, 0), 0.5)

    check(dxf_file(tmp_path / "a.dxf", 4, 1.0, "0", half), ["ARC: is a curve", "ELLIPSE: is a"])


@pytest.mark.parametrize("group", ["", "walker"])
def test_circles_within_one_body_are_listed(group, tmp_path):
    """Three lines of one polyline, or of one named group, are rigid: their circles join nothing."""
    chain = '<polyline points="100,200 100,150 220,130 240,200"/>'
    lines = f'<g id="{group}">{ALL}</g>' if group else chain + MOVING + FIXED
    file = tmp_path / "a.svg"
    file.write_text(f'<svg {NAMESPACES} {SIZE}><g fill="none">{lines}</g></svg>')
    imported = da.import_model(file)
    rigid = [o for o in imported.omissions if "joins only lines of one body" in o.reason]
    assert [o.content.partition(" at ")[2] for o in rigid] == ["(100, 150) mm", "(220, 170) mm"]


def test_the_corners_of_plates_are_points(tmp_path):
    """A coupler that is a triangle has a free corner: a point of the body, and no omission."""
    plate = '<polygon points="100,150 220,130 160,90"/><circle cx="160" cy="90" r="3"/>'
    lines = plate + ALL.replace('<line x1="100" y1="150" x2="220" y2="130"/>', "")
    file = tmp_path / "a.svg"
    file.write_text(f'<svg {NAMESPACES} {SIZE}><g fill="none">{lines}</g></svg>')
    imported = da.import_model(file)
    assert imported.omissions == []
    assert "1 degree of freedom" in str(imported.build().diagnosis)
