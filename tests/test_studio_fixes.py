"""Remedies of errors in the studio: each fix makes the text valid, or removes its error."""

from __future__ import annotations

from pathlib import Path

import pytest

from dalembert.studio.pictures import picture_of
from dalembert.text.wording import nearest, suggestion_in, unknown

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
    "type": ('O = { type = "Revolute"', 'O = { type = "Revolut"', "Write Revolute"),
    "body": ('"crank.end"', '"crnk.end"', "Write crank"),
    "point": ('"crank.end"', '"crank.ent"', "Write crank.end"),
    "parameter": ('length = "l1"', 'length = "2*l2x"', None),
    "formula": ('length = "l1"', 'length = "2*l_1"', "Write l1"),
    "format": ("format = 1\n", "", "Insert format = 1"),
    "missing": ("length = 0.5\n", "", "Insert length = 1.0"),
    "inline": (', connect = ["ground", "crank.start"]', "", None),
    "unit": ("length = 0.5", 'length = "5 kg"', None),
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


def test_suggestions_are_those_of_messages() -> None:
    assert suggestion_in(unknown("body", "crnk", ["crank", "rod"])) == ("crnk", "crank")
    assert suggestion_in(f"unknown key{nearest('lenght', ['length'])}; known") == ("", "length")
    assert suggestion_in(unknown("body", "zzz", ["crank"])) is None
