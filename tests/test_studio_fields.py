"""Fields of forms take what files take: numbers, quantities with units, formulas."""

from __future__ import annotations

from pathlib import Path

from studio_scripts import drawn_by


def test_fields_take_numbers_units_and_formulas(tmp_path: Path) -> None:
    replies = drawn_by("studio_fields.mjs", tmp_path)
    values = [0.002, "45 mm", "pi/4", None, "1.5", 0.001, 12, "12 mm", "1.5", "RK4"]
    for reply, value in zip(replies, values, strict=True):
        assert reply.get("value") == value or str(value) in reply["problem"], reply
    assert ["problem" in reply for reply in replies] == [k in (4, 7, 8) for k in range(10)]
