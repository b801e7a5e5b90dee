"""A browser for tests of pages: Debian's chromium, driven by playwright."""

from __future__ import annotations

import asyncio
import functools
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from dalembert.report.page import write_page

ARGS = (
    "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
    "--disable-background-networking --disable-component-update --disable-sync "
    "--use-angle=swiftshader --enable-unsafe-swiftshader --webgl-antialiasing-mode=none"
).split()
"""Smooth edges take a quarter of the processor time of spatial pictures without a graphics card."""

DRIVER = "GL Driver Message"
"""In what the machine's graphics driver says of itself, as when pixels are read back."""


def missing(what: str) -> None:
    """Skip the test, or fail it where everything has to be there."""
    if os.environ.get("CI", "").lower() == "true":
        pytest.fail(f"{what} is missing", pytrace=False)
    pytest.skip(f"{what} is missing")


@dataclass
class Visit:
    """One open page and what it did: requests beyond its own file, console lines, errors."""

    page: Any
    requests: list[str] = field(default_factory=list)
    console: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def js(self, expression: str) -> Any:
        """Return the value of a JavaScript expression in the page."""
        return self.page.evaluate(expression)

    def until(self, expression: str, seconds: float = 120.0) -> None:
        """Wait until a JavaScript expression holds; so long only where it never will."""
        # The page forbids eval, and with it playwright's own waiting for a function.
        end = time.monotonic() + seconds
        while not self._holds(expression):
            assert not self.errors, self.errors
            assert time.monotonic() < end, f"in {seconds} s it did not come true: {expression}"

    def _holds(self, expression: str) -> bool:
        """Whether an expression comes true within a fraction of a second; the page looks."""
        waiting = f"""() => new Promise((done, failed) => {{
            const end = performance.now() + 300;
            const look = () => {{
                try {{
                    const holds = Boolean(({expression}));
                    if (holds || performance.now() > end) done(holds);
                    else setTimeout(look, 15);
                }} catch (error) {{ failed(error); }}
            }};
            look();
        }})"""
        return bool(self.page.evaluate(waiting))

    def frames(self, count: int = 2) -> None:
        """Wait until the page has drawn some times."""
        self.js(
            f"""new Promise(done => {{
                let n = {count};
                const next = () => n-- > 0 ? requestAnimationFrame(next) : done();
                next();
            }})"""
        )

    def ink(self, selector: str) -> int:
        """Return how many colours a canvas shows: one means blank."""
        return self.js(
            f"""(() => {{
                const shown = document.querySelector({selector!r});
                const canvas = Object.assign(document.createElement("canvas"),
                    {{ width: shown.width, height: shown.height }});
                const ctx = canvas.getContext("2d");
                ctx.drawImage(shown, 0, 0);
                const data = ctx.getImageData(0, 0, canvas.width, canvas.height).data;
                return new Set(new Uint32Array(data.buffer)).size;
            }})()"""
        )

    def picture(self, selector: str) -> str:
        """Return a canvas as a string which differs when the picture does."""
        return self.js(f"document.querySelector({selector!r}).toDataURL()")


@contextmanager
def chromium() -> Iterator[Any]:
    """Start the browser; skip, or under CI=true fail, when there is none."""
    path = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    if path is None:
        missing("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        missing("playwright")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=ARGS)
        try:
            yield browser
        finally:
            browser.close()


@pytest.fixture(scope="session")
def session_browser() -> Iterator[tuple[Any, Any]]:
    """The browser of all modules, and the loop in which its calls run."""
    with chromium() as started:
        loop = asyncio.events._get_running_loop()
        asyncio.events._set_running_loop(None)
        yield started, loop
        asyncio.events._set_running_loop(loop)


@pytest.fixture(scope="module")
def browser(session_browser: tuple[Any, Any]) -> Iterator[Any]:
    """The browser; its loop counts as running only in modules that use it.

    Other modules run loops of their own in the same thread.
    """
    started, loop = session_browser
    asyncio.events._set_running_loop(loop)
    yield started
    asyncio.events._set_running_loop(None)


@contextmanager
def visit(
    browser: Any,
    path: Path,
    *,
    viewport: tuple[int, int] = (1440, 900),
    scheme: str = "light",
    still: bool = True,
    before: str = "",
) -> Iterator[Visit]:
    """Open a file.

    ``still`` asks for reduced motion, so that nothing plays by itself; the script ``before`` runs
    ahead of the page's.
    """
    page = _context(browser, viewport, scheme, still).new_page()
    try:
        page.add_init_script(before)
        url = path.resolve().as_uri()
        visit = Visit(page)
        page.on(
            "request",
            lambda r: (
                None
                if r.url == url or r.url.startswith(("data:", "blob:"))
                else visit.requests.append(r.url)
            ),
        )
        page.on("console", lambda m: DRIVER in m.text or visit.console.append(m.text))
        page.on("pageerror", lambda e: (visit.console.append(str(e)), visit.errors.append(str(e))))
        page.goto(url)
        visit.until("window.dalembert !== undefined")
        visit.frames(3)
        yield visit
    finally:
        page.close()


@functools.lru_cache(maxsize=16)
def _context(browser: Any, viewport: tuple[int, int], scheme: str, still: bool) -> Any:
    """A profile for pages, which store nothing in it."""
    return browser.new_context(
        viewport={"width": viewport[0], "height": viewport[1]},
        color_scheme=scheme,
        reduced_motion="reduce" if still else "no-preference",
    )


@pytest.fixture
def show(browser: Any, tmp_path: Path) -> Iterator[Any]:
    """Open the page of a payload or a result; in the end it has asked for and told nothing."""
    pages: list[tuple[Any, Visit]] = []

    def opened(shown: Any, **options: Any) -> Visit:
        path = tmp_path / f"{len(pages)}.html"
        page = write_page(shown, path) if isinstance(shown, dict) else shown.report(path)
        manager = visit(browser, page, **options)
        pages.append((manager, manager.__enter__()))
        return pages[-1][1]

    yield opened
    seen = [(visit.requests, visit.console) for _, visit in pages]
    for manager, _ in pages:
        manager.__exit__(None, None, None)
    assert seen == [([], [])] * len(seen)
