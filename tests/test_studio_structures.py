# ruff: noqa: F811
"""Structures that are drawn in the studio: their results by hand, undo, mechanisms, improvement."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from browser import browser  # noqa: F401
from structure_desk import NEW, desk, page, problems, solved, start, use  # noqa: F401
from studio_desk import Desk
from studio_walk import drag_back

import dalembert as da
from dalembert.io import load_model_file

TRUSS = (
    ("b", [(0, 0), (1, 0), (2, 0), (1, 1), (0, 1)], "", "Escape"),
    ("b", [(0, 1), (1, 0), (1, 1)], "", "Escape"),
    ("o", [(0, 0)], "", ""),
    ("o", [(0, 1)], "", ""),
    ("f", [(2, 0)], "10 kN<-90", "Enter"),
)
"""Keys of tools, clicks, what is typed and the key that ends it: a cantilever of two panels."""


@pytest.mark.thorough
def test_a_cantilever_truss_by_equilibrium(desk: Desk, tmp_path: Path) -> None:
    """The bars of a drawn truss carry the forces of equilibrium at its nodes and sections."""
    texts = [desk.text]
    for key, clicks, typed, end in TRUSS:
        use(desk, key, clicks, typed, end)
        texts.append(desk.text)
    assert problems(desk) == []
    data = tomllib.loads(desk.text)
    names = {tuple(place): name for name, place in data["nodes"].items()}
    assert set(names) == {(0, 0), (1, 0), (2, 0), (1, 1), (0, 1)}
    bar = {frozenset(e["connect"]): name for name, e in data["elements"].items()}
    result = solved(desk.text, tmp_path)

    def force(p: tuple[int, int], q: tuple[int, int]) -> float:
        return float(result[f"{bar[frozenset((names[p], names[q]))]}.force"])

    load = 10e3
    hand = {
        ((1, 0), (2, 0)): -load,  # at the loaded node: the tie is inclined by 45°
        ((2, 0), (1, 1)): math.sqrt(2) * load,
        ((1, 1), (0, 1)): load,  # at the upper node
        ((1, 0), (1, 1)): -load,
        ((0, 1), (1, 0)): math.sqrt(2) * load,  # section through the first panel
        ((0, 0), (1, 0)): -2 * load,  # moments about the upper support
    }
    for (p, q), expected in hand.items():
        assert force(p, q) == pytest.approx(expected, rel=1e-9)
    area, modulus = (next(iter(data["elements"].values()))[k] for k in ("area", "modulus"))
    assert area == pytest.approx(math.pi / 4 * (0.06**2 - 0.054**2), rel=1e-4)
    virtual = sum(
        f**2 * math.dist(p, q) / (modulus * area) for (p, q), f in hand.items()
    )  # principle of virtual forces
    tip = float(result[f"{names[2, 0]}.uy"])
    assert -tip * load == pytest.approx(virtual, rel=1e-9)
    shown = desk.js(
        f"""(() => {{
            const {{ mesh }} = studio.pictures.page.motion;
            const moved = mesh.components(mesh.nodes.indexOf({names[2, 0]!r}));
            return moved.find((c) => c.name === "uy").value;
        }})()"""
    )
    assert shown == pytest.approx(tip, rel=1e-5)
    while desk.js("studio.file.undo") and desk.text != NEW:  # byte for byte
        revision = desk.js("studio.file.revision")
        desk.js("studio.undo()")
        desk.until(f"studio.file.revision > {revision}", 10)
        assert desk.text == NEW or any(desk.text.startswith(t[:60]) for t in texts)
    assert desk.text == NEW


@pytest.mark.thorough
def test_a_cantilever_beam(desk: Desk, tmp_path: Path) -> None:
    """Deflection of the tip P L³/(3 E I), its slope P L²/(2 E I), and the clamping moment P L."""
    use(desk, "e", [(0, 0.5), (2, 0.5)], "", "Escape")
    use(desk, "c", [(0, 0.5)])
    use(desk, "f", [(2, 0.5)], "0, -3 kN", "Enter")
    assert problems(desk) == []
    data = tomllib.loads(desk.text)
    beam = data["elements"]["beam1"]
    stiffness, load, length = beam["modulus"] * beam["second_moment"], 3e3, 2.0
    assert beam["second_moment"] == pytest.approx(math.pi / 64 * (0.06**4 - 0.054**4), rel=1e-4)
    result = solved(desk.text, tmp_path)
    fixed, tip = beam["connect"]
    assert float(result[f"{tip}.uy"]) == pytest.approx(-load * length**3 / (3 * stiffness))
    assert float(result[f"{tip}.rz"]) == pytest.approx(-load * length**2 / (2 * stiffness))
    assert float(result[f"{fixed}.mz"]) == pytest.approx(load * length)


@pytest.mark.thorough
def test_a_plate_with_a_hole(desk: Desk, tmp_path: Path) -> None:
    """A region in uniform tension: force of the edge, and stress beside the hole above 2 σ."""
    use(desk, "p", [(0, 0), (2, 0), (2, 0.8), (0, 0.8)], "", "Enter")
    use(desk, "h", [(1, 0.4), (1.2, 0.4)])
    use(desk, "r", [(0, 0.45), (0, 0.8)])  # an edge that rolls along y
    use(desk, "r", [(0, 0), (0.5, 0)])
    use(desk, "f", [(2, 0.45)], "5 MPa<0", "Enter")
    assert problems(desk) == []
    data = tomllib.loads(desk.text)
    hole = {"center": [1, 0.4], "radius": 0.2}
    assert data["meshes"]["plate1"]["polygon"]["holes"] == [hole]
    assert data["supports"] == [
        {"nodes": "plate1.edge4", "ux": 0},
        {"nodes": "plate1.vertex1", "uy": 0},
    ]
    path = tmp_path / "drawn.toml"
    path.write_text(desk.text, encoding="utf-8")
    model = load_model_file(path).model()
    result = da.solve_statics(model)
    held = [k for k, (node, direction) in enumerate(model.supports) if direction == "ux"]
    reactions = sum(
        float(result[f"{node}.fx"]) for node, direction in np.array([*model.supports])[held]
    )
    assert reactions == pytest.approx(-5e6 * 0.8 * 0.01, rel=1e-9)
    assert float(result["plate1.von_mises.max"]) > 2 * 5e6
    desk.page.keyboard.press("v")
    revision = desk.js("studio.file.revision")
    for (x, y), (u, v) in (((2, 0.8), (2.2, 0.6)), ((1.2, 0.4), (1.1, 0.4))):
        desk.page.mouse.move(*desk.place(x, y))
        desk.page.mouse.down()
        desk.page.mouse.move(*desk.place(u, v), steps=4)
        desk.page.mouse.up()
        revision += 1
        desk.settle(revision)
    polygon = tomllib.loads(desk.text)["meshes"]["plate1"]["polygon"]
    assert polygon["vertices"][2] == [2.2, 0.6]
    assert polygon["holes"][0]["radius"] == pytest.approx(0.1, abs=1e-9)
    assert problems(desk) == []


SQUARE = """format = 1
kind = "structure"

[nodes]
a = [0, 0]  # left
b = [1, 0]
c = [1, 0.8]
d = [0, 0.8]

[elements]
bottom = { type = "Truss", connect = ["a", "b"], area = 1e-4, modulus = 2e11 }
right = { type = "Truss", connect = ["b", "c"], area = 1e-4, modulus = 2e11 }
top = { type = "Truss", connect = ["c", "d"], area = 1e-4, modulus = 2e11 }
left = { type = "Truss", connect = ["d", "a"], area = 1e-4, modulus = 2e11 }

[[supports]]
nodes = ["a", "b"]

[[loads]]
nodes = "c"
fx = 1000
fy = 0
"""


@pytest.mark.thorough
def test_a_mechanism_shows_what_moves(desk: Desk) -> None:
    """A square without a diagonal sways: its picture names the nodes; a diagonal holds it."""
    start(desk, SQUARE)
    (message,) = problems(desk)
    assert "c, d can move" in message
    assert desk.js("studio.structure.moving") == ["c", "d"]
    line = desk.js("studio.described.problems[0].line")
    assert SQUARE.splitlines()[line - 1].startswith("c = ")
    moved = desk.js("Array.from(studio.pictures.page.motion.mesh.moved[0])")
    shown = np.array(moved).reshape(-1, 3)
    np.testing.assert_allclose(np.abs(shown[:4, 0]), [0, 0, 1, 1], atol=1e-9)
    np.testing.assert_allclose(shown[:4, 1], 0, atol=1e-9)
    use(desk, "b", [(0, 0), (1, 0.8)], "", "Escape")
    assert problems(desk) == []
    assert desk.js("studio.structure.moving") == []
    assert desk.text.startswith(SQUARE[:120])


@pytest.mark.thorough
def test_a_dragged_node_is_live(desk: Desk, tmp_path: Path) -> None:
    """While a node is dragged the page computes; what it shows is what the file then gives."""
    start(desk, SQUARE.replace('"d", "a"]', '"c", "a"]').replace("[1, 0.8]", "[1.0, 0.8]"))
    start(desk, desk.text.replace('connect = ["c", "d"]', 'connect = ["b", "d"]'))
    start(desk, desk.text.replace('nodes = ["a", "b"]', 'nodes = ["a", "b", "d"]'))
    desk.until("studio.pictures.live", 60)
    desk.until("studio.pictures.frame.contentDocument.documentElement.dataset.live", 20)
    text = desk.text
    desk.page.mouse.move(*desk.place(1, 0.8))
    desk.page.mouse.down()
    desk.page.mouse.move(*desk.place(1.3, 0.9), steps=4)
    mesh = "studio.pictures.page.motion.mesh"
    desk.until(f"Math.abs({mesh}.rest[6] - 1.3) < 1e-9", 20)
    value = f"{mesh}.components({mesh}.nodes.indexOf('c'))[0].value"
    assert desk.text == text
    live = desk.js(value)
    revision = desk.js("studio.file.revision")
    desk.page.mouse.up()
    desk.settle(revision + 1)
    assert tomllib.loads(desk.text)["nodes"]["c"] == [1.3, 0.9]
    assert live == pytest.approx(float(solved(desk.text, tmp_path)["c.ux"]), rel=1e-6)


@pytest.mark.thorough
def test_a_truss_is_improved_and_saved(desk: Desk, page: tuple[Desk, Path]) -> None:
    """One area for all bars, mass least at a deflection: u = u₀ A₀/A, so the area is known."""
    for key, clicks, typed, end in TRUSS:
        use(desk, key, clicks, typed, end)
    desk.js("studio.structure.choose('select')")
    revision = desk.js("studio.file.revision")
    desk.page.locator("#structure-palette button").first.focus()
    desk.page.keyboard.press("Control+a")
    desk.page.click(".properties [aria-label='make area a parameter']")
    desk.settle(revision + 1)
    data = tomllib.loads(desk.text)
    assert {e["area"] for e in data["elements"].values()} == {"area1"}
    tip = next(name for name, place in data["nodes"].items() if place == [2, 0])
    first = solved(desk.text, page[1])
    limit = float(f"{-2 * float(first[f'{tip}.uy']):.4g}")
    desk.page.click("#tab-design")
    for name, measure in (("mass", "mass"), ("sag", f"-{tip}.uy")):
        revision = desk.js("studio.file.revision")
        desk.page.fill("[name=new-response]", name)
        desk.page.select_option(".design select[aria-label=Reduction]", "Final")
        desk.page.fill("[name=new-measure]", measure)
        desk.page.click(".design >> text=Add")
        desk.until(f"studio.file.revision > {revision}", 10)
    desk.page.select_option("[name=aim-mass]", "minimize")
    desk.until("studio.file.document.optimize?.minimize === 'mass'", 10)
    desk.page.fill("[name=upper-sag]", str(limit))
    desk.page.keyboard.press("Tab")
    desk.until("studio.file.document.optimize?.subject_to?.length === 1", 10)
    desk.page.click("#start-task")
    desk.until("studio.insight.design.tasks.optimize?.status === 'done'", 90)
    desk.page.click("text=Show the result")
    ready = "document.querySelector('.result-panel iframe').contentWindow.dalembert?.motion"
    desk.until(ready, 30)
    desk.page.click("text=Write its parameters into the text")
    area0 = data["parameters"]["area1"]["value"]
    desk.until(f"studio.file.document.parameters.area1.value !== {area0}", 10)
    best = tomllib.loads(desk.text)["parameters"]["area1"]["value"]
    exact = area0 * -float(first[f"{tip}.uy"]) / limit
    assert best == pytest.approx(exact, rel=1e-4)
    path = page[1] / "cantilever.toml"
    desk.page.click("text=Save as…")
    desk.page.fill("#ask input", str(path))
    desk.page.keyboard.press("Enter")
    desk.until("!studio.file.changed", 20)
    assert path.read_text(encoding="utf-8") == desk.text
    assert float(solved(desk.text, page[1])["mass"]) < float(first["mass"])


LIVE_TRUSS = (
    NEW
    + """
[nodes]
a = [0.0, 0.0]
b = [2.0, 0.0]
top = [1.0, 0.5]

[elements]
left = { type = "Truss", connect = ["a", "top"], area = 1e-4, modulus = 2e11 }
right = { type = "Truss", connect = ["b", "top"], area = 1e-4, modulus = 2e11 }

[[supports]]
nodes = ["a", "b"]

[[loads]]
nodes = "top"
fy = -1000.0
"""
)


@pytest.mark.thorough
def test_a_node_that_is_dragged_back_is_shown_at_its_place(desk: Desk) -> None:
    """The drag changes nothing in the text; the page that computed it shows the text again."""
    start(desk, LIVE_TRUSS)
    drag_back(desk, (1.0, 0.5))
