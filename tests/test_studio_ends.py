"""Ends of links, springs, forces and pins that are dragged on the drawing of the studio."""

from __future__ import annotations

from pathlib import Path

import pytest
from studio_desk import Desk
from studio_runs import Studio
from test_studio_tools import CRANK

import dalembert as da
from dalembert.io import load_model_file

LINK = 'L = { type = "RigidLink", connect = ["rod.end", { body = "ground", at = [0.8, 0.5] }], '
NUMBER = CRANK + LINK + "length = 0.3 } # link\n"
FORMULA = CRANK.replace("[bodies]", "[parameters]\nl = 0.3\n[bodies]") + LINK + 'length = "l" }\n'
PIN = CRANK + (
    'B = { type = "Revolute", connect = [{ body = "ground", at = [0.6, 0.2] }, '
    '{ body = "rod", at = [0, 0] }] }\n'
)
FORCES = CRANK + (
    "[forces]\n"
    'k = { type = "Spring", connect = ["crank.end", { body = "ground", at = [0.4, 0.5] }], '
    "stiffness = 200 }\n"
    'F = { type = "Force", connect = [{ body = "crank", at = [0.1, 0] }], vector = [3, 4] }\n'
    'z = { type = "Cable", points = [{ body = "ground", at = [0.1, 0.5] }, "crank.end", '
    '{ body = "ground", at = [0.6, 0.5] }], length = 0.8, stiffness = 1e4 }\n'
)
BETWEEN = CRANK.replace("[0.6, 0.2]", "[0.6, 0.5]") + (
    'L = { type = "RigidLink", connect = [{ body = "crank", at = [-0.1, 0] }, "rod.end"], '
    "length = 0.761577310586 }\n"
)
BALL = CRANK.replace(
    "rod =", 'ball = { type = "Particle", mass = 1, position = [0.1, 0.6] }\nrod ='
) + (
    'L = { type = "RigidLink", connect = [{ body = "crank", at = [-0.1, 0] }, "ball"], '
    "length = 0.4 }\n"
)
Place = tuple[float, float]
CASES: dict[str, tuple[str, str, Place, Place, dict[str, object]]] = {
    "link": (
        *(NUMBER, "L", (0.8, 0.5), (0.9, 0.6)),
        {"joints.L.connect.1.at": [0.9, 0.6], "joints.L.length": 0.17**0.5},
    ),
    "link of a formula": (
        *(FORMULA, "L", (0.8, 0.5), (0.9, 0.6)),
        {"joints.L.connect.1.at": [0.9, 0.6], "joints.L.length": "l"},
    ),
    "point of a link": (
        *(NUMBER, "rod", (0.8, 0.2), (0.9, 0.3)),
        {"bodies.rod.position": [0.65, 0.25], "joints.L.length": 0.05**0.5},
    ),
    "body of a link": (
        *(NUMBER, "rod", (0.6, 0.2), (0.6, 0.3)),
        {
            "bodies.rod.position": [0.6, 0.3],
            "joints.L.connect.1.at": [0.8, 0.6],
            "joints.L.length": 0.3,
        },
    ),
    "link between bodies": (
        *(BETWEEN, "rod", (0.6, 0.5), (0.6, 0.6)),
        {"bodies.rod.position": [0.6, 0.6], "joints.L.length": 0.65**0.5},
    ),
    "particle of a link": (
        *(BALL, "ball", (0.1, 0.6), (0.2, 0.6)),
        {"bodies.ball.position": [0.2, 0.6], "joints.L.length": 0.17**0.5},
    ),
    "both bodies of a pin": (
        *(PIN, "B", (0.6, 0.2), (0.7, 0.2)),
        {"joints.B.connect.0.at": [0.7, 0.2], "joints.B.connect.1.at": [0.1, 0]},
    ),
    "spring": (FORCES, "k", (0.4, 0.5), (0.5, 0.6), {"forces.k.connect.1.at": [0.5, 0.6]}),
    "force": (FORCES, "F", (0.3, 0.2), (0.1, 0.2), {"forces.F.connect.0.at": [-0.1, 0]}),
    "rope": (FORCES, "z", (0.6, 0.5), (0.7, 0.5), {"forces.z.points.2.at": [0.7, 0.5]}),
}
"""Text, selected element, drag, and values of the text afterwards."""


@pytest.mark.thorough
def test_ends_of_a_selected_element_are_dragged(
    shared_desk: tuple[Desk, Studio], tmp_path: Path
) -> None:
    visit, _ = shared_desk
    for case, (text, name, start, end, values) in CASES.items():
        visit.show(text)
        visit.page.keyboard.press("Escape")
        visit.js(f"studio.drawing.select([{name!r}])")
        visit.frames()
        revision = visit.revision
        visit.drag(start, end)
        visit.settle(revision + 1)
        for keys, value in values.items():
            entry: object = visit.document
            for key in keys.split("."):
                entry = entry[int(key) if isinstance(entry, list) else key]  # type: ignore[index]
            wanted = value if isinstance(value, str) else pytest.approx(value, abs=1e-9)
            assert entry == wanted, (case, keys)
        assert visit.errors_shown() == [], case
        (tmp_path / "drawn.toml").write_text(visit.text)
        model = load_model_file(tmp_path / "drawn.toml").model()
        if name == "rod":  # the text has the position that the joints allow
            start_of = da.solve_dynamics(model, 1e-3, outputs=2)
            position = visit.document["bodies"]["rod"]["position"]
            for axis, wanted in zip("xy", position, strict=True):
                assert start_of[f"rod.{axis}"].values[0] == pytest.approx(wanted, abs=1e-9)
        visit.press("Control+z")
        assert visit.text == text, case
