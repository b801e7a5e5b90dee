"""A studio with a structure that is drawn by the mouse and the keyboard."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import browser  # noqa: F401
from studio_desk import Desk, opened, reset
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file

NEW = 'format = 1\nkind = "structure"\nname = "untitled"\n'
LOOK = """(() => {
    const { view } = studio.pictures.page.scene;
    Object.assign(view, { x: 1, y: 0.4, s: 190, fitted: false });
    view.onChange();
})()"""


@pytest.fixture(scope="module")
def page(browser: Any, studio_server: Studio) -> Iterator[tuple[Desk, Path]]:  # noqa: F811
    reset(studio_server)
    with opened(browser, studio_server, "0") as visit:
        visit.page.click("text=Open…")
        visit.page.click("text=New structure")
        visit.until("document.documentElement.dataset.structure === 'true'", 20)
        visit.settle()
        yield visit, studio_server.folder


@pytest.fixture
def desk(page: tuple[Desk, Path]) -> Desk:
    """The studio with an empty structure."""
    visit, _ = page
    visit.page.keyboard.press("Escape")
    start(visit, NEW)
    visit.js(LOOK)
    return visit


def start(visit: Desk, text: str) -> None:
    """Replace the text, and wait for its picture."""
    if visit.text != text:
        revision = visit.js("studio.file.revision")
        send = "text => { studio.editor.show(text); studio.sendText(text); }"
        visit.page.evaluate(send, text)
        visit.settle(revision + 1)
    visit.js("studio.structure.choose('select')")
    visit.js("studio.structure.select([])")


def use(
    visit: Desk,
    key: str,
    clicks: list[tuple[float, float]],
    typed: str = "",
    end: str = "",
    shown: bool = True,
) -> None:
    """Use a tool: each change is awaited, so that a slow machine loses no click.

    Without ``shown`` the picture is not awaited.
    """
    visit.page.locator("#structure-palette button").first.focus()
    visit.page.keyboard.press(key)
    revision = visit.js("studio.file.revision")
    chain = key in "be"
    for k, place in enumerate(clicks):
        visit.click(*place)
        if chain and k:
            visit.until(f"studio.file.revision >= {revision + k}", 20)
    if typed:
        visit.page.keyboard.type(typed)
    if end:
        visit.page.keyboard.press(end)
    visit.until(f"studio.file.revision > {revision} && !studio.pending", 20)
    if shown:
        visit.settle(visit.js("studio.file.revision"))


def problems(visit: Desk) -> list[str]:
    return visit.page.locator("#problems .error").all_inner_texts()


def solved(text: str, folder: Path) -> Any:
    path = folder / "drawn.toml"
    path.write_text(text, encoding="utf-8")
    return da.solve_statics(load_model_file(path).model())
