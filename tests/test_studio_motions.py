"""Motions of pictures: those that take long are shown in part, costly checks follow later."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import dalembert as da
from dalembert.analysis.dynamics import step_accuracy
from dalembert.io import load_model_file
from dalembert.studio import shown_motion
from dalembert.studio.picture_feed import PictureFeed
from dalembert.studio.pictures import Picture, picture_of, result_of
from dalembert.studio.problems import Problem

PENDULUMS = """format = 1
gravity = [0.0, -9.81]
[bodies]
a = { type = "Bar", length = 0.4, mass = 1.0, angle = 1.5 }
b = { type = "Bar", length = 0.4, mass = 1.0, angle = 1.5 }
[joints]
O = { type = "Revolute", connect = ["ground", "a.start"] }
A = { type = "Revolute", connect = ["a.end", "b.start"] }
"""
HOURS = PENDULUMS + '[analysis]\ntype = "Dynamics"\nduration = 7200.0\noutputs = 101\n'
SHORT = PENDULUMS + '[analysis]\ntype = "Dynamics"\nduration = 0.2\n'


@pytest.mark.few(1)
@pytest.mark.parametrize(("text", "limit"), [(HOURS, "STATED"), (PENDULUMS, "USUAL")])
def test_a_motion_that_takes_long_is_shown_in_part(
    text: str, limit: str, tmp_path: Path, monkeypatch: Any
) -> None:
    monkeypatch.setattr(shown_motion, limit, 0.0)
    monkeypatch.setattr(da.analysis.explore, "DURATION", 7200.0)
    picture = picture_of(text, tmp_path / "long.toml", live=False)
    assert picture.page
    (problem,) = (p for p in picture.problems if "is shown until" in p.message)
    assert problem.level == "warning" and "computed in 0 s" in problem.message
    assert not picture_of(text, tmp_path / "long.toml", live=True).page


def test_checks_as_long_as_the_run_come_with_the_live_picture(
    tmp_path: Path, monkeypatch: Any
) -> None:
    """The accuracy is estimated by a second run; here any estimate exceeds the tolerance."""
    monkeypatch.setattr(step_accuracy, "ENOUGH", 0.0)
    path = tmp_path / "short.toml"
    path.write_text(SHORT)
    file = load_model_file(path)
    result = result_of(file, file.model())
    (warning,) = (w for w in result.warnings if "estimated error" in w)
    still, live = (picture_of(SHORT, path, live) for live in (False, True))
    assert warning not in [problem.message for problem in still.problems]
    assert ["estimated error" in problem.message for problem in live.late] == [True]


def test_the_first_picture_repeats_no_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its page has no statistics that show, whose estimate of the error takes two more runs."""

    def repeated(accuracy: Any) -> None:
        pytest.fail("the run was repeated")

    monkeypatch.setattr(step_accuracy.StepAccuracy, "estimate", property(repeated))
    picture = picture_of(SHORT, tmp_path / "short.toml", live=False)
    assert picture.page and "estimated error" not in picture.page


def test_late_warnings_are_added_to_those_of_the_still_picture() -> None:
    messages: list[dict[str, Any]] = []
    feed = PictureFeed(messages.append, lambda problems: problems)
    first, late = Problem("warning", "first"), Problem("warning", "late")
    feed.show("still", 0, Picture("page", (first,)))
    feed.show("live", 0, Picture("", (first,), late=(late,)))
    assert [[p["message"] for p in m["problems"]] for m in messages] == [
        ["first"],
        ["first", "late"],
    ]
    assert [message["number"] for message in feed.present()] == [0, 0]
