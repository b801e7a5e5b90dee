"""A corner or a hole is removed from a region: supports and loads stay at their edges."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

import dalembert as da
from dalembert.errors import ModelError
from dalembert.io import load_model_file
from dalembert.studio.drawing_edits import apply

CORNERS = [[0.0, 0.0], [1.0, -0.2], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
TEXT = f"""format = 1
kind = "structure"

[meshes.plate]
type = "Triangle"
thickness = 0.01
modulus = 1e9
poisson = 0.3

[meshes.plate.polygon]
vertices = {CORNERS}  # of the outline
size = 0.2
holes = [
  {{ center = [0.5, 0.5], radius = 0.1 }},  # first
  {{ center = [1.5, 0.5], radius = 0.15 }},
]

[[supports]]
nodes = ["plate.edge5", "plate.vertex4"]

[[loads]]
nodes = "plate.vertex3"
fy = -10.0

[[tractions]]
elements = "plate"
nodes = ["plate.edge3"]
tx = 1000.0

[[tractions]]
elements = "plate"
nodes = "plate.hole2"
ty = 500.0
"""
GROUP = re.compile(r"plate\.([a-z]+)(\d+)")
POLYGON = ["meshes", "plate", "polygon"]


def removed(text: str, *keys: Any) -> dict[str, Any]:
    return tomllib.loads(apply(text, [{"op": "remove_item", "keys": [*POLYGON, *keys]}]))


def places(data: dict[str, Any], names: Any) -> list[list[list[float]]]:
    """Ends of edges, corners, and centres of holes."""
    polygon, listed = data["meshes"]["plate"]["polygon"], []
    corners = polygon["vertices"]
    for name in [names] if isinstance(names, str) else names:
        kind, digits = GROUP.fullmatch(name).groups()  # type: ignore[union-attr]
        number = int(digits)
        if kind == "edge":
            listed.append([corners[number - 1], corners[number % len(corners)]])
        elif kind == "vertex":
            listed.append([corners[number - 1]])
        else:
            listed.append([polygon["holes"][number - 1]["center"]])
    return listed


def conditions(data: dict[str, Any]) -> dict[str, Any]:
    """Places of all supports and loads."""
    return {
        f"{section} {k}": places(data, entry["nodes"])
        for section in ("supports", "loads", "tractions")
        for k, entry in enumerate(data.get(section, []))
    }


def test_conditions_stay_where_they_are_when_a_corner_is_removed() -> None:
    before = conditions(tomllib.loads(TEXT))
    after = conditions(removed(TEXT, "vertices", 1))
    assert after == before


def test_the_first_corner_is_removed() -> None:
    """The edges on both sides of it become one, which is supported as one of them was."""
    before = conditions(tomllib.loads(TEXT))
    after = conditions(removed(TEXT, "vertices", 0))
    assert after.pop("supports 0") == [[CORNERS[4], CORNERS[1]], [CORNERS[3]]]
    del before["supports 0"]
    assert after == before


@pytest.mark.parametrize("key", ["vertices", "holes"])
def test_conditions_at_what_is_removed_go_with_it(key: str) -> None:
    data = removed(TEXT, key, 3 if key == "vertices" else 1)
    after = conditions(data)
    if key == "holes":
        assert "tractions 1" not in after
        assert after["supports 0"] == [[CORNERS[4], CORNERS[0]], [CORNERS[3]]]
        return
    assert after["supports 0"] == [[CORNERS[4], CORNERS[0]]]
    assert after["tractions 0"] == [[CORNERS[2], CORNERS[4]]]
    assert after["loads 0"] == [[CORNERS[2]]]


def test_a_hole_is_removed_and_the_load_of_the_other_stays() -> None:
    before = conditions(tomllib.loads(TEXT))
    assert conditions(removed(TEXT, "holes", 0)) == before


def test_edges_of_one_list_that_become_one_are_named_once() -> None:
    text = TEXT.replace('nodes = ["plate.edge3"]', 'nodes = ["plate.edge3", "plate.edge4"]')
    data = removed(text, "vertices", 3)
    assert data["tractions"][0]["nodes"] == "plate.edge3"


@pytest.mark.parametrize("corner", [0, 3])
@pytest.mark.parametrize("form", ["tractions", "listed", "supports"])
def test_equal_loads_of_edges_that_become_one_do_not_add_up(corner: int, form: str) -> None:
    first, second = ("edge5", "edge1") if corner == 0 else ("edge3", "edge4")
    other = '"plate.hole1", ' if form == "listed" else ""
    section, value = ("supports", "uy = 0.0") if form == "supports" else ("tractions", "tx = 500.0")
    elements = "" if form == "supports" else 'elements = "plate"\n'
    added = "".join(
        f"\n[[{section}]]\n{elements}nodes = [{names}]\n{value}\n"
        for names in (f'"plate.{first}"', f'{other}"plate.{second}"')
    )
    text = TEXT[: TEXT.index("[[supports]]")] + added
    conditions_after = removed(text, "vertices", corner)[section]
    merged = ["plate.edge4" if corner == 0 else "plate.edge3"]
    hole = [["plate.hole1"]] if form == "listed" else []
    shown = [[e["nodes"]] if isinstance(e["nodes"], str) else e["nodes"] for e in conditions_after]
    assert shown == [merged, *hole]


def test_loads_that_were_at_one_edge_add_up_as_before() -> None:
    load = '[[tractions]]\nelements = "plate"\nnodes = "plate.edge3"\ntx = 1000.0\n'
    data = removed(TEXT + load, "vertices", 3)
    assert [e["nodes"] for e in data["tractions"]] == [
        ["plate.edge3"],
        "plate.hole2",
        "plate.edge3",
    ]


def test_different_loads_of_edges_that_become_one_are_named() -> None:
    load = '[[tractions]]\nelements = "plate"\nnodes = "plate.edge4"\n'
    with pytest.raises(ModelError, match=r"edge3 and edge4 of plate .* tractions differ in tx"):
        removed(f"{TEXT}{load}tx = 2000.0\n", "vertices", 3)
    data = removed(f"{TEXT}{load}ty = 2000.0\n", "vertices", 3)
    assert [e["nodes"] for e in data["tractions"]] == [
        ["plate.edge3"],
        "plate.hole2",
        "plate.edge3",
    ]


def test_the_solution_without_a_hole_is_that_of_a_model_written_without_it(tmp_path: Path) -> None:
    edited = apply(TEXT, [{"op": "remove_item", "keys": [*POLYGON, "holes", 0]}])
    written = TEXT.replace("  { center = [0.5, 0.5], radius = 0.1 },  # first\n", "").replace(
        "plate.hole2", "plate.hole1"
    )
    stresses = []
    for k, text in enumerate((edited, written)):
        path = tmp_path / f"{k}.toml"
        path.write_text(text)
        result = da.solve_statics(load_model_file(path).model())
        stresses.append(float(result["plate.von_mises.max"]))
    assert stresses[0] == pytest.approx(stresses[1], rel=1e-12)
    assert stresses[0] > 0
