"""Fields of forms take what files take: numbers, quantities with units, formulas."""

from __future__ import annotations

from pathlib import Path

from studio_scripts import drawn_by


def test_fields_take_numbers_units_and_formulas(tmp_path: Path) -> None:
    replies = drawn_by("studio_fields.mjs", tmp_path)["values"]
    values = [0.002, "45 mm", "pi/4", None, "1.5", 0.001, 12, "12 mm", "1.5", "RK4"]
    values += ["'0' is less than 1", "'-1' is less than 1", 0, None]
    for reply, value in zip(replies, values, strict=True):
        assert reply.get("value") == value or str(value) in reply["problem"], reply
    problems = [k for k, reply in enumerate(replies) if "problem" in reply]
    assert problems == [4, 7, 8, 10, 11]


def test_an_emptied_field_is_restored_or_removes_its_value(tmp_path: Path) -> None:
    """A law cannot be removed: the field shows the former one and states why, until it is left."""
    fields = drawn_by("studio_fields.mjs", tmp_path)["fields"]
    restored = {"value": "2*t", "invalid": "false", "messages": ["needs a law"], "done": []}
    assert fields[:2] == [restored | {"left": ""}] * 2
    accepted = {"value": "3*t", "invalid": "false", "messages": [], "done": ["3*t"], "left": ""}
    assert fields[2] == accepted
    assert fields[3] == accepted | {"value": "", "done": [None]}
    assert fields[4]["done"] == [] and fields[4]["invalid"] == "true" and "1.5" in fields[4]["left"]
    assert fields[5]["messages"] == ["needed"] and fields[5]["invalid"] == "true"
