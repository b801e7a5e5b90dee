"""Remedies of errors in the studio: each fix makes the text valid, or removes its error."""

from __future__ import annotations

from pathlib import Path

import pytest

from dalembert.errors import FileError, ModelError
from dalembert.remedies import Rename, remedies_in
from dalembert.studio.new_models import NEW
from dalembert.studio.pictures import picture_of
from dalembert.studio.preview import Preview
from dalembert.text.wording import misspelt, unknown

TEXT = """\
format = 1
gravity = [0.0, -9.81]
[parameters]
l1 = 0.3
[bodies.crank]
type = "Bar"
length = "l1"
mass = 1.0
[bodies.rod]
type = "Bar"
length = 0.5
mass = 1.0
[joints]
O = { type = "Revolute", connect = ["ground", "crank.start"] }
A = { type = "Revolute", connect = ["crank.end", "rod.start"] }
"""
ERRORS = {
    "key": ('length = "l1"', 'lenght = "l1"', "Write length"),
    "section": ("[joints]", "[joint]", "Write joints"),
    "section of a table": (
        "[joints]\nO = {",
        '[joint.O]\ntype = "Revolute"\nconnect = ["ground", "crank.start"]\n[joints]\nP = {',
        "Write joints",
    ),
    "sections of tables": ("[bodies.", "[body.", "Write bodies"),
    "table in a header": (
        "mass = 1.0\n[joints]",
        "mass = 1.0\n[bodies.rod.pointz]\nP = [0, 0]\n[joints]",
        "Write points",
    ),
    "dotted keys": (
        "mass = 1.0\n[joints]",
        "mass = 1.0\npointz.P = [0, 0]\npointz.Q = [0, 1]\n[joints]",
        "Write points",
    ),
    "type": ('O = { type = "Revolute"', 'O = { type = "Revolut"', "Write Revolute"),
    "body": ('"crank.end"', '"crnk.end"', "Write crank"),
    "point": ('"crank.end"', '"crank.ent"', "Write crank.end"),
    "parameter": ('length = "l1"', 'length = "2*l2x"', None),
    "formula": ('length = "l1"', 'length = "2*l_1"', "Write l1"),
    "format": ("format = 1\n", "", "Insert format = 1"),
    "missing": ("length = 0.5\n", "", "Insert length = 1.0"),
    "inline": (', connect = ["ground", "crank.start"]', "", None),
    "unit": ("length = 0.5", 'length = "5 kg"', "Write 5 m"),
    "unit in a formula": ("length = 0.5", 'length = "2*5 lb"', "Write 5 m"),
    "unit of a parameter": ("l1 = 0.3", 'l1 = "0.3 kg"', "Write 0.3 m"),
    "unit of a bound": (
        "l1 = 0.3",
        'l1 = { value = "0.3 m", bounds = [0.1, "2 kg"] }',
        "Write 2 m",
    ),
    "missing unit": ("length = 0.5", 'length = "3.0 + 2 mm"', "Write 3 m"),
    "misspelt unit": ("length = 0.5", 'length = "5 mmm"', "Write mm"),
    "speed as a law": (
        "[joints]",
        '[drivers]\nm = { type = "RotationalDriver", connect = ["ground", "crank"], '
        'law = "0.1 + 60 rpm" }\n[joints]',
        "Write 60 rpm*t",
    ),
}
"""Kind of error → part of the text, its replacement, and the title of its fix."""


@pytest.mark.parametrize("kind", ERRORS)
def test_fixes(kind: str, tmp_path: Path) -> None:
    right, wrong, title = ERRORS[kind]
    text = TEXT.replace(right, wrong)
    assert text != TEXT
    first = picture_of(text, tmp_path / "model.toml", False).problems[0]
    assert first.level == "error"
    titles = [fix.title for fix in first.fixes]
    if title is not None:
        assert titles[:1] == [title], first.message
    for fix in first.fixes:
        mended = text[: fix.start] + fix.insert + text[fix.end :]
        after = picture_of(mended, tmp_path / "model.toml", False).problems
        assert first.message not in [problem.message for problem in after]
        if kind != "inline":
            assert [p.message for p in after if p.level == "error"] == []


def test_a_section_is_not_renamed_to_one_that_the_file_has(tmp_path: Path) -> None:
    text = TEXT + "[joint]\n"
    (problem, *_) = picture_of(text, tmp_path / "model.toml", False).problems
    assert "did you mean 'joints'" in problem.message and problem.fixes == ()


TRUSS = """\
format = 1
kind = "structure"
[nodes]
A = [0, 0]
B = [1, 0]
[elements]
bar = { type = "Truss", nodes = ["A", "B"], area = 1e-4, young = 2e11 }
"""


@pytest.mark.parametrize("section", ["dynamics", "model", "motors"])
@pytest.mark.parametrize("header", ["[{}]", "[{}.a]", "[[{}]]"])
@pytest.mark.parametrize("before", [TEXT, TRUSS], ids=["mechanism", "structure"])
def test_an_unknown_section_gets_no_fix_that_is_not_valid(
    section: str, header: str, before: str, tmp_path: Path
) -> None:
    """A name with a few letters of the section, such as that of a text, is no remedy."""
    text = before + header.format(section) + "\nduration = 2\n"
    problems = picture_of(text, tmp_path / "model.toml", False).problems
    (problem,) = [p for p in problems if p.message.startswith(f"{section}:")]
    assert problem.line == text.count("\n") - 1
    assert "unknown key; known here: " in problem.message and "name" in problem.message
    assert problem.fixes == ()


@pytest.mark.parametrize("live", [False, True])
@pytest.mark.parametrize(
    ("section", "message", "title"),
    [
        ('[body.a]\ntype = "Bar"\n[body.b]\ntype = "Bar"\n', "body: unknown key", "Write bodies"),
        ("[dynamics]\nduration = 1\n", "dynamics: unknown key", None),
        ('[synthesis]\ntype = "path"\nstarts = 0\n', "synthesis.starts: expected a whole", None),
    ],
)
def test_sections_of_a_file_without_bodies_are_checked(
    section: str, message: str, title: str | None, live: bool, tmp_path: Path
) -> None:
    """The blank page, on which bodies are drawn, is shown all the same."""
    for before in NEW.values():
        path = tmp_path / "model.toml"
        blank = picture_of(before, path, live)
        assert blank.page and not blank.problems
        if "structure" in before and "synthesis" in section:
            continue
        text = before + section
        picture = picture_of(text, path, live)
        (problem,) = picture.problems
        assert picture.page == blank.page and picture.summary == "nothing is drawn yet"
        assert problem.level == "error" and problem.message.startswith(message)
        assert problem.line > before.count("\n")
        if title and "structure" not in before:
            (fix,) = problem.fixes
            assert fix.title == title
            mended = text[: fix.start] + fix.insert + text[fix.end :]
            assert mended == text.replace("[body.", "[bodies.")


PARALLEL = (
    "format = 1\ngravity = [0.0, -9.81]\n[bodies]\n"
    + "".join(
        f'b{k} = {{ type = "Bar", length = 0.5, mass = 1, angle = 1.0, position = [{x}, 0] }}\n'
        for k, x in ((1, 0), (2, 1), (3, 2))
    )
    + 'c = { type = "Bar", length = 2, mass = 1, points = { M = [0, 0] } }\n[joints]\n'
    + "".join(
        f'O{k} = {{ type = "Revolute", connect = [{{ body = "ground", at = [{k - 1}, 0] }}, '
        f'"b{k}.start"] }}\nA{k} = {{ type = "Revolute", connect = ["b{k}.end", "c.{end}"] }}\n'
        for k, end in ((1, "start"), (2, "M"), (3, "end"))
    )
)
"""Two parallelograms of one coupler, in which one equation is redundant."""
SPATIAL = """\
format = 1
gravity = [0.0, 0.0, -9.81]
[bodies]
crank = { type = "Bar", length = 0.2, radius = 0.01, density = 1, position = [0.1, 0, 0] }
coupler = { type = "Bar", length = 0.5, radius = 0.01, density = 1, position = [0.45, 0, 0] }
slider = { type = "Box", size = [0.1, 0.1, 0.1], density = 1, position = [0.7, 0, 0] }
[joints.O]
type = "Revolute"
connect = [
  { body = "ground", at = [0, 0, 0], axis = [0, 0, 1] },
  { body = "crank", at = [-0.1, 0, 0], axis = [0, 0, 1] },
]
[joints.A]
type = "Revolute"
connect = [
  { body = "crank", at = [0.1, 0, 0], axis = [0, 0, 1] },
  { body = "coupler", at = [-0.25, 0, 0], axis = [0, 0, 1] },
]
[joints.B]
type = "Revolute"
connect = [
  { body = "coupler", at = [0.25, 0, 0], axis = [0, 0, 1] },
  { body = "slider", at = [0, 0, 0], axis = [0, 0, 1] },
]
[joints.P]
type = "Prismatic"
connect = [
  { body = "ground", at = [0, 0, 0], axis = [1, 0, 0] },
  { body = "slider", at = [0, 0, 0], axis = [1, 0, 0] },
]
"""
"""A slider-crank in space: three equations are redundant."""


@pytest.mark.parametrize(
    ("text", "freedom", "redundant"),
    [(PARALLEL, 1, 1), pytest.param(SPATIAL, 1, 3, marks=pytest.mark.thorough)],
)
def test_a_redundant_constraint_is_freed(
    text: str, freedom: int, redundant: int, tmp_path: Path
) -> None:
    """Every remedy keeps the degrees of freedom, and repeated ones leave nothing redundant."""
    picture = picture_of(text, tmp_path / "model.toml", False)
    assert (picture.facts["degrees_of_freedom"], picture.facts["redundant"]) == (freedom, redundant)
    fixes = [fix for problem in picture.problems for fix in problem.fixes]
    assert fixes
    for fix in fixes:
        mended = text[: fix.start] + fix.insert + text[fix.end :]
        after = picture_of(mended, tmp_path / "model.toml", False)
        assert after.facts["degrees_of_freedom"] == freedom
        assert after.facts["redundant"] < redundant
    while fixes:
        text = text[: fixes[0].start] + fixes[0].insert + text[fixes[0].end :]
        picture = picture_of(text, tmp_path / "model.toml", False)
        fixes = [fix for problem in picture.problems for fix in problem.fixes]
    assert picture.facts["redundant"] == 0


@pytest.mark.thorough
def test_remedies_of_a_text_with_a_preview_are_at_their_places(tmp_path: Path) -> None:
    text = PARALLEL.replace("[bodies]", '[analysis]\ntype = "Kinematics"\nduration = 2\n[bodies]')
    preview = Preview()
    preview.set({"type": "Dynamics", "duration": 0.5, "outputs": 30})
    shown = preview.apply(text)
    picture = picture_of(shown, tmp_path / "model.toml", False)
    problems = list(preview.in_text(picture.problems, text))
    (fix, *_) = [fix for problem in problems for fix in problem.fixes]
    mended = text[: fix.start] + fix.insert + text[fix.end :]
    assert picture_of(mended, tmp_path / "model.toml", False).facts["redundant"] == 0


def test_messages_carry_their_remedies() -> None:
    def names(message: str) -> list[tuple[str, str]]:
        error = ModelError(message, "joints.A")
        return [(r.wrong, r.right) for r in remedies_in(error) if isinstance(r, Rename)]

    assert names(unknown("body", "crnk", ["crank", "rod"])) == [("crnk", "crank")]
    assert names(misspelt("unknown key", "lenght", ["length"], "", is_key=True)) == [("", "length")]
    assert names(unknown("body", "zzz", ["crank"])) == []

    def read() -> None:
        try:
            raise ModelError(unknown("body", "crnk", ["crank"]))
        except ModelError as error:
            raise FileError(f"x.toml: {error}") from None

    with pytest.raises(FileError) as caught:
        read()
    assert [getattr(r, "right", "") for r in remedies_in(caught.value)] == ["crank"]
