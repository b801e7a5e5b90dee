"""Pages of a studio in a browser that are worked on with the mouse and the keyboard.

All tests share one server, which opens another model for each of them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import pytest
from browser import DRIVER, Visit
from studio_runs import Studio, running_studio
from websockets.sync.client import connect

UNTITLED = 'format = 1\nname = "untitled"\ngravity = [0.0, -9.81]\n'
WAIT = 180.0
"""Upper limit of the time for a picture, on a busy machine [s]."""
PIXEL = """(place) => {
    const { canvas, view } = studio.pictures.page.scene;
    const [u, v] = view.screen(place) ?? [NaN, NaN];
    const inner = canvas.getBoundingClientRect();
    const outer = studio.pictures.frame.getBoundingClientRect();
    return [u + inner.left + outer.left, v + inner.top + outer.top];
}"""
"""Position of a place of the drawing on the screen; NaN for one behind the eye."""
LOOK = """(() => {
    const { view } = studio.pictures.page.scene;
    Object.assign(view, { x: 0.5, y: 0.3, s: 400, fitted: false });
    view.onChange();
})()"""


class Desk(Visit):
    """Page of a studio.

    Attributes
    ----------
    base : first revision of its text
    """

    base = 0

    @property
    def text(self) -> str:
        return str(self.js("studio.editor.text"))

    @property
    def document(self) -> dict[str, Any]:
        document: dict[str, Any] = self.js("studio.file.document")
        return document

    @property
    def revision(self) -> int:
        return int(self.js("studio.file.revision"))

    @property
    def shown(self) -> int:
        """Number of the picture."""
        return int((self.js("document.documentElement.dataset.picture") or "0").split()[0])

    def settle(self, revision: int | None = None) -> None:
        """Wait until the picture is that of a revision of the text, by default the present one."""
        wanted = self.revision if revision is None else revision
        self.until(f"studio.described?.revision >= {wanted}", WAIT)
        self.until("studio.pictures.shown === studio.described?.number", WAIT)

    def place(self, *place: float) -> tuple[float, float]:
        return tuple(self.page.evaluate(PIXEL, list(place)))  # type: ignore[return-value]

    def click(self, *place: float) -> None:
        self.page.mouse.move(*self.place(*place))
        self.page.mouse.down()
        self.page.mouse.up()

    def drag(self, start: tuple[float, ...], end: tuple[float, ...], steps: int = 4) -> None:
        self.page.mouse.move(*self.place(*start))
        self.page.mouse.down()
        self.page.mouse.move(*self.place(*end), steps=steps)
        self.page.mouse.up()

    def draw(self, key: str, *places: tuple[float, float]) -> None:
        """Use a tool, chosen by its key."""
        revision = self.revision
        self.page.locator("#palette button").first.focus()
        self.page.keyboard.press(key)
        for place in places:
            self.click(*place)
        self.settle(revision + 1)

    def press(self, keys: str) -> None:
        revision = self.revision
        self.page.keyboard.press(keys)
        self.settle(revision + 1)

    def show(self, text: str) -> None:
        """Replace the text."""
        if self.text != text:
            revision = self.revision
            self.page.evaluate("text => { studio.editor.show(text); studio.sendText(text); }", text)
            self.settle(revision + 1)

    def errors_shown(self) -> list[str]:
        """Errors beside the text."""
        errors: list[str] = self.page.locator("#problems .error").all_inner_texts()
        return errors


D = TypeVar("D", bound=Desk)


def reset(studio: Studio, **request: Any) -> None:
    """Open a new model, or the one that a request names, in a running studio."""
    address = studio.address.replace("http:", "ws:") + "socket"
    origin: Any = f"http://{studio.host}"
    with connect(address, origin=origin, max_size=None, close_timeout=1) as socket:
        before = json.loads(socket.recv(timeout=20))["revision"]
        socket.send(json.dumps({"kind": "open"} | request))
        while True:
            message = json.loads(socket.recv(timeout=20))
            if message["kind"] == "text" and message["revision"] > before:
                break


@contextmanager
def opened(
    browser: Any,
    studio: Studio,
    look: str = LOOK,
    size: tuple[int, int] = (1400, 850),
    kind: type[D] = Desk,  # type: ignore[assignment]
) -> Iterator[D]:
    """A page of a studio; in the end it has asked for and told nothing."""
    viewport = {"width": size[0], "height": size[1]}
    page = browser.new_page(viewport=viewport, reduced_motion="reduce")
    visit = kind(page)
    own = (studio.address, "data:", "blob:")
    page.on("request", lambda r: r.url.startswith(own) or visit.requests.append(r.url))
    page.on("console", lambda m: DRIVER in m.text or visit.console.append(m.text))
    page.on("pageerror", lambda e: visit.errors.append(str(e)))
    page.goto(studio.address)
    visit.until("window.studio?.pictures.shown >= 1", WAIT)
    visit.settle()
    visit.base = visit.revision
    visit.js(look)
    try:
        yield visit
        noted = visit.requests, visit.console, visit.errors
        assert noted == ([], [], []), noted
    finally:
        page.close()


@pytest.fixture(scope="session")
def studio_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """A studio for all tests; each opens the model that it needs."""
    with running_studio(tmp_path_factory.mktemp("desks")) as studio:
        yield studio


@pytest.fixture(scope="session")
def still_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    """A studio without pictures that compute."""
    with running_studio(tmp_path_factory.mktemp("still_desks"), live=False) as studio:
        yield studio


@pytest.fixture
def desk(browser: Any, studio_server: Studio) -> Iterator[tuple[Desk, Studio]]:
    """A page with a new model."""
    reset(studio_server)
    with opened(browser, studio_server) as visit:
        yield visit, studio_server


@pytest.fixture(scope="module")
def shared_page(browser: Any, still_server: Studio) -> Iterator[Desk]:
    """A page without pictures that compute, which the tests of a module use in turn."""
    reset(still_server)
    with opened(browser, still_server) as visit:
        yield visit


@pytest.fixture
def shared_desk(shared_page: Desk, still_server: Studio) -> tuple[Desk, Studio]:
    """This page with a new model and the tool that selects.

    For tests of drawings, which begin with a text of their own: to load a page takes a second of
    the processor.
    """
    visit = shared_page
    if visit.revision != visit.base:
        visit.page.keyboard.press("Escape")
        visit.page.keyboard.press("Escape")
        revision = visit.revision
        reset(still_server)
        visit.settle(revision + 1)
        visit.page.keyboard.press("Escape")
        visit.page.locator("#palette button").first.click()
        visit.js(LOOK)
        visit.base = visit.revision
    return visit, still_server
