"""A four-bar from nothing in the studio: drawn, optimised and saved, as a test and as a film.

``PYTHONPATH=src:tests python tests/studio_build.py docs/gallery/studio.gif`` writes the film.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

from studio_desk import LOOK, Desk
from studio_runs import running_studio

from dalembert.files import atomic_path

DRAWN = (
    ("b", (0, 0), (0.1, 0.3)),
    ("b", (0.1, 0.3), (0.8, 0.5)),
    ("b", (0.8, 0.5), (0.9, 0)),
    ("o", (0, 0), (0.9, 0)),
    ("m", (0, 0)),
)
"""Keys of tools and the places that are clicked with each."""
SHOWN = {"b": "bar", "o": "pin", "m": "motor"}
"""Key of a tool → its name; the palette shows these tools, one of each group."""
FREE = ("bar1", "bar3")
"""Bars whose lengths become parameters."""
OBJECTIVE = "maximum of bar3.angle"
SIZE = (1180, 900)
"""Width and height of the page [pixels]."""
Record = Callable[[float, float, float], None]
"""Records the page with the pointer at a place for some seconds."""


def build(
    visit: Desk, path: Path, record: Record = lambda x, y, seconds: None, shown: int = 0
) -> None:
    """Draw a four-bar, improve it and save it, with the mouse and the keyboard only.

    Parameters
    ----------
    visit : an empty studio
    path : of the file that is saved
    record : called after each action
    shown : number of records of the motion at the end
    """
    page = visit.page
    keys, mouse = page.keyboard, page.mouse

    def click(x: float, y: float, seconds: float = 0.5) -> None:
        record(x, y, 0.25)
        mouse.click(x, y)
        visit.frames()
        record(x, y, seconds)

    def middle(part: Any) -> tuple[float, float]:
        part.scroll_into_view_if_needed()
        box = part.bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    if page.locator(".guide").is_visible():
        page.click(".guide >> text=Not now")
    revision = visit.js("studio.file.revision")
    for key, *places in DRAWN:
        click(*middle(page.locator(f"#palette .group[data-tool={SHOWN[key]}]")), 0.3)
        each = 2 if key == "b" else 1
        for k, place in enumerate(places):
            click(*visit.place(*place), 0.4)
            if (k + 1) % each == 0:
                revision += 1
                visit.settle(revision)
                record(*visit.place(*place), 0.5)
    keys.press("v")
    for bar in FREE:
        row = page.locator(f".cm-line:has-text('{bar} = {{')")
        row.scroll_into_view_if_needed()
        at = visit.js(
            f"(() => {{ const {{ view, text }} = studio.editor; const at = text.search(/{bar} = .*?"
            "length = ./) + 0; const i = text.indexOf('length = ', at) + 10;"
            "const b = view.coordsAtPos(i); return [b.left + 1, (b.top + b.bottom) / 2]; })()"
        )
        click(*at, 0.4)
        click(*middle(page.locator("#make-parameter")), 0.5)
        revision += 1
        visit.settle(revision)
    free = "studio.pictures.page?.design?.parameters.filter(({ drawn }) => !drawn).length"
    visit.until(f"studio.pictures.live && {free} === {len(FREE)}", 60)
    visit.until("studio.pictures.page.solver.duration > 0", 60)
    frame = page.frame_locator("#canvas iframe:not(.loading)")
    click(*middle(frame.locator("#improve")))
    goal = frame.locator(f"select[aria-label^='Goal of {OBJECTIVE}']")
    record(*middle(goal), 0.3)
    goal.select_option("minimise")
    record(*middle(goal), 0.6)
    start = middle(frame.locator("#improve-start"))
    frame.locator("#improve-start").click()
    improvement = "studio.pictures.page.improvement"
    ended = f"(({{ history, running }}) => history.length > 1 && !running)({improvement})"
    for _ in range(400):
        record(*start, 0.15)
        visit.frames()
        if visit.js(ended):
            break
    visit.until("studio.file.undo.startsWith('set ')", 20)
    visit.until("studio.described.revision === studio.file.revision", 20)
    record(*start, 1.0)
    frame.locator("canvas").first.scroll_into_view_if_needed()
    visit.js("studio.pictures.page.player.play()")
    play = middle(frame.locator("#play"))
    for _ in range(shown):
        record(*play, 0.08)
    keys.press("Control+s")
    page.wait_for_selector("#ask input")
    keys.type(path.name)
    record(*play, 0.8)
    keys.press("Enter")
    visit.until("!studio.file.changed && studio.file.path", 20)
    record(*play, 1.5)


ARROW = """(() => {
    const arrow = document.createElement("div");
    arrow.id = "arrow";
    arrow.style.cssText = "position:fixed;z-index:99;pointer-events:none;width:14px;height:20px;"
        + "background:#111;clip-path:polygon(0 0,0 85%,28% 66%,46% 100%,62% 92%,45% 60%,80% 58%);"
        + "filter:drop-shadow(0 0 2px #fff)";
    document.body.append(arrow);
})()"""


def film(target: Path, width: int = 720) -> None:
    """Record the build as an animation.

    Parameters
    ----------
    target : GIF file
    width : of the film [pixels]
    """
    from PIL import Image
    from playwright.sync_api import sync_playwright

    frames: list[Any] = []
    times: list[int] = []
    with sync_playwright() as play, tempfile.TemporaryDirectory() as name:
        engine = play.chromium.launch(executable_path="/usr/bin/chromium-headless-shell")
        with running_studio(Path(name)) as studio:
            page = engine.new_page(viewport={"width": SIZE[0], "height": SIZE[1]})
            page.add_init_script("localStorage.setItem('guide', 'left')")
            visit = Desk(page)
            page.goto(studio.address)
            visit.until("window.studio?.pictures.shown >= 1", 60)
            visit.js(LOOK)
            visit.js("studio.theme.set('light')")
            visit.js(ARROW)

            def record(x: float, y: float, seconds: float) -> None:
                visit.js(
                    f"Object.assign(document.getElementById('arrow').style, "
                    f"{{ left: '{x}px', top: '{y}px' }})"
                )
                image = Image.open(BytesIO(page.screenshot())).convert("RGB")
                size = (width, round(image.height * width / image.width))
                frames.append(image.resize(size, Image.Resampling.LANCZOS))
                times.append(round(1000 * seconds))

            build(visit, Path(name) / "four_bar.toml", record, 24)
        engine.close()
    mosaic = Image.new("RGB", (width, 4 * frames[0].height))
    for k in range(4):
        mosaic.paste(frames[(len(frames) - 1) * k // 3], (0, k * frames[0].height))
    palette = mosaic.quantize(200, method=Image.Quantize.MAXCOVERAGE, kmeans=4)
    packed = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    with atomic_path(target) as temporary:
        packed[0].save(
            temporary,
            "GIF",
            save_all=True,
            append_images=packed[1:],
            duration=times,
            loop=0,
            optimize=True,
        )
    text = f"{len(frames)} frames, {sum(times) / 1000:.1f} s, {target.stat().st_size / 1e3:.0f} kB"
    print(re.sub(r"\s+", " ", text))


if __name__ == "__main__":
    film(Path(sys.argv[1]))
