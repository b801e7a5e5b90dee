"""Time from the move of a pointer to the picture of the dragged mechanism in the studio.

``PYTHONPATH=$PWD/src:tests python -m benchmarks.studio_drags`` drags a joint of a planar four-bar
and a point of a spatial one. It prints the times after a move of the pointer at which the page has
computed the motion and at which it is drawn on the canvas. The screen shows it in its next frame.
"""

from __future__ import annotations

import math
import statistics
import tempfile
from pathlib import Path

from browser import chromium
from studio_desk import Desk, opened
from studio_runs import running_studio
from test_studio_space import SpaceDesk

from benchmarks.studio_changes import FOUR_BAR

SPATIAL = Path(__file__).parents[1] / "examples" / "rssr_four_bar.toml"
TIP = '{ section: "bodies", name: "rocker", part: "points", key: "tip" }'
END = """(() => {
    const { motion } = studio.pictures.page;
    const { body, point } = motion.points.find(({ name }) => name === "bar2.end");
    return motion.placed(motion.pose(body), point);
})()"""
WATCH = """(() => {
    const { scene, solver } = studio.pictures.page, draw = scene.draw.bind(scene);
    window.drags = { computed: [], drawn: [] };
    let begin = 0, computed = false;
    const since = (list) => list.push(performance.now() - begin);
    const emit = solver.onResult.emit.bind(solver.onResult);
    solver.onResult.emit = (result) => {
        if (begin) { since(window.drags.computed); computed = true; }
        emit(result);
    };
    scene.draw = (paper) => {
        draw(paper);
        if (begin && computed) { since(window.drags.drawn); begin = 0; }
    };
    const { space } = document.documentElement.dataset;
    const drawing = space === "true" ? studio.space : studio.drawing;
    const over = drawing.over.bind(drawing);
    drawing.over = (event, at) => {
        if (!begin) { begin = performance.now(); computed = false; }
        over(event, at);
    };
})()"""
"""Notes the times after moves of the pointer over the picture."""
MOVES = 120


def drag(desk: Desk, place: tuple[float, float], amplitude: float) -> None:
    """Drag what is at a place of the screen to and fro."""
    mouse, (x, y) = desk.page.mouse, place
    mouse.move(x, y)
    mouse.down()
    desk.page.keyboard.down("Alt")  # without the grid
    mouse.move(x, y + 2)
    desk.js(WATCH)
    for k in range(MOVES):
        count = desk.js("window.drags.drawn.length")
        mouse.move(x, y + amplitude * math.sin((k + 1) / 8))
        desk.until(f"window.drags.drawn.length > {count}", 5)
        desk.page.wait_for_timeout(7 * k % 23)
    desk.page.keyboard.press("Escape")
    mouse.up()
    desk.page.keyboard.up("Alt")


def report(desk: Desk, name: str) -> None:
    """Print the measured times."""
    for step in ("computed", "drawn"):
        times = sorted(desk.js(f"window.drags.{step}"))[: 2 * MOVES]
        middle, high = statistics.median(times), times[int(0.9 * len(times))]
        print(f"{name}: {step} after {middle:5.1f} ms (median of {len(times)}), 90 %: {high:5.1f}")


def main() -> None:
    with (
        tempfile.TemporaryDirectory() as folder,
        running_studio(Path(folder)) as studio,
        chromium() as browser,
    ):
        with opened(browser, studio) as desk:
            desk.show(FOUR_BAR)
            desk.until("studio.pictures.live && studio.pictures.page.solver.duration > 0", 60)
            desk.page.keyboard.press("v")
            place = desk.js(END)
            drag(desk, desk.place(*place), 20.0)
            report(desk, "planar four-bar")
        with opened(browser, studio, look="0", kind=SpaceDesk) as desk:
            desk.show(SPATIAL.read_text("utf-8"))
            desk.until("studio.pictures.live && studio.pictures.page.solver.duration > 0", 60)
            desk.js(f"studio.space.select({TIP})")
            drag(desk, desk.handle("move", "z"), -20.0)
            report(desk, "spatial four-bar")


if __name__ == "__main__":
    main()
