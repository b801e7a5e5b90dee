"""A drag in a spatial mechanism is computed by the page: its loop is closed at every place."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from studio_runs import Studio
from test_studio_space import BOXES, SpaceDesk, desk, spatial  # noqa: F401

from dalembert.studio.new_models import UNTITLED_SPATIAL

EXAMPLES = Path(__file__).parents[1] / "examples"
TIP = '{ section: "bodies", name: "rocker", part: "points", key: "tip" }'
POINTS = """(() => {
    const { motion } = studio.pictures.page;
    const place = ({ name, body, point }) => [name, motion.at(body, point)];
    return Object.fromEntries(motion.points.map(place));
})()"""
FIRST_POINTS = POINTS.replace("motion.at(body, point)", "motion.at(body, point, { i: 0, f: 0 })")
FOLLOWS = f"""(() => {{
    const reach = ([, y, z]) => Math.hypot(y - 0.5, z + 0.1);
    const tip = reach({FIRST_POINTS}["rocker.tip"]), held = reach(studio.space.held.after.p);
    return Math.abs(tip - held) < 1e-6 * held;
}})()"""
"""Whether the rocker, which turns about x, is as long as the pointer is far from its axis."""
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


@pytest.mark.thorough
def test_a_drag_keeps_the_loop_closed(browser: Any, studio_server: Studio) -> None:
    with spatial(browser, studio_server) as live_desk:
        drag_the_loop(live_desk)


def drag_the_loop(desk: SpaceDesk) -> None:  # noqa: F811
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
        # The motion of the place before, computed in a pause, may come before the result of this.
        desk.until(f"window.results > {number} && {FOLLOWS}", 20)
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


@pytest.mark.thorough
@pytest.mark.usefixtures("desk")
def test_a_displacement_is_typed_as_one_writes_it(desk: SpaceDesk) -> None:  # noqa: F811
    """A number may begin with its point, have a comma, and be corrected."""
    desk.show(BOXES)
    desk.js("studio.space.choose('select')")
    for keys, place in {".05": 250, "-.05": 150, "0,15": 350, "7\b.1 ": 300}.items():
        desk.js('studio.space.select({ section: "bodies", name: "one" })')
        desk.page.mouse.move(*desk.handle("move", "x"))
        desk.page.mouse.down()
        for key in keys:
            desk.page.keyboard.press({"\b": "Backspace", " ": "Space"}.get(key, key))
        desk.changed(lambda: desk.page.keyboard.press("Enter"))
        desk.page.mouse.up()
        assert desk.text == BOXES.replace('"200 mm"', f'"{place}.0 mm"'), keys
        desk.changed(lambda: desk.page.keyboard.press("Control+z"))


CORNERS = """async (kind) => {
    const { outline, handleAt } = await import("./assets/space_gizmo.js"), { space } = studio;
    const { boundPage: page, pose, handles } = space;
    const handle = handles.find((one) => one.kind === kind && one.axis === "z");
    const corners = outline(page, pose, handle);
    const free = (p) => handleAt(page, pose, handles, page.scene.view.screen(p)) === handle;
    const k = corners.findIndex((p, i) => i % 12 === 4 && free(p));  // not where an arrow is
    return [corners, handle.way, k];
}"""
"""Corners of a handle of the axis z, this axis, and a corner at which it is taken."""


@pytest.mark.thorough
@pytest.mark.parametrize("angles", [(math.pi, 0.0, 0.0), (0.4, -0.3, 0.2)])
@pytest.mark.usefixtures("desk")
def test_a_gizmo_with_the_axes_of_the_body(
    desk: SpaceDesk,  # noqa: F811
    angles: tuple[float, float, float],
) -> None:
    """Its rings turn the body with the pointer, and its planes are those of its arrows."""
    x, y, z = angles
    before = Rotation.from_euler("XYZ", angles)
    desk.show(BOXES.replace("x = 0.0, y = 0.1, z = 0.0", f"x = {x}, y = {y}, z = {z}"))
    desk.js("studio.space.choose('select')")
    desk.js('studio.space.select({ section: "bodies", name: "one" })')
    try:
        desk.page.keyboard.press("g")
        corners, axis, k = map(np.array, desk.page.evaluate(CORNERS, "turn"))
        start = np.array([0.2, 0.3, 0.2])
        desk.page.mouse.move(*desk.place(*corners[k]))
        desk.page.mouse.down()
        desk.page.mouse.move(*desk.place(*corners[k + 4]), steps=4)
        desk.changed(desk.page.mouse.up)
        rotation = desk.document["bodies"]["one"]["rotation"]
        after = Rotation.from_euler("XYZ", [rotation[key] for key in "xyz"])
        turn = (after * before.inv()).as_rotvec()
        way = np.cross(corners[k] - start, corners[k + 4] - start)
        assert turn @ way > 0
        assert np.linalg.norm(turn) == pytest.approx(math.pi / 6, abs=1e-6)
        assert abs(turn @ axis) == pytest.approx(math.pi / 6, abs=1e-6)
        desk.changed(lambda: desk.page.keyboard.press("Control+z"))
        corners = np.array(desk.page.evaluate(CORNERS, "plane")[0])
        sides = before.inv().apply(corners[[1, 3]] - corners[0])
        assert sides / np.linalg.norm(sides, axis=1)[:, None] == pytest.approx(
            np.eye(3)[:2], abs=1e-6
        )
    finally:
        desk.page.keyboard.press("g")


@pytest.mark.thorough
@pytest.mark.usefixtures("desk")
def test_what_is_drawn_at_typed_places_is_exact(desk: SpaceDesk) -> None:  # noqa: F811
    """Places at named points and above places have all digits of these, not those of the screen."""
    desk.show(BOXES.split("[parameters]")[0] + "[bodies]\n")

    def typed(tool: str, *places: str) -> None:
        desk.js(f"studio.space.choose('{tool}')")
        for k, place in enumerate(places):
            for key in place:
                desk.page.keyboard.press("Space" if key == " " else key)
            if k + 1 < len(places):
                desk.page.keyboard.press("Enter")
        desk.changed(lambda: desk.page.keyboard.press("Enter"))

    start, end = [0.0137, 0.0291, 0.1234567891], [0.3334567891, 0.1333, 0.1234567891]
    typed("bar", *(", ".join(map(str, place)) for place in (start, end)))
    desk.js("studio.space.choose('joint')")
    desk.page.select_option("#joint-axis", "z")
    desk.draw("j", tuple(end), (-0.3, -0.3, 0))
    ground, bar = desk.document["joints"]["A"]["connect"]
    assert ground["at"] == pytest.approx(end, abs=1e-9)  # numbers of a page have ten digits
    half = math.dist(start, end) / 2
    assert bar["at"] == pytest.approx([half, 0, 0], abs=1e-9)
    desk.js("studio.space.choose('bar')")
    for key in ", ".join(map(str, start)):
        desk.page.keyboard.press("Space" if key == " " else key)
    desk.page.keyboard.press("Enter")
    desk.page.keyboard.down("Shift")
    desk.changed(lambda: desk.click(*start[:2], 0.3))
    desk.page.keyboard.up("Shift")
    position = desk.document["bodies"]["bar2"]["position"]
    assert position[:2] == start[:2]
    length = desk.document["bodies"]["bar2"]["length"]
    assert position[2] == pytest.approx(start[2] + length / 2, abs=1e-12)


STRUCK = """(place) => {
    const { painter, view } = studio.pictures.page.scene;
    painter.setSection("y", (0.02 - view.centre.y) / view.radius, true);
    const hit = painter.struck(view.screen(place)), { matrixWorld, userData } = hit.object;
    painter.setSection(null, 0, true);
    const normal = hit.face.normal.clone().transformDirection(matrixWorld);
    return [userData.item.name, hit.point.toArray(), normal.toArray()];
}"""
"""Body, place and normal at a pixel, while what is before y = 0.02 is hidden."""


@pytest.mark.thorough
@pytest.mark.usefixtures("desk")
def test_a_body_is_taken_at_its_section(desk: SpaceDesk) -> None:  # noqa: F811
    """Where a section cuts a body, it seems filled: the pointer there is on the body."""
    desk.show(BOXES.replace("[-0.2, 0.0, 0.1]", "[-0.2, 0.02, 0.1]"))
    name, point, normal = desk.page.evaluate(STRUCK, [-0.2, 0.02, 0.1])
    assert name == "two"
    assert point == pytest.approx([-0.2, 0.02, 0.1], abs=1e-6)
    assert normal == pytest.approx([0, -1, 0], abs=1e-6)


FRAME = """
[ground.frames]
socket = { at = [-0.1, -0.1, 0.0], axis = [0.0, 0.0, 1.0] }
"""


@pytest.mark.thorough
@pytest.mark.usefixtures("desk")
def test_a_frame_turns_about_its_own_axis(desk: SpaceDesk) -> None:  # noqa: F811
    """Its direction x is written, which the axis alone leaves open."""
    desk.show(BOXES + FRAME)
    desk.js("studio.space.choose('select')")
    choice = '{ section: "ground", name: "ground", part: "frames", key: "socket" }'
    desk.js(f"studio.space.select({choice})")
    desk.page.mouse.move(*desk.place(*map(float, desk.page.evaluate(CORNERS, "turn")[0][4])))
    desk.page.mouse.down()
    for key in "30":
        desk.page.keyboard.press(key)
    desk.changed(lambda: desk.page.keyboard.press("Enter"))
    desk.page.mouse.up()
    frame = desk.document["ground"]["frames"]["socket"]
    assert frame["axis"] == [0.0, 0.0, 1.0]
    assert frame["x"] == pytest.approx([math.cos(math.pi / 6), 0.5, 0.0], abs=1e-9)
    assert not desk.errors_shown()
    desk.changed(lambda: desk.page.keyboard.press("Control+z"))
    assert desk.text == BOXES + FRAME


@pytest.mark.thorough
@pytest.mark.usefixtures("desk")
def test_a_rotation_of_a_joint_about_its_own_axis_is_refused(desk: SpaceDesk) -> None:  # noqa: F811
    """The file has only the direction of the axis, which stays."""
    text = (
        UNTITLED_SPATIAL
        + '[bodies]\nb = { type = "Box", size = [0.2, 0.1, 0.1], density = 1000 }\n'
        + '[joints]\nj = { type = "Revolute", connect = ["ground", '
        + '{ body = "b", at = [0, 0, 0], axis = [0, 0, 1] }] }\n'
    )
    desk.show(text)
    desk.js("studio.space.select({ section: 'joints', name: 'j' })")
    desk.page.mouse.move(*desk.handle("turn", "z", 44))
    desk.page.mouse.down()
    desk.page.keyboard.press("9")
    desk.page.keyboard.press("Enter")
    desk.page.mouse.up()
    notice = desk.js("document.getElementById('notice').textContent")
    assert "j: this rotation changes no number of the file" in notice and "own axis" in notice
    assert desk.text == text
