"""Live pages in Chromium: time from a slider to the drawing, size of the page, first picture."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks.cases.base import Case, Effort
from benchmarks.sample import Row, Sample
from dalembert.io.analyses import make_analysis
from dalembert.io.model_file import load_model_file
from dalembert.results.files.live_page import live_page

EXAMPLES = Path(__file__).parents[2] / "examples"
MODELS = (
    "four_bar",
    "slider_crank",
    "quick_return_shaper",
    "sewing_machine",
    "n_four_bar",
    "excavator",
    "double_wishbone",
    "rssr_four_bar",
    "spatial_slider_crank",
    "heavy_top",
)
"""Model files; planar, then spatial ones."""
BROWSER = "chromium-headless-shell"
ARGUMENTS = ["--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader"]
DRAGS = 200
DRAG = """async (count) => {
  const { design, player, scene, solver } = dalembert, times = [], slopes = [];
  const [low, high] = design.range(0), first = (design.values[0] - low) / (high - low);
  const slider = document.getElementById("parameter-0"), draw = scene.draw.bind(scene);
  const amplitude = Math.min(0.1, Math.max(first, 1 - first) / 2);
  player.pause();
  let drawn = () => {}, answered = false;
  scene.draw = (paper) => { draw(paper); if (answered) drawn(); };
  solver.onResult.on(() => { answered = true; });
  solver.onFailure.on(() => drawn("failed"));
  let waiting = () => {};
  solver.onSlopes.on(() => waiting());
  for (let k = 0; k < count; k++) {
    answered = false;
    const share = first + amplitude * Math.sin((k + 1) / 8) * (first > 0.5 ? -1 : 1) / 2;
    const picture = new Promise((done) => { drawn = done; });
    const gradient = new Promise((done) => { waiting = done; });
    const begin = performance.now();
    slider.value = String(Math.round(1000 * share) + (k % 2 ? 0.5 : 0));
    design.set(0, low + share * (high - low));
    if (await picture !== "failed") times.push(performance.now() - begin);
    await gradient;
    slopes.push(performance.now() - begin);
  }
  return [times, slopes];
}"""
"""Script that moves the first slider, held by the pointer, and waits for the drawing each time."""


def measure(effort: Effort) -> Iterator[Row]:
    """Times of each example; none without a browser."""
    program = shutil.which(BROWSER)
    if program is None:
        return
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        for name in MODELS[:2] if effort.quick else MODELS:
            yield from _example(browser, Path(folder), name, 20 if effort.quick else DRAGS)
        browser.close()


def _example(browser: Any, folder: Path, name: str, drags: int) -> Iterator[Row]:
    """Rows of an example; a page that is not live gives its reason."""
    file = load_model_file(EXAMPLES / f"{name}.toml")
    model = file.model()
    motion = make_analysis(file, model, None).run(model)
    ordinary, page = folder / "ordinary.html", folder / f"{name}.html"
    motion.report(ordinary, live=False)
    motion.report(page, live=True)
    reason = live_page(motion, motion.page(), True)["live"].get("reason")
    case = f"live page, {name}"
    if reason:
        print(f"{case}: {reason}")
        return
    added = page.stat().st_size - ordinary.stat().st_size
    tab = browser.new_page(viewport={"width": 1400, "height": 950})
    tab.goto(page.as_uri())
    tab.wait_for_selector("html[data-live]", state="attached", timeout=20_000)
    tab.hover("#parameter-0")
    tab.mouse.down()
    times, slopes = tab.evaluate(DRAG, drags)
    tab.mouse.up()
    tab.close()
    note = f"{motion.time.size} instants, page {added / 1e3:.0f} kB larger"
    seconds = [t / 1e3 for t in times]
    yield Row(case, "slider to drawing", {"dalembert": Sample.of(seconds, "s", note)})
    seconds = [t / 1e3 for t in slopes]
    yield Row(case, "slider to gradient", {"dalembert": Sample.of(seconds, "s")})


CASE = Case("live", "slider to drawing of live pages in Chromium", measure)
