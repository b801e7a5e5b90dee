"""Two pages that edit one file, and a page whose views change while its model is edited."""

from __future__ import annotations

import random
import re
from pathlib import Path
from typing import Any

import pytest
from studio_desk import WAIT, Desk, opened, reset
from studio_runs import Studio, running_studio
from studio_walk import BARRIER
from test_studio_editing import MECHANISM

LINE = re.compile("^.*$", re.MULTILINE)
INSERT = """([at, insert]) => {
    const from = Math.min(at, studio.editor.text.length);  // another page may have shortened it
    studio.editor.view.dispatch({ changes: { from, insert } });
}"""
"""Type without a pause after which the text is sent."""
CONFLICT = "document.querySelector('#ask')?.open ?? false"
SIZES = [(1400, 850), (900, 600), (420, 800), (1800, 500)]


def typed(visit: Desk, rng: random.Random, mark: str) -> None:
    """Type a comment at the end of a line."""
    ends = [match.end() for match in LINE.finditer(visit.text)]
    at = rng.choice(ends)
    visit.page.evaluate(INSERT, [at, f"\n# {mark}"])


def drawn(visit: Desk, rng: random.Random, mark: str) -> None:
    """Change a number as the drawing does."""
    fields = f"[{{ op: 'set', keys: ['description'], value: '{mark}' }}]"
    visit.js(f"studio.edit('{mark}', {fields})")


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [1, 2])
def test_two_pages_and_a_replaced_file_end_with_one_text(
    seed: int, browser: Any, tmp_path: Path
) -> None:
    """No page overwrites the text of the other, or the file of another program, silently."""
    rng, path = random.Random(seed), tmp_path / "model.toml"
    path.write_text(MECHANISM)
    with (
        running_studio(tmp_path, path) as studio,
        opened(browser, studio, "0") as one,
        opened(browser, studio, "0") as two,
    ):
        foreign = ""
        for step in range(150):
            visit = rng.choice([one, two])
            choice = rng.choice(["type", "type", "draw", "undo", "redo", "save", "replace"])
            if choice == "type":
                typed(visit, rng, f"{step}")
            elif choice == "draw":
                drawn(visit, rng, f"{step}")
            elif choice in ("undo", "redo"):
                visit.js(f"studio.{choice}()")
            elif choice == "replace" and rng.random() < 0.3:
                foreign = MECHANISM + f"# another program {step}\n"
                path.write_text(foreign)
            elif choice == "save":
                visit.js("studio.saving.save()")
                visit.page.evaluate(BARRIER)
                if foreign:
                    assert path.read_text() == foreign
                    visit.until(CONFLICT, WAIT)
                    visit.page.locator("#ask button:has-text('Read it again')").click()
                    foreign = ""
                    visit.page.evaluate(BARRIER)
            if rng.random() < 0.3:
                for each in (one, two):
                    each.page.evaluate(BARRIER)
        for each in (one, two, one):
            each.page.evaluate(BARRIER)
        one.until("studio.isAnswered", WAIT)
        two.until("studio.isAnswered", WAIT)
        two.until(f"studio.file.revision === {one.revision}", WAIT)
        assert one.text == two.text and one.document == two.document
        if foreign:
            assert path.read_text() == foreign


def toggle(visit: Desk, rng: random.Random) -> None:
    """Change the theme, the window, or any switch of the studio and its picture."""
    choice = rng.randrange(4)
    if choice == 0:
        visit.js("studio.theme.turn()")
    elif choice == 1:
        width, height = rng.choice(SIZES)
        visit.page.set_viewport_size({"width": width, "height": height})
    elif choice == 2:
        visit.js("studio.pictures.page?.player.toggle?.()")
    else:
        buttons = """[...document.querySelectorAll('[role=tab], [aria-pressed]'),
            ...studio.pictures.frame.contentDocument.querySelectorAll('[aria-pressed]')]
            .filter((node) => node.checkVisibility() && !node.disabled)"""
        visit.js(f"(list => list[{rng.randrange(1000)} % list.length]?.click())({buttons})")


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [1, 2])
def test_views_that_change_lose_no_edit(seed: int, browser: Any, studio_server: Studio) -> None:
    """300 changes of views and texts; the text has all edits, and the page reports no error."""
    rng, marks = random.Random(seed), []
    reset(studio_server)
    with opened(browser, studio_server, "0") as visit:
        visit.show(MECHANISM)
        for step in range(300):
            if rng.random() < 0.25:
                marks.append(f"# mark {step} of {seed}")
                typed(visit, rng, marks[-1][2:])
            else:
                toggle(visit, rng)
        visit.js("studio.request('preview')")  # the analysis chosen last may not suit the model
        marks.append(f"# last mark of {seed}")
        typed(visit, rng, marks[-1][2:])
        visit.page.evaluate(BARRIER)
        visit.until("studio.isAnswered", WAIT)
        visit.settle()
        assert set(marks) <= set(visit.text.splitlines())
        assert not visit.errors_shown()
        for _ in range(len(marks)):
            visit.js("studio.undo()")
        visit.page.evaluate(BARRIER)
        visit.until("studio.isAnswered", WAIT)
        assert not set(marks) & set(visit.text.splitlines())
