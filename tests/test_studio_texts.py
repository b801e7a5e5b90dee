"""Texts of the studio: places, changes that keep the rest, drafts and their journal."""

from __future__ import annotations

import json
import math
import os
import random
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import dalembert as da
from dalembert.io.model_file import check_model_data
from dalembert.io.toml_places import line_and_column, parse_keys, toml_places
from dalembert.studio.draft import PAUSE, Draft, Missing, Unconfirmed
from dalembert.studio.drawing_edits import apply
from dalembert.studio.drawn_numbers import with_drawn_parameters
from dalembert.studio.journal import Journal
from dalembert.studio.text_edits import TextEdits
from dalembert.studio.toml_values import as_toml

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))
FOUR_BAR = (Path(__file__).parents[1] / "examples" / "four_bar.toml").read_text("utf-8")


def entries(value: Any, keys: tuple = ()):
    """Key path → value of all keys below a table."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in inner:
        yield (*keys, key), item
        if isinstance(item, (dict, list)):
            yield from entries(item, (*keys, key))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_places_are_those_of_the_values(path: Path) -> None:
    text = path.read_text("utf-8")
    places, data = toml_places(text), tomllib.loads(text)
    values = 0
    for keys, value in entries(data):
        place = places.get(keys)
        if place is None or (text[place.start] == "[" and place.value == place.start != place.end):
            continue
        if place.value > place.start or isinstance(keys[-1], int):
            written = text[place.value : place.end]
            assert tomllib.loads(f"k = {written}")["k"] == value, keys
            values += 1
    leaves = [keys for keys, value in entries(data) if not isinstance(value, (dict, list))]
    assert all(keys in places for keys in leaves)
    assert values >= len(leaves)


KEYS = st.sampled_from(["a", "b c", "d.e", 'f"g', "é", "-", "0"])
VALUES = st.recursive(
    st.one_of(
        st.integers(-(10**6), 10**6),
        st.floats(-1e9, 1e9),
        st.booleans(),
        st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=8),
    ),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(KEYS, inner, max_size=3)),
    max_leaves=12,
)


def written(value: Any) -> str:
    """TOML with comments and line ends wherever they may be."""
    if isinstance(value, dict):
        inner = ", ".join(
            f"{json.dumps(k, ensure_ascii=False)} = {written(v)}" for k, v in value.items()
        )
        return f"{{ {inner} }}"
    if isinstance(value, list):
        return "[ # first\n" + "".join(f"  {written(v)}, # ] }} \n" for v in value) + "]"
    return json.dumps(value)


@pytest.mark.thorough
@settings(max_examples=200, deadline=None)
@given(st.dictionaries(KEYS, VALUES, min_size=1, max_size=4))
def test_places_of_random_texts(table: dict[str, Any]) -> None:
    rows = (
        f"{json.dumps(k, ensure_ascii=False)} = {written(v)} # = [x]\n" for k, v in table.items()
    )
    text = "# [no]\n[ head . 'x' ]\n" + "".join(rows)
    data = tomllib.loads(text)
    places = toml_places(text)
    for keys, value in entries(data):
        if keys in (("head",), ("head", "x")):
            continue
        place = places[keys]
        assert tomllib.loads(f"k = {text[place.value : place.end]}")["k"] == value


def test_keys_of_messages() -> None:
    assert parse_keys('joints.A."b c"[2].at') == ("joints", "A", "b c", 2, "at")
    assert line_and_column("ab\ncd", 4) == (2, 2)


@pytest.mark.few(8)
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_entry_that_is_added_and_removed_leaves_the_text(path: Path) -> None:
    text = path.read_text("utf-8")
    edits = TextEdits(text)
    if edits.data.get("kind") == "structure":
        return
    edits.add("bodies", "added_bar", {"type": "Bar", "length": 0.25})
    added = tomllib.loads(edits.text)
    assert added["bodies"].pop("added_bar") == {"type": "Bar", "length": 0.25}
    former = {k: v for k, v in added.items() if v != {}}
    assert former == {k: v for k, v in tomllib.loads(text).items() if v != {}}
    edits.remove("bodies", "added_bar")
    assert edits.text.split() == text.split()


@pytest.mark.few(4)
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_number_can_be_replaced(path: Path) -> None:
    text = path.read_text("utf-8")
    for keys, value in entries(tomllib.loads(text)):
        if isinstance(value, bool) or not isinstance(value, (int, float)) or keys[0] == "format":
            continue
        edits = TextEdits(text)
        if keys not in edits.places:
            continue
        edits.set_value(keys, 123.25)
        changed = dict(entries(edits.data))
        assert changed[keys] == 123.25
        assert edits.text.count("\n") == text.count("\n")
        edits.set_value(keys, value)
        assert edits.data == tomllib.loads(text)


def test_a_named_element_is_renamed_everywhere() -> None:
    edits = TextEdits(FOUR_BAR)
    edits.rename("bodies", "coupler", "rod")
    edits.rename("parameters", "l1", "crank_length")
    assert edits.text == FOUR_BAR.replace("coupler", "rod").replace("l1", "crank_length").replace(
        "rod length", "coupler length"
    ).replace("the rod joins", "the coupler joins").replace("Crank, rod", "Crank, coupler")


def test_formulas_are_not_overwritten() -> None:
    edits = TextEdits(FOUR_BAR)
    edits.set_value(("bodies", "crank", "length"), 0.4)
    assert edits.data["parameters"]["l1"]["value"] == 0.4
    with pytest.raises(da.ModelError, match=r"bodies.crank.mass: is the formula 'rho\*l1'"):
        edits.set_value(("bodies", "crank", "mass"), 2.0)
    with pytest.raises(da.ModelError, match="no such entry"):
        edits.set_value(("bodies", "nobody", "mass"), 2.0)


def test_removal_includes_what_depends_on_it() -> None:
    text = apply(FOUR_BAR, [{"op": "remove", "section": "bodies", "name": "coupler"}])
    data = tomllib.loads(text)
    assert set(data["bodies"]) == {"crank", "rocker"} and set(data["joints"]) == {"O1", "O2"}


CRANK = {"type": "Bar", "length": 1, "points": {"P": [[0, 1], [1, 2]]}}
WRITTEN = {
    "header": "[bodies.crank]\ntype = 'Bar'\nlength = 1\n[bodies.crank.points]\nP = [\n"
    "  [0, 1],\n  [1, 2],\n]\n[bodies]\nrod = 2 # rod\n",
    "in lines": "[bodies]\ncrank = { type = 'Bar', length = 1, points = { P = [\n  [0, 1],\n"
    "  [1, 2],\n] } }\nrod = 2 # rod\n",
    "dotted": "[bodies]\ncrank.type = 'Bar'\ncrank.length = 1\ncrank.points.P = [\n  [0, 1],\n"
    "  [1, 2],\n]\nrod = 2 # rod\n",
    "dotted and header": "[bodies]\ncrank.type = 'Bar'\nrod = 2 # rod\ncrank.length = 1\n"
    "[bodies.crank.points]\nP = [\n[0, 1],\n[1, 2]\n]\n",
    "dotted at the root": "bodies.crank.type = 'Bar'\nbodies.crank.length = 1\n"
    "bodies.rod = 2 # rod\nbodies.crank.points.P = [[0, 1], [1, 2]]\n",
    "in one line": "bodies = { rod = 2, crank = { type = 'Bar', length = 1, "
    "points = { P = [[0, 1], [1, 2]] } } } # rod\n",
    "dotted in one line": "bodies = { crank.type = 'Bar', crank.length = 1, rod = 2, "
    "crank.points.P = [[0, 1], [1, 2]] } # rod\n",
}
"""The same body in all forms of TOML."""


@pytest.mark.parametrize("form", WRITTEN)
def test_an_entry_in_every_form_is_removed_alone(form: str) -> None:
    text = "name = 'test'\n" + WRITTEN[form] + "\n[other.part]\nlist = [\n  [1, 2],\n]\n"
    before = tomllib.loads(text)
    assert before["bodies"] == {"crank": CRANK, "rod": 2}
    after = apply(text, [{"op": "remove", "section": "bodies", "name": "crank"}])
    assert tomllib.loads(after) == before | {"bodies": {"rod": 2}}
    assert "# rod" in after
    gone = apply(after, [{"op": "remove", "section": "bodies", "name": "rod"}])
    assert tomllib.loads(gone).get("bodies", {}) == {}
    assert tomllib.loads(gone)["other"] == before["other"]


@pytest.mark.parametrize("form", WRITTEN)
def test_keys_of_an_entry_in_every_form_are_added_and_dropped(form: str) -> None:
    text = WRITTEN[form]
    keys = ["bodies", "crank", "mass"]
    more = apply(text, [{"op": "set", "keys": keys, "value": 2}])
    assert tomllib.loads(more)["bodies"] == {"crank": CRANK | {"mass": 2}, "rod": 2}
    for key in ("length", "points", "mass"):
        less = apply(more, [{"op": "drop", "keys": ["bodies", "crank", key]}])
        expected = {name: value for name, value in (CRANK | {"mass": 2}).items() if name != key}
        assert tomllib.loads(less)["bodies"] == {"crank": expected, "rod": 2}
        assert "# rod" in less
    assert apply(more, [{"op": "drop", "keys": keys}]) == text


@pytest.mark.parametrize(
    "text",
    [
        "responses.height.type = 'Final'\nresponses.height.measure = 'q'\ngravity = [0, 0]\n",
        "gravity = [0, 0]\n[responses]\nheight.type = 'Final'\nheight.measure = 'q'\n",
        "gravity = [0, 0]\nresponses = { height = { type = 'Final', measure = 'q' } }\n",
    ],
)
def test_responses_of_dotted_keys_are_replaced_and_removed(text: str) -> None:
    mean = {"type": "Mean", "measure": "p"}
    more = apply(text, [{"op": "section", "section": "responses", "fields": {"mean": mean}}])
    final = {"type": "Final", "measure": "q"}
    assert tomllib.loads(more) == {"gravity": [0, 0], "responses": {"height": final, "mean": mean}}
    other = {"op": "section", "section": "responses", "fields": {"height": None}}
    assert tomllib.loads(apply(more, [other])) == {"gravity": [0, 0], "responses": {"mean": mean}}
    changed = {"op": "section", "section": "responses", "fields": {"height": mean}}
    assert tomllib.loads(apply(text, [changed]))["responses"] == {"height": mean}


def test_new_names() -> None:
    add = {"op": "add", "section": "bodies", "base": "bar", "as": "$bar", "fields": {"type": "Bar"}}
    pin = {"type": "Revolute", "connect": ["$bar.start", {"body": "ground", "at": [0, 1]}]}
    joint = {"op": "add", "section": "joints", "base": "", "fields": pin}
    data = tomllib.loads(apply(apply("format = 1\n", [add, joint]), [add, joint]))
    assert list(data["bodies"]) == ["bar1", "bar2"] and list(data["joints"]) == ["A", "B"]
    assert data["joints"]["B"]["connect"][0] == "bar2.start"


@pytest.mark.parametrize(
    "operations",
    [
        [],
        None,
        "remove",
        [1],
        [{"op": "eval"}],
        [{"op": "add", "section": "bodies", "name": 'x"\n[y]', "fields": {}}],
        [{"op": "add", "section": "__class__", "base": "b", "fields": {}}],
        [{"op": "add", "section": "bodies", "base": "b", "fields": {"a\n": 1}}],
        [{"op": "add", "section": "bodies", "base": "b", "fields": {"a": float("nan")}}],
        [{"op": "add", "section": "bodies", "base": "b", "fields": {"a": "x\ny"}}],
        [{"op": "set", "keys": [], "value": 1}],
        [{"op": "set", "keys": ["name", "x"], "value": 1}],
        [{"op": "set", "keys": ["name"], "value": None}],
        [{"op": "remove", "section": "bodies", "name": "nobody"}],
        [{"op": "rename", "section": "bodies", "name": "crank", "to": "rocker"}],
        [{"op": "rename", "section": "bodies", "name": "crank", "to": "a b"}],
        [{"op": "add", "section": "bodies", "base": "b"}],
    ],
)
def test_wrong_operations_are_refused(operations: Any) -> None:
    with pytest.raises(da.ModelError):
        apply(FOUR_BAR, operations)


@given(st.recursive(st.one_of(st.floats(), st.text(), st.none()), st.lists, max_leaves=5))
def test_values_are_written_or_refused(value: Any) -> None:
    try:
        text = as_toml(value)
    except da.ModelError:
        return
    assert tomllib.loads(f"k = {text}")["k"] == value


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_undo_restores_every_text(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_bytes(FOUR_BAR.replace("\n", "\r\n").encode("utf-8-sig"))
    clock = Clock()
    draft = Draft(path, clock=clock)
    texts = [draft.text]
    for k in range(20):
        clock.now += 2 * PAUSE
        draft.replace(f"{FOUR_BAR}# {k}\n", f"change {k}", typed=k % 2 == 0)
        texts.append(draft.text)
    for text in reversed(texts[:-1]):
        assert draft.undo() and draft.text == text
    assert not draft.undo() and not draft.is_changed
    assert draft.encoded() == path.read_bytes()
    for text in texts[1:]:
        assert draft.redo() and draft.text == text
    draft.save()
    assert path.read_bytes() == f"{FOUR_BAR}# 19\n".replace("\n", "\r\n").encode("utf-8-sig")


def test_typing_is_undone_in_one_step() -> None:
    clock = Clock()
    draft = Draft(None, "a", clock)
    for text in ("ab", "abc", "abcd"):
        clock.now += PAUSE / 2
        draft.replace(text, "edit text", typed=True)
    assert draft.undo() and draft.text == "a"


def test_a_file_that_another_program_changed_is_not_replaced(tmp_path: Path) -> None:
    path, other = tmp_path / "model.toml", tmp_path / "other.toml"
    path.write_text("a = 1\n")
    other.write_text("b = 1\n")
    draft = Draft(path)
    draft.replace("a = 2\n", "edit")
    path.write_text("a = 3\n")
    with pytest.raises(Unconfirmed, match="another program"):
        draft.save()
    with pytest.raises(Unconfirmed, match="exists already"):
        draft.save(other)
    with pytest.raises(da.FileError, match=r"end the name with \.toml"):
        draft.save(tmp_path / "x.py")
    assert path.read_text() == "a = 3\n" and other.read_text() == "b = 1\n"
    draft.save(replace=True)
    assert path.read_text() == "a = 2\n" and not draft.is_changed
    path.write_text("a = 4\n")
    assert draft.reload() and draft.text == "a = 4\n"
    assert draft.undo() and draft.text == "a = 2\n"


def test_a_file_that_was_renamed_is_not_written_under_its_former_name(tmp_path: Path) -> None:
    path, renamed = tmp_path / "model.toml", tmp_path / "better.toml"
    path.write_text("a = 1\n")
    draft = Draft(path)
    for text in ("a = 2\n", "a = 3\n"):  # the second time the file is one that was saved
        draft.replace(text, "edit")
        path.rename(renamed)
        before = renamed.read_bytes()
        with pytest.raises(Missing, match=r"renamed to better\.toml by another program"):
            draft.save()
        assert not path.exists() and renamed.read_bytes() == before
        assert draft.is_changed and draft.text == text
        renamed.rename(path)
        draft.save()
        assert path.read_text() == text
    path.unlink()
    with pytest.raises(Missing, match="moved, renamed or deleted"):
        draft.save()
    draft.save(path)  # by Save as
    assert path.read_text() == "a = 3\n"


def test_unsaved_changes_of_a_killed_process_are_restored(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    script = (
        "import os, signal; from pathlib import Path; from dalembert.studio.journal import Journal;"
        f"journal = Journal(Path({str(path)!r}), Path({str(tmp_path)!r}));"
        "journal.write('kept'); print('ready', flush=True); input()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    journal = Journal(path, tmp_path)
    assert journal.left_over() == []  # its process still runs
    process.kill()
    process.communicate()
    (left,) = journal.left_over()
    assert left is not None and left.text == "kept"
    assert Journal(tmp_path / "other.toml", tmp_path).left_over() == []
    (tmp_path / "damaged.json").write_text("{")
    assert journal.left_over() == [left]
    journal.write("mine")
    assert os.stat(journal.file).st_size > 0
    journal.clear()
    assert not journal.file.exists()
    journal.close()


@pytest.mark.parametrize("count", [200, pytest.param(1000, marks=pytest.mark.thorough)])
def test_random_edits_are_undone_byte_by_byte(tmp_path: Path, count: int) -> None:
    """Texts stay valid, names unique, references complete; undo and redo reach every text."""
    path = tmp_path / "model.toml"
    path.write_text(FOUR_BAR)
    draft = Draft(path)
    rng = random.Random(5)
    texts = [draft.text]
    for _ in range(count):
        data = tomllib.loads(draft.text)
        bodies = list(data.get("bodies", {}))
        choice = rng.choice([*DRAWN, "undo", "type"])
        try:
            if choice == "undo":
                if draft.undo():
                    texts.pop()
                    assert draft.text == texts[-1]
                continue
            if choice == "type":
                lines = draft.text.split("\n")
                lines.insert(rng.randrange(len(lines)), "# remark [x] = { \"'")
                text = "\n".join(lines)
            else:
                text = apply(draft.text, random_operations(rng, choice, bodies, data))
        except da.ModelError:
            continue
        if draft.replace(text, choice):
            texts.append(text)
        data = tomllib.loads(text)
        assert not data["bodies"].keys() & data["joints"].keys()
        for joint in data["joints"].values():
            for end in joint["connect"]:
                body = end.split(".")[0] if isinstance(end, str) else end["body"]
                assert body == "ground" or body in data["bodies"]
        check_model_data(data, path)  # the file that the picture is made of is valid
    for text in reversed(texts[:-1]):
        assert draft.undo() and draft.text == text
    assert not draft.undo() and draft.encoded() == path.read_bytes()
    for text in texts[1:]:
        assert draft.redo() and draft.text == text


DRAWN = [
    *("bar", "bar", "pin", "move", "remove", "rename"),
    *("copy", "tool", "point", "property", "extract", "several"),
]
"""Kinds of random changes by drawing."""


def random_operations(
    rng: random.Random, kind: str, bodies: list[str], data: Any
) -> list[dict[str, Any]]:
    """Operations of one change of the drawing on random elements."""
    body, other = (rng.choice(bodies or ["none"]) for _ in range(2))
    number = round(rng.uniform(0.1, 2.0), 3)
    if kind == "copy":  # two of them with a joint between the copies
        parts = list(dict.fromkeys([body, other]))
        rows = [
            {
                "op": "add",
                "section": "bodies",
                "base": name.rstrip("0123456789"),
                "as": f"$copy_{name}",
                "fields": data["bodies"].get(name, {}) | {"position": [number, -number]},
            }
            for name in parts
        ]
        connect = [{"body": f"$copy_{name}", "at": [0.0, number]} for name in parts]
        pin = {"op": "add", "section": "joints", "base": ""}
        pin |= {"fields": {"type": "Revolute", "connect": connect}}
        return [*rows, pin] if len(parts) == 2 else rows
    if kind == "tool" and body != other:
        ends = [{"body": body, "at": [number, 0.0]}, {"body": other, "at": [0.0, 0.1]}]
        section, fields = rng.choice(
            [
                ("forces", {"type": "Spring", "connect": ends, "damping": 20}),
                ("forces", {"type": "Torque", "connect": [body], "value": number}),
                ("forces", {"type": "Actuator", "connect": ends, "force": 100}),
                ("joints", {"type": "Prismatic", "connect": ends, "axis": [0.6, 0.8]}),
                ("joints", {"type": "RigidLink", "connect": ends, "length": number}),
                ("drivers", {"type": "DistanceDriver", "connect": ends, "law": f"{number} + t"}),
            ]
        )
        return [{"op": "add", "section": section, "base": "new", "fields": fields}]
    if kind == "point":
        points = data["bodies"].get(body, {}).get("points", {})
        keys = ["bodies", body, "points", f"P{len(points) + 1}"]
        place: Any = [number, 0.2]
        if points:
            return [{"op": "set", "keys": keys, "value": place}]
        return [{"op": "set", "keys": keys[:-1], "value": {keys[-1]: place}}]
    if kind == "property":
        value = rng.choice([number, f"{number} kg", f"2*{number}"])
        keys = ["bodies", body, "mass"]
        return [{"op": "set", "keys": keys, "value": value, "written": True}]
    if kind == "extract":
        return [{"op": "extract", "keys": ["bodies", body, rng.choice(["length", "angle"])]}]
    if kind == "several" and len(bodies) > 3:
        names = [body, other, *list(data["joints"])[:1]]
        sections = ["bodies", "bodies", "joints"]
        return [
            {"op": "remove", "section": section, "name": name, "missing": True}
            for section, name in zip(sections, names, strict=False)
        ]
    if kind in ("tool", "several"):
        raise da.ModelError("too few bodies")
    return [random_operation(rng, kind, bodies, data)]


def random_operation(rng: random.Random, kind: str, bodies: list[str], data: Any) -> dict[str, Any]:
    """An operation of the drawing on a random element."""
    body = rng.choice(bodies or ["none"])
    number = round(rng.uniform(0.1, 2.0), 3)
    if kind == "bar":
        fields = {"type": "Bar", "length": number, "mass": 1.0, "position": [number, 0.5]}
        return {"op": "add", "section": "bodies", "base": "bar", "fields": fields}
    if kind == "pin":
        connect = [{"body": "ground", "at": [number, 0]}, f"{body}.start"]
        fields = {"type": "Revolute", "connect": connect}
        if body == "none":
            raise da.ModelError("no body")
        return {"op": "add", "section": "joints", "base": "", "fields": fields}
    if kind == "move":
        return {
            "op": "set",
            "keys": ["bodies", body, rng.choice(["length", "angle"])],
            "value": number,
        }
    if kind == "rename":
        return {"op": "rename", "section": "bodies", "name": body, "to": f"b{rng.randrange(999)}"}
    section = rng.choice(["bodies", "joints"])
    names = [name for name in data.get(section, {}) if len(data[section]) > 2]
    return {"op": "remove", "section": section, "name": rng.choice(names or ["none"])}


PARAMETERS = """format = 1
[parameters]
a = { value = 300, unit = "mm" }  # kept
b = "45 deg"
c = 2
d = "2*pi"
[bodies]
bar = { type = "Bar", length = "a", angle = "30 deg", position = [0.25, 1.5] }
"""


def test_values_keep_their_units() -> None:
    edits = TextEdits(PARAMETERS)
    edits.set_value(("bodies", "bar", "length"), 0.4)
    edits.set_value(("bodies", "bar", "angle"), math.radians(12))
    edits.set_parameter("b", math.radians(50))
    edits.set_parameter("c", 5.5)
    wanted = PARAMETERS.replace("300", "400.0").replace("30 deg", "12.0 deg")
    assert edits.text == wanted.replace("45 deg", "50.0 deg").replace("c = 2", "c = 5.5")
    for name in ("d", "unknown"):
        with pytest.raises(da.ModelError, match="no number to replace"):
            edits.set_parameter(name, 1.0)


def test_a_number_becomes_a_parameter() -> None:
    text = apply(PARAMETERS, [{"op": "extract", "at": PARAMETERS.index("0.25") + 1}])
    data = tomllib.loads(text)
    assert data["bodies"]["bar"]["position"] == ["bar_position_0", 1.5]
    assert data["parameters"]["bar_position_0"] == {"value": 0.25, "bounds": [0.125, 0.375]}
    assert "# kept" in text
    for at in (0, PARAMETERS.index("Bar"), PARAMETERS.index("30 deg"), 10_000):
        with pytest.raises(da.ModelError):
            apply(PARAMETERS, [{"op": "extract", "at": at}])


def test_numbers_of_a_drawing_are_parameters_of_its_live_picture() -> None:
    data = {
        "ground": {"points": {"O": [0.0, 0]}},
        "bodies": {"a": {"type": "Bar", "length": 2, "angle": "phi", "points": {"P": ["l", 1.5]}}},
        "joints": {"j": {"connect": ["a.start", {"body": "ground", "at": [1, 0]}]}},
        "parameters": {"l": 1.0, "drawn_1": 5.0},
    }
    before = json.dumps(data)
    drawn, places = with_drawn_parameters(data)
    assert json.dumps(data) == before
    assert set(places.values()) == {
        ("bodies", "a", "length"),
        ("bodies", "a", "points", "P", 1),
        *(("ground", "points", "O", i) for i in (0, 1)),
        *(("joints", "j", "connect", 1, "at", i) for i in (0, 1)),
    }
    for name, keys in places.items():
        value, entry = data, drawn
        for key in keys:
            value, entry = value[key], entry[key]  # type: ignore[index, call-overload]
        assert entry == name
        assert drawn["parameters"][name]["value"] == value
    assert drawn["parameters"]["drawn_1"] == 5.0
    assert drawn["bodies"]["a"]["angle"] == "phi"


@pytest.mark.parametrize(
    ("written", "value", "after"),
    [
        ("0.1", 0.12000000000000001, "0.12"),
        ('"100 mm"', 0.12000000000000001, '"120.0 mm"'),
        ('{ value = 5.0, unit = "deg" }', 2.0943951025, '{ value = 120.0, unit = "deg" }'),
        ("0.1", 0.08000055801133911, "0.0800005580113"),
    ],
)
def test_parameters_are_written_without_noise(written: str, value: float, after: str) -> None:
    operation = {"op": "parameter", "name": "a", "value": value}
    assert apply(f"[parameters]\na = {written}\n", [operation]) == f"[parameters]\na = {after}\n"


def test_an_angle_in_degrees_stays_short_when_it_is_changed() -> None:
    text = '[bodies]\nb = { type = "Bar", angle = "60 deg" }\n'
    operation = {"op": "set", "keys": ["bodies", "b", "angle"], "value": 2.0943951023}
    assert '"120.0 deg"' in apply(text, [operation])
