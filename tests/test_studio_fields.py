"""Fields of forms take what files take: numbers, quantities with units, formulas."""

from __future__ import annotations

from pathlib import Path

import pytest
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
    """A law cannot be removed: the field shows the former one, and the page states why."""
    fields = drawn_by("studio_fields.mjs", tmp_path)["fields"]
    accepted = {"value": "3*t", "invalid": "false", "validity": "", "bubbles": 0}
    accepted |= {"refused": [], "done": ["3*t"]}
    restored = {"value": "2*t", "refused": [["refused", "needs a law"]], "done": []}
    assert fields[:2] == [accepted | restored] * 2
    assert fields[2] == accepted
    assert fields[3] == accepted | {"value": "", "done": [None]}
    for field, words in zip(fields[4:], ("1.5", "needed"), strict=True):
        assert field["done"] == [] and field["invalid"] == "true" and field["bubbles"] == 1
        assert words in field["validity"] and field["refused"] == [["refused", field["validity"]]]


def test_labels_of_the_chart_of_a_function_are_inside_it(tmp_path: Path) -> None:
    """Characters of system fonts are narrower than 0.65 of their size, 20 px."""
    chart = drawn_by("studio_chart.mjs", tmp_path)
    size, wide = chart["size"], 0.65 * 20
    assert [label["text"] for label in chart["labels"]][:5] == ["0°", "90°", "180°", "270°", "360°"]
    for label in chart["labels"]:
        width = wide * len(label["text"])
        left = label["x"] - {"left": 0, "center": 0.5, "right": 1}[label["align"]] * width
        assert left >= 0 and left + width <= size["width"], label
        assert label["font"].startswith("20px") and 20 <= label["y"] <= size["height"], label
    (left, bottom), (right, top) = chart["pixels"]
    assert 0 < left < right < size["width"] and 0 < top < bottom < size["height"]
    assert chart["same"] == pytest.approx([2, 0.7])
