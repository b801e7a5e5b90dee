"""A drag in a spatial mechanism is computed by the page: its loop is closed at every place."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from test_studio_space import SpaceDesk, desk  # noqa: F401

EXAMPLES = Path(__file__).parents[1] / "examples"
TIP = '{ section: "bodies", name: "rocker", part: "points", key: "tip" }'
POINTS = """(() => {
    const { motion } = studio.pictures.page;
    const place = ({ name, body, point }) => [name, motion.at(body, point)];
    return Object.fromEntries(motion.points.map(place));
})()"""
FIRST_POINTS = POINTS.replace("motion.at(body, point)", "motion.at(body, point, { i: 0, f: 0 })")
COUNTED = """(() => {
    const { page } = studio.pictures;
    [window.results, window.instants, page.picture.took] = [0, [], 1000];  // as of a slow run
    page.solver.onResult.on(({ times }) => {
        window.results++;
        window.instants.push(times.length);
    });
    window.solids = page.scene.painter.parts;
})()"""
"""Counts the results of a drag and their instants; marks the solids of the picture."""


@pytest.mark.usefixtures("desk")
def test_a_drag_keeps_the_loop_closed(desk: SpaceDesk) -> None:  # noqa: F811
    text = (EXAMPLES / "rssr_four_bar.toml").read_text("utf-8")
    desk.show(text)
    desk.until("studio.pictures.live", 60)
    desk.until("studio.pictures.frame.contentDocument.documentElement.dataset.live", 20)
    desk.js(f"studio.space.select({TIP})")
    length = tomllib.loads(text)["parameters"]["l"]["value"]
    before = {name: np.array(p) for name, p in desk.js(POINTS).items()}
    desk.js(COUNTED)
    x, y = desk.handle("move", "z")
    desk.page.mouse.move(x, y)
    desk.page.mouse.down()
    desk.page.keyboard.down("Alt")  # freely, not to the grid: a long rocker opens the loop
    moved = []
    for k in range(1, 5):
        number = desk.js("window.results")
        desk.page.mouse.move(x, y - 6 * k)
        desk.until(f"window.results > {number}", 20)
        points = {name: np.array(p) for name, p in desk.js(FIRST_POINTS).items()}
        distance = np.linalg.norm(points["rocker.tip"] - points["crank.tip"])
        assert distance == pytest.approx(length, abs=1e-9)
        moved.append(points["rocker.tip"])
    assert desk.text == text  # nothing is written before it is released
    assert 1 in desk.js("window.instants")  # a drag shows the first instant alone
    if set(desk.js("window.instants")) == {1}:  # no pause was so long that the motion followed
        assert desk.js("window.solids === studio.pictures.page.scene.painter.parts")
    assert np.linalg.norm(moved[-1] - before["rocker.tip"]) > 0.01
    wanted = np.array(desk.js("studio.space.held.after.p"))
    axis = np.array([0.0, 0.5, -0.1])  # of the rocker, along x: its length follows the pointer
    reach = np.linalg.norm((moved[-1] - axis)[1:])
    assert reach == pytest.approx(np.linalg.norm((wanted - axis)[1:]), rel=1e-6)
    desk.changed(desk.page.mouse.up)
    desk.page.keyboard.up("Alt")
    values = tomllib.loads(desk.text)["parameters"]
    assert values["b"]["value"] != tomllib.loads(text)["parameters"]["b"]["value"]
    after = {name: np.array(p) for name, p in desk.js(FIRST_POINTS).items()}
    np.testing.assert_allclose(after["rocker.tip"], moved[-1], atol=1e-6)
    desk.page.keyboard.press("Control+z")
    desk.until(f"studio.editor.text === {text!r}", 20)
