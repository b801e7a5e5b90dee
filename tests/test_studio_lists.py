"""Lists of tables in texts of the studio: supports and loads are added and removed."""

from __future__ import annotations

import random
import tomllib
from pathlib import Path
from typing import Any

import pytest

import dalembert as da
from dalembert.studio.drawing_edits import apply
from dalembert.studio.loose_nodes import without_loose_nodes
from dalembert.studio.problems import loose_notes

EXAMPLES = [Path(__file__).parents[1] / "examples" / f"{name}.toml" for name in ("truss", "plate")]
TABLES = """# a truss
[nodes]
a = [0, 0]  # left
b = [1, 0]
c = [0, 1]

[elements]
ab = { type = "Truss", connect = ["a", "b"], area = 1e-4, modulus = 2e11 }
bc = { type = "Truss", connect = ["b", "c"], area = 1e-4, modulus = 2e11 }

[[supports]]  # of the wall
nodes = ["a", "c"]

# the load
[[loads]]
nodes = "b"
fy = -1.0  # N
"""
INLINE = """supports = [
  { nodes = "a" },  # first
  { nodes = ["a", "b"], ux = 0 },
]
"""


def add(section: str, **fields: Any) -> dict[str, Any]:
    return {"op": "append", "section": section, "fields": fields}


def remove(section: str, index: int) -> dict[str, Any]:
    return {"op": "remove_entry", "section": section, "index": index}


@pytest.mark.parametrize("text", [TABLES, INLINE, "format = 1\n"])
def test_an_added_table_is_last_and_removed_without_a_trace(text: str) -> None:
    more = apply(text, [add("supports", nodes="b", uy=0)])
    before = tomllib.loads(text).get("supports", [])
    assert tomllib.loads(more)["supports"] == [*before, {"nodes": "b", "uy": 0}]
    for line in text.splitlines():
        assert line in more.splitlines() or line == "]" or "ux = 0" in line
    less = apply(more, [remove("supports", len(before))])
    assert tomllib.loads(less).get("supports", []) == before
    assert less.split() == text.split() or text == INLINE


def test_a_removed_node_takes_what_it_carries() -> None:
    """Its elements and loads go; supports of other nodes stay, with the comments."""
    data = tomllib.loads(apply(TABLES, [{"op": "remove", "section": "nodes", "name": "b"}]))
    assert list(data["nodes"]) == ["a", "c"]
    assert "elements" not in data
    assert "loads" not in data
    text = apply(TABLES, [{"op": "remove", "section": "nodes", "name": "c"}])
    assert tomllib.loads(text)["supports"] == [{"nodes": "a"}]
    assert "# of the wall" in text
    assert "fy = -1.0  # N" in text


def test_neighbours_of_a_removed_node_go_with_their_last_element() -> None:
    """The foot of a link and its support go with the node of the link; a node drawn alone stays."""
    link = (
        'kind = "structure"\n\n[nodes]\na = [0, 0]\nb = [1, 0]\nfoot = [1, -1]\nalone = [2, 2]\n'
        '\n[elements]\nab = { connect = ["a", "b"] }\nlink = { connect = ["b", "foot"] }\n'
        '\n[[supports]]\nnodes = "foot"\n\n[[supports]]\nnodes = ["a", "foot"]\nux = 0\n'
    )
    for section, name, nodes, elements in (
        ("nodes", "b", ["alone"], None),
        ("elements", "link", ["a", "b", "alone"], ["ab"]),
    ):
        data = tomllib.loads(apply(link, [{"op": "remove", "section": section, "name": name}]))
        assert list(data["nodes"]) == nodes
        assert data.get("elements") == (elements and {"ab": {"connect": ["a", "b"]}})
        assert data.get("supports") == (elements and [{"nodes": "a", "ux": 0}])


def test_loose_nodes_are_removed_by_a_remedy() -> None:
    text = TABLES.replace("# a truss\n", 'kind = "structure"\n').replace(
        "c = [0, 1]\n", "c = [0, 1]\nd = [3, 3]  # alone\ne = [4, 4]\n"
    )
    first, second = loose_notes(["d", "e"], text, Path("truss.toml"))
    assert [fix.title for fix in first.fixes] == ["Remove d", "Remove all 2"]
    assert [fix.title for fix in second.fixes] == ["Remove e"]
    both = first.fixes[1]
    fixed = text[: both.start] + both.insert + text[both.end :]
    assert tomllib.loads(fixed)["nodes"] == tomllib.loads(TABLES)["nodes"]
    assert "# of the wall" in fixed


def test_a_renamed_node_is_renamed_everywhere() -> None:
    text = apply(TABLES, [{"op": "rename", "section": "nodes", "name": "b", "to": "tip"}])
    data = tomllib.loads(text)
    assert data["elements"]["ab"]["connect"] == ["a", "tip"]
    assert data["loads"][0]["nodes"] == "tip"


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
@pytest.mark.parametrize("seed", range(5))
def test_random_changes_change_nothing_else(path: Path, seed: int) -> None:
    """The same changes of the data, and all lines that do not belong to removed tables stay."""
    rng, text = random.Random(seed), path.read_text("utf-8")
    data = tomllib.loads(text)
    for _ in range(12):
        section = rng.choice(["supports", "loads", "tractions", "line_loads", "temperatures"])
        entries = data.setdefault(section, [])
        if entries and rng.random() < 0.5:
            index = rng.randrange(len(entries))
            entries.pop(index)
            text = apply(text, [remove(section, index)])
        else:
            fields = {"nodes": rng.choice("abc"), "value": rng.random()}
            entries.append(fields)
            text = apply(text, [add(section, **fields)])
        expected = {key: value for key, value in data.items() if value != []}
        assert tomllib.loads(text) == expected
    comments = [row for row in path.read_text("utf-8").splitlines() if row.startswith("# ")]
    assert [row for row in text.splitlines() if row.startswith("# ")] == comments


@pytest.mark.parametrize(
    ("operation", "message"),
    [
        (add("bodies", nodes="a"), "tables cannot be added"),
        ({"op": "append", "section": "loads", "fields": [1]}, "needs the table"),
        (add("loads", **{"no key": 1}), "is no key"),
        (remove("loads", 1), "there is no such table"),
        (remove("loads", True), "needs the number"),
        (remove("nodes", 0), "tables cannot be removed"),
        ({"op": "add", "section": "nodes", "name": "n", "fields": {}}, "needs the list"),
    ],
)
def test_wrong_changes_are_refused(operation: dict[str, Any], message: str) -> None:
    with pytest.raises(da.ModelError, match=message):
        apply(TABLES, [operation])


def test_nodes_without_elements_are_left_out() -> None:
    text = 'kind = "structure"\n' + TABLES.replace("[elements]", "d = [2, 2]\n\n[elements]", 1)
    data = tomllib.loads(text.replace('nodes = ["a", "c"]', 'nodes = ["a", "c", "d"]'))
    kept, loose = without_loose_nodes(data)
    assert loose == ["d"]
    assert kept["supports"] == [{"nodes": ["a", "c"]}]
    assert without_loose_nodes(kept) == (kept, [])


@pytest.mark.parametrize(
    "text",
    [
        '[responses.a]\ntype = "Final" # last\nmeasure = "q"\n\n# search\n[optimize]\nvary = []\n',
        'responses.a = { type = "Final", measure = "q" }\n\n# search\n[optimize]\nvary = []\n',
        '[[optimize.subject_to]]\nresponse = "b"\n\n[responses.a]\ntype = "Final"\nmeasure = "q"',
    ],
    ids=["tables", "dotted", "at the end"],
)
def test_a_section_without_a_header_of_its_own_gets_entries(text: str) -> None:
    added = {"type": "Maximum", "measure": "p"}
    change = {"op": "section", "section": "responses", "fields": {"b": added}}
    aim = {"op": "section", "section": "optimize", "fields": {"minimize": "b"}}
    after, before = tomllib.loads(apply(text, [change, aim])), tomllib.loads(text)
    before["responses"]["b"], before["optimize"]["minimize"] = added, "b"
    assert after == before
    assert set(text.split("\n")) <= set(apply(text, [change, aim]).split("\n"))
