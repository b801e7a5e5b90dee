"""Lists in the text: items moved, names added and removed; the others stay as they are written."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from studio_desk import Desk
from studio_runs import Studio
from test_studio_kept_texts import operations_of, replaced

from dalembert.errors import ModelError
from dalembert.studio.drawing_edits import apply


def test_a_moved_item_goes_with_its_comment() -> None:
    """The last line has no comma; in a line of several items comments stay."""
    text = "[a]\nb = [\n  1,  # one\n  2,\n  3  # three\n]  # end\nc = [4, 5, 6]  # four\n"
    for keys, to, parts in (
        (["a", "b", 2], 0, [("1,  # one\n  2,\n  3  # three", "3,  # three\n  1,  # one\n  2")]),
        (["a", "b", 0], 1, [("1,  # one\n  2,", "2,\n  1,  # one")]),
        (["a", "c", 0], 2, [("[4, 5, 6]", "[5, 6, 4]")]),
    ):
        assert apply(text, [{"op": "move_item", "keys": keys, "to": to}]) == replaced(text, parts)
    for to in (3, -1, True, None):
        with pytest.raises(ModelError):
            apply(text, [{"op": "move_item", "keys": ["a", "b", 0], "to": to}])


NAMES = """\
[pareto]
minimize = [
  "stress",  # of the steel
  "mass",
]
maximize = "life"
"""


def test_a_name_of_a_list_keeps_all_others(tmp_path: Path) -> None:
    table = tomllib.loads(NAMES)["pareto"]
    low, high = ["pareto", "minimize"], ["pareto", "maximize"]
    calls = [
        ["nameChange", low, table["minimize"], "sag", True],
        ["nameChange", low, table["minimize"], "mass", False],
        ["nameChange", low, table["minimize"], "mass", True],
        ["nameChange", low, ["mass"], "mass", False],
        ["nameChange", high, table["maximize"], "sag", True],
        ["nameChange", high, table["maximize"], "lif", False],
        ["nameChange", ["pareto", "vary"], None, "k", True],
    ]
    added, removed, same, emptied, single, part, first = operations_of(
        tmp_path, "row_changes.js", *calls
    )
    assert apply(NAMES, added) == replaced(NAMES, [('"mass",\n', '"mass",\n  "sag",\n')])
    assert apply(NAMES, removed) == replaced(NAMES, [('  "mass",\n', "")])
    assert same == part == []
    assert "minimize" not in tomllib.loads(apply(NAMES, emptied))["pareto"]
    assert apply(NAMES, single) == replaced(NAMES, [('"life"', '["life", "sag"]')])
    assert apply(NAMES, first) == f'{NAMES}vary = ["k"]\n'


FORM = """format = 1

[parameters]
k = { value = 100.0, bounds = [50.0, 200.0] }
m = { value = 1.0, bounds = [0.5, 2.0] }
n = { value = 1.0, bounds = [0.5, 2.0] }

[bodies]
mass = { type = "Particle", mass = "m", position = [1.0, 0.0] }

[responses]
low = { type = "Minimum", measure = "mass.x" }
top = { type = "Maximum", measure = "mass.x" }

[optimize]
minimize = "low"
vary = [
  "k",  # stiffness
  "m",  # mass
]

[pareto]
minimize = [
  "low",  # first
  "top",  # second
]
"""


@pytest.mark.thorough
def test_parameters_and_aims_of_the_form_keep_their_comments(
    shared_desk: tuple[Desk, Studio],
) -> None:
    visit, _ = shared_desk
    visit.show(FORM)
    visit.page.click("#tab-design")

    def changed(act: Callable[[], Any]) -> str:
        revision = visit.revision
        act()
        visit.until(f"studio.file.revision > {revision} && studio.isAnswered", 20)
        return visit.text

    text = FORM.replace('  "m",  # mass\n', '  "m",  # mass\n  "n",\n')
    assert changed(lambda: visit.page.check("[name=vary-n]")) == text
    text = text.replace('  "k",  # stiffness\n', "")
    assert changed(lambda: visit.page.uncheck("[name=vary-k]")) == text
    visit.page.locator(".design .pick", has_text="Pareto").click()
    text = text.replace('  "top",  # second\n]\n', ']\nmaximize = ["top"]\n')
    assert changed(lambda: visit.page.select_option("[name=aim-top]", "maximize")) == text
    visit.page.locator(".design .pick", has_text="Optimise").click()
    visit.page.click("#tab-text")
