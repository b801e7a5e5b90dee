"""The dialog Open by keyboard."""

from __future__ import annotations

from pathlib import Path

from studio_desk import UNTITLED, Desk
from studio_runs import Studio

FOCUSED = "document.activeElement.title || document.activeElement.placeholder"
OPEN = "document.getElementById('sheet').open"
HEADINGS = "[...document.querySelectorAll('#sheet section h3')].filter((h) => h.offsetWidth).length"


def test_enter_opens_the_file_that_a_word_names(desk: tuple[Desk, Studio]) -> None:
    """Of several it goes to the first; a path that is not there is refused."""
    visit, studio = desk
    for name in ("quokka_one", "quokka_two"):
        (studio.folder / f"{name}.toml").write_text(UNTITLED.replace("untitled", name), "utf-8")
    keyboard = visit.page.keyboard
    keyboard.press("Control+o")
    visit.until(OPEN, 10)
    keyboard.type("quokka")
    assert visit.js(HEADINGS) == 1  # of the folder; no heading without entries
    keyboard.press("Enter")
    assert visit.js(OPEN)
    assert Path(visit.js(FOCUSED)).name == "quokka_one.toml"
    keyboard.press("Escape")
    visit.until(f"!{OPEN}", 10)

    keyboard.press("Control+o")
    visit.until(OPEN, 10)
    keyboard.type("quokka_t")
    keyboard.press("Enter")
    visit.until("studio.file.path.endsWith('quokka_two.toml')", 20)
    visit.settle()

    keyboard.press("Control+o")
    visit.until(OPEN, 10)
    keyboard.type("quokka.toml")
    keyboard.press("Enter")
    visit.until("document.getElementById('notice').textContent.includes('no such file')", 10)
