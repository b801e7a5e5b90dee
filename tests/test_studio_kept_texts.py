"""Changes of one number or row in the sheets of the studio: all other characters stay."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import Any

import pytest
from studio_scripts import drawn_by

from dalembert.studio.drawing_edits import apply
from dalembert.studio.new_models import UNTITLED

PATH = (
    UNTITLED
    + """
[synthesis]  # of a path
type = "path"
points = [
  ["200 mm", 0.2],  # start
  [0.5, "2*0.2"],  # top
  [0.8, 0.2],  # end
]
"""
)
POSES = (
    UNTITLED
    + """
[synthesis]
type = "motion"
points = [[0.2, 0.2], ["60 cm", 0.4]]  # of the coupler
coupler_angles = [
  "30 deg",  # first
  "pi/4",
]
"""
)
FUNCTION = (
    UNTITLED
    + """
[synthesis]
type = "function"
crank_angles = ["60 deg", 2.0, 3.0]  # turn
outputs = [
  0.0,
  "pi/6",  # middle
  0.25,
]
"""
)
OUTPUTS = '  0.0,\n  "pi/6",  # middle\n  0.25,\n'
SWAPPED = "  0.7,  # middle\n  0.0,\n"
INLINE = 'format = 1\nsynthesis = { type = "path", points = [["200 mm", 0.2], [0.5, 0.4]] }\n'
NUMBERS = FUNCTION.replace('"pi/6"', "0.5")
TEXTS = {"path": PATH, "poses": POSES, "function": FUNCTION, "inline": INLINE, "numbers": NUMBERS}
CHANGES: dict[str, tuple[str, list[Any], list[tuple[str, str]]]] = {
    "type a coordinate": ("path", ["typed", "points", 1, 1, "20 mm"], [('"2*0.2"', '"20 mm"')]),
    "type an angle": ("poses", ["typed", "coupler_angles", 1, None, "pi/3"], [("pi/4", "pi/3")]),
    "move a point": ("path", ["movedPoint", 2, [0.9, 0.3]], [("[0.8, 0.2]", "[0.9, 0.3]")]),
    "move a point with a unit": (
        "path",
        ["movedPoint", 0, [0.25, 0.3]],
        [('["200 mm", 0.2]', '["250.0 mm", 0.3]')],
    ),
    "move a point along a formula": ("path", ["movedPoint", 1, [0.6, 0.4]], [("[0.5", "[0.6")]),
    "turn a pose": (
        "poses",
        ["turnedPose", 0, 0.785398163397448],
        [('"30 deg"', '"45.0 deg"')],
    ),
    "remove a point": ("path", ["removedRow", 1], [('  [0.5, "2*0.2"],  # top\n', "")]),
    "remove a pose": (
        "poses",
        ["removedRow", 0],
        [("[[0.2, 0.2], ", "["), ('  "30 deg",  # first\n', "")],
    ),
    "add a point": ("path", ["addedPoint", [1, 0.5]], [("# end\n", "# end\n  [1, 0.5],\n")]),
    "add a point to an inline table": (
        "inline",
        ["addedPoint", [1, 0.5]],
        [("[0.5, 0.4]", "[0.5, 0.4], [1, 0.5]")],
    ),
    "add a pose": (
        "poses",
        ["addedPose", [1, 0.5], -5.5],
        [("0.4]]", "0.4], [1, 0.5]]"), ('"pi/4",\n', '"pi/4",\n  0.783185,\n')],
    ),
    "move a function point": (
        "function",
        ["movedFunctionPoint", 2, [2.5, 0.3]],
        [("2.0, 3.0", "2.0, 2.5"), ("0.25", "0.3")],
    ),
    "add a function point": (
        "function",
        ["addedFunctionPoint", [2.5, 0.3]],
        [("2.0, 3.0", "2.0, 2.5, 3.0"), ("  0.25,", "  0.3,\n  0.25,")],
    ),
    "move a function point past another": (
        "function",
        ["movedFunctionPoint", 2, [0.5, 0.3]],
        [('["60 deg", 2.0, 3.0]', '[0.5, "60 deg", 2.0]'), (OUTPUTS, "  0.3,\n" + OUTPUTS[:-8])],
    ),
    "move a function point with its comment": (
        "numbers",
        ["movedFunctionPoint", 1, [0.5, 0.7]],
        [('"60 deg", 2.0', '0.5, "60 deg"'), ("  0.0,\n  0.5,  # middle\n", SWAPPED)],
    ),
}
"""Change → text, function of the page with its arguments, and the parts of the text it replaces."""


def operations_of(folder: Path, script: str, *calls: Any) -> Any:
    """Operations of functions of a script of the studio."""
    return drawn_by("studio_changes.mjs", folder, json.dumps([[script, *call] for call in calls]))


def replaced(text: str, parts: list[tuple[str, str]]) -> str:
    for old, new in parts:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def test_a_change_of_a_target_keeps_all_other_entries(tmp_path: Path) -> None:
    calls = [
        [name, *given] if name == "typed" else [name, tomllib.loads(TEXTS[kind]), *given]
        for kind, (name, *given), _ in CHANGES.values()
    ]
    for (change, (kind, _, parts)), operations in zip(
        CHANGES.items(), operations_of(tmp_path, "target_edits.js", *calls), strict=True
    ):
        assert apply(TEXTS[kind], operations) == replaced(TEXTS[kind], parts), change


def test_a_target_of_another_type_replaces_the_former_one(tmp_path: Path) -> None:
    none: dict[str, Any] = {}
    documents = [none, *(tomllib.loads(TEXTS[kind]) for kind in ("poses", "function"))]
    texts = [UNTITLED, POSES, FUNCTION]
    point = [["addedPoint", document, [1, 2]] for document in documents]
    pose = [["addedPose", document, [1, 2], 3] for document in documents]
    operations = operations_of(tmp_path, "target_edits.js", *point, *pose)
    one = {"points": [[1, 2]]}
    more = {"points": [[0.2, 0.2], ["60 cm", 0.4], [1, 2]], "coupler_angles": ["30 deg", "pi/4", 3]}
    expected = [
        *(one | {"type": "path"} for _ in range(3)),
        one | {"type": "motion", "coupler_angles": [3]},
        more | {"type": "motion"},
        one | {"type": "motion", "coupler_angles": [3]},
    ]
    for text, change, table in zip(texts * 2, operations, expected, strict=True):
        assert tomllib.loads(apply(text, change))["synthesis"] == table


def test_numbers_of_targets_have_units(tmp_path: Path) -> None:
    targets = operations_of(
        tmp_path, "target_edits.js", *(["targetOf", tomllib.loads(t)] for t in TEXTS.values())
    )
    path, poses, function, *_ = targets
    assert path["points"] == [[0.2, 0.2], [0.5, 0.4], [0.8, 0.2]]
    assert poses["angles"] == pytest.approx([math.pi / 6, math.pi / 4])
    assert function["crank"] == pytest.approx([math.pi / 3, 2, 3])


ROWS = """\
[forces.hits]
type = "Collisions"
friction = "1/3"  # dry
shapes = { a = ["one"], b = ["two"], c = ["three"] }
pairs = [
  { groups = ["a", "b"], friction = "0.1*2" },  # oiled
  { groups = ["c", "b"], friction = 0.4, restitution = 0.5 },  # steel
]
"""
TABLES = """\
[forces.hits]
type = "Collisions"
shapes = { a = ["one"], b = ["two"], c = ["three"] }

[[forces.hits.pairs]]  # oiled
groups = ["a", "b"]
friction = "0.1*2"

[[forces.hits.pairs]]  # steel
groups = ["c", "b"]
friction = 0.4
restitution = 0.5

# what follows
[analysis]
type = "Dynamics"
"""
NEW = 'groups = ["a", "c"]\nfriction = 0.3\n'
PAIRS: list[tuple[list[str], str, Any, list[tuple[str, str]], list[tuple[str, str]]]] = [
    (["b", "c"], "friction", 0.7, [("0.4", "0.7")], [("0.4", "0.7")]),
    (["b", "a"], "friction", "1/4", [("0.1*2", "1/4")], [("0.1*2", "1/4")]),
    (["b", "c"], "friction", None, [("friction = 0.4, ", "")], [("friction = 0.4\n", "")]),
    (
        ["a", "b"],
        "friction",
        None,
        [('  { groups = ["a", "b"], friction = "0.1*2" },  # oiled\n', "")],
        [('[[forces.hits.pairs]]  # oiled\ngroups = ["a", "b"]\nfriction = "0.1*2"\n\n', "")],
    ),
    (
        ["a", "c"],
        "friction",
        0.3,
        [("# steel\n", '# steel\n  { groups = ["a", "c"], friction = 0.3 },\n')],
        [("restitution = 0.5\n", "restitution = 0.5\n\n[[forces.hits.pairs]]\n" + NEW)],
    ),
]
"""Groups, key and value of a pair, and the replaced parts of both texts."""


def test_a_coefficient_of_two_groups_keeps_all_other_pairs(tmp_path: Path) -> None:
    texts = [ROWS, TABLES]
    entries = [tomllib.loads(text)["forces"]["hits"] for text in texts]
    calls = [["pairChange", "hits", e, g, k, v] for e in entries for g, k, v, _, _ in PAIRS]
    operations = iter(operations_of(tmp_path, "contact_laws.js", *calls))
    for index, text in enumerate(texts):
        for *_, in_rows, in_tables in PAIRS:
            parts = (in_rows, in_tables)[index]
            assert apply(text, next(operations)) == replaced(text, parts)


def test_the_last_pair_and_all_coefficients_are_removed(tmp_path: Path) -> None:
    text = replaced(ROWS, [(PAIRS[3][3][0][0], ""), (", restitution = 0.5", "")])
    entry = tomllib.loads(text)["forces"]["hits"]
    (change,) = operations_of(
        tmp_path, "contact_laws.js", ["pairChange", "hits", entry, ["b", "c"], "friction", None]
    )
    pairs = text[text.index("pairs") :]
    assert apply(text, change) == text.replace(pairs, "")
    keys = ["forces", "hits"]
    calls = [["valueChange", keys, entry, "friction", v] for v in ("1/2", None)]
    calls.append(["valueChange", keys, entry, "restitution", None])
    written, dropped, nothing = operations_of(tmp_path / "2", "row_changes.js", *calls)
    assert apply(text, written) == text.replace('"1/3"', '"1/2"')
    assert apply(text, dropped) == text.replace('friction = "1/3"  # dry\n', "")
    assert nothing == []


LIMITS = """\
[optimize]
minimize = "mass"
subject_to = [
  { response = "stress", upper = "200 MPa" },  # of the steel
  { response = "sag", upper = "2 mm", lower = 0 },
]
"""


def test_a_limit_of_a_response_keeps_all_others(tmp_path: Path) -> None:
    keys, rows = ["optimize", "subject_to"], tomllib.loads(LIMITS)["optimize"]["subject_to"]
    calls = [
        ["rowChange", keys, rows, 1, {"response": "sag"}, "upper", "3 mm"],
        ["rowChange", keys, rows, 1, {"response": "sag"}, "lower", None],
        ["rowChange", keys, rows, 0, {"response": "stress"}, "upper", None],
        ["rowChange", keys, rows[:1], 0, {"response": "stress"}, "upper", None],
    ]
    changes = operations_of(tmp_path, "row_changes.js", *calls)
    parts = [("2 mm", "3 mm"), (", lower = 0", ""), (LIMITS.splitlines(True)[3], "")]
    for change, part in zip(changes, parts, strict=False):
        assert apply(LIMITS, change) == replaced(LIMITS, [part])
    assert tomllib.loads(apply(LIMITS, changes[3]))["optimize"] == {"minimize": "mass"}


SHAPES = """\
[bodies]
one = { type = "Particle", mass = 1 }
two = { type = "Particle", mass = 1 }
[forces.hits]
type = "Collisions"  # of both
pairs = [
  { groups = ["a", "b"], friction = 0.5 },  # oiled
  { groups = ["b", "b"], friction = "1/3" },  # dry
]
[forces.hits.shapes]
a = [{ type = "Circle", point = "one", radius = 0.1 }]  # the first
b = [
  { type = "Circle", point = "two", radius = "10 cm" },  # the second
  "one",  # its centre
]
"""


def test_removed_shapes_keep_all_others() -> None:
    text = apply(SHAPES, [{"op": "remove", "section": "bodies", "name": "one"}])
    lines = [line for line in SHAPES.splitlines(True) if '"one' not in line and "one =" not in line]
    assert text == "".join(line for line in lines if '["a", "b"]' not in line)
    text = apply(SHAPES, [{"op": "remove group", "name": "hits", "group": "a"}])
    assert text == "".join(
        x for x in SHAPES.splitlines(True) if "first" not in x and "oil" not in x
    )
