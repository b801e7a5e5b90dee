"""Spatial models in the studio: an RSSR four-bar is drawn, a body is moved by the gizmo."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from studio_desk import Desk, opened, reset
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file
from dalembert.studio.drawing_edits import apply

LOOK = """(() => {
    const { view } = studio.pictures.page.scene, { position } = view.camera;
    const { target } = view.controls;
    target.set(0.2, 0.25, 0.1);
    position.set(1.6, -2.9, 2.2);
    view.controls.update();
    view.aim(view.canvas.clientWidth, view.canvas.clientHeight);
    view.fitted = false;
})()"""
HANDLE = """async ([kind, axis, k]) => {
    const { outline } = await import("./assets/space_gizmo.js"), { space } = studio;
    const handle = space.handles.find((one) => one.kind === kind && one.axis === axis);
    return outline(space.boundPage, space.pose, handle)[k];
}"""
"""Place of a corner of a handle of the gizmo."""
BOXES = """# two boxes
format = 1
gravity = [0.0, 0.0, -9.81]

[parameters]
h = 0.1

[bodies.one]  # first
type = "Box"
size = [0.2, 0.2, 0.2]
density = 500.0
position = ["200 mm", 0.3, "2*h"]  # a formula
rotation = { type = "bryant", x = 0.0, y = 0.1, z = 0.0 }

[bodies.two]
type = "Box"
size = [0.1, 0.1, 0.1]
density = 500.0
position = [-0.2, 0.0, 0.1]
"""


class SpaceDesk(Desk):
    """Page of a studio with a spatial model."""

    def changed(self, act: Any) -> None:
        """Carry out a change and wait for its picture."""
        revision = self.js("studio.file.revision")
        act()
        self.until(f"studio.file.revision > {revision}", 10)
        self.settle(revision + 1)

    def draw(self, key: str, *places: tuple[float, ...]) -> None:
        """Use a tool, chosen by its key; a fourth number holds Shift."""
        self.js("document.activeElement?.blur()")
        self.page.keyboard.press(key)
        for x, y, z, *shift in places[:-1]:
            self._click(shift, x, y, z)
        x, y, z, *shift = places[-1]
        self.changed(lambda: self._click(shift, x, y, z))

    def _click(self, shift: list[float], *place: float) -> None:
        if shift:
            self.page.keyboard.down("Shift")
        self.click(*place)
        if shift:
            self.page.keyboard.up("Shift")

    def handle(self, kind: str, axis: str, corner: int = 1) -> tuple[float, float]:
        """Position of a handle on the screen."""
        return self.place(*self.page.evaluate(HANDLE, [kind, axis, corner]))

    def turn_about_y(self, degrees: str) -> None:
        """Type an angle while the ring is held, which Enter ends before the button is released."""
        self.page.mouse.move(*self.handle("turn", "y", 44))
        self.page.mouse.down()
        for key in degrees:
            self.page.keyboard.press(key)
        self.changed(lambda: self.page.keyboard.press("Enter"))
        self.page.mouse.up()

    def show(self, text: str) -> None:
        """Replace the text and look at it from a fixed place."""
        super().show(text)
        self.js(LOOK)


@contextmanager
def spatial(browser: Any, studio: Studio) -> Iterator[SpaceDesk]:
    """A page with a new spatial model."""
    reset(studio)
    with opened(browser, studio, "0", (1300, 800), SpaceDesk) as visit:
        visit.page.click("text=Open…")
        visit.page.click("text=New spatial model")
        visit.until("document.documentElement.dataset.space === 'true'", 20)
        visit.js(LOOK)
        yield visit


@pytest.fixture(scope="module")
def desk(browser: Any, still_server: Studio) -> Iterator[SpaceDesk]:
    """A page without pictures that compute."""
    with spatial(browser, still_server) as visit:
        yield visit


@pytest.mark.thorough
def test_an_rssr_four_bar_is_drawn(desk: SpaceDesk, tmp_path: Path) -> None:
    """Its motion satisfies the equations of the loop, with the drawn dimensions."""
    texts = [desk.text]
    desk.draw("r", (0, 0, 0), (0.2, 0, 0))
    desk.draw("r", (0.2, 0.6, 0), (0.2, 0.6, 0.4, 1))
    desk.js("studio.space.choose('joint')")
    desk.page.select_option("#joint-axis", "z")
    desk.draw("j", (0, 0, 0), (-0.3, -0.3, 0))
    desk.page.select_option("#joint-axis", "x")
    desk.draw("j", (0.2, 0.6, 0), (-0.3, -0.3, 0))
    desk.draw("l", (0.2, 0, 0), (0.2, 0.6, 0.4))
    desk.draw("m", (0, 0, 0))
    document = desk.document
    assert document["bodies"]["bar2"]["length"] == pytest.approx(0.4)
    assert document["joints"]["link1"]["length"] == pytest.approx(math.hypot(0.6, 0.4))
    assert desk.page.inner_text("#summary") == "1 degree of freedom, 1 driven, 0 free"
    (tmp_path / "drawn.toml").write_text(desk.text)
    motion = da.solve_kinematics(load_model_file(tmp_path / "drawn.toml").model(), 2.0, outputs=9)
    crank, rocker = motion["bar1.end.position"].values, motion["bar2.end.position"].values
    angle = np.pi * motion.time
    circle = 0.2 * np.array([np.cos(angle), np.sin(angle), np.zeros(9)]).T
    assert crank == pytest.approx(circle, abs=1e-8)
    assert np.linalg.norm(crank - rocker, axis=1) == pytest.approx(math.hypot(0.6, 0.4), abs=1e-8)
    assert rocker[:, 0] == pytest.approx(0.2, abs=1e-8)
    assert np.linalg.norm(rocker - [0.2, 0.6, 0], axis=1) == pytest.approx(0.4, abs=1e-8)
    for _ in range(6):
        desk.changed(lambda: desk.page.keyboard.press("Control+z"))
    assert desk.text == texts[0]


def test_the_gizmo_moves_and_rotates_a_body(desk: SpaceDesk) -> None:
    """Other text stays byte for byte, formulas too; each drag is one step of undo."""
    desk.show(BOXES)
    desk.page.keyboard.press("v")
    desk.click(0.2, 0.3, 0.3)
    assert desk.js("studio.space.selected") == {"section": "bodies", "name": "one"}
    x, y = desk.handle("move", "x")

    def drag(dx: float, dy: float) -> None:
        desk.page.mouse.down()
        desk.page.mouse.move(x + dx, y + dy, steps=4)

    (u, v), (a, b) = desk.place(0.2, 0.3, 0.2), desk.place(0.4, 0.3, 0.2)
    desk.page.mouse.move(x, y)
    drag(a - u, b - v)
    shown = "studio.space.poses.page.motion.pose(studio.space.poses.body('one')).p.x"
    assert desk.js(shown) == pytest.approx(0.4, abs=1e-9)  # it moves while it is dragged
    desk.changed(desk.page.mouse.up)
    assert desk.text == BOXES.replace('"200 mm"', '"400.0 mm"')
    desk.turn_about_y("30")
    rotation = desk.document["bodies"]["one"]["rotation"]
    assert [rotation[k] for k in "xyz"] == pytest.approx([0, 0.1 + math.pi / 6, 0], abs=1e-6)
    for _ in range(2):
        desk.changed(lambda: desk.page.keyboard.press("Control+z"))
    assert desk.text == BOXES

    (x, y), (a, b), (u, v) = (
        desk.handle("move", "z"),
        desk.place(0.2, 0.3, 0.4),
        desk.place(0.2, 0.3, 0.2),
    )
    desk.page.mouse.move(x, y)
    drag(a - u, b - v)
    desk.page.mouse.up()
    desk.until("document.getElementById('notice').textContent.includes('2*h')", 10)
    assert desk.text == BOXES
    assert desk.js("studio.space.poses.moved.size") == 0


@pytest.mark.thorough
def test_enter_ends_a_drag_whose_button_stays_pressed(desk: SpaceDesk) -> None:
    """The picture does not wait for the release of the button."""
    desk.show(BOXES.replace("0.3, ", "0.35, "))  # a picture without its module
    desk.show(BOXES)
    desk.page.keyboard.press("v")
    desk.click(0.2, 0.3, 0.3)
    desk.turn_about_y("30")
    desk.changed(lambda: desk.page.keyboard.press("Control+z"))
    assert desk.text == BOXES


@pytest.mark.thorough
def test_the_tree_selects_hides_and_edits(desk: SpaceDesk) -> None:
    desk.show(BOXES)
    desk.page.click("#tab-model")
    desk.page.click("#model .name[data-name=two]")
    assert desk.js("studio.space.selected.name") == "two"
    desk.page.click('[aria-label="Show only two"]', force=True)
    visible = "[...studio.pictures.page.scene.painter.groups].map(([b, g]) => [b.name, g.visible])"
    desk.frames(4)
    assert {tuple(row) for row in desk.js(visible)} >= {("one", False), ("two", True)}
    desk.page.click("text=Show all")
    desk.frames(4)
    assert {tuple(row) for row in desk.js(visible)} >= {("one", True), ("two", True)}
    field = desk.page.get_by_label("position y")
    field.fill("0.25")
    desk.changed(lambda: field.press("Enter"))
    assert desk.text == BOXES.replace("[-0.2, 0.0, 0.1]", "[-0.2, 0.25, 0.1]")
    desk.page.click("#tab-text")


SEQUENCES = ("xyz", "zyx", "yzx", "zxz", "xyx", "yzy")
ANGLES = """async ([q, sequence]) => {
    const { euler } = await import("./assets/space_math.js");
    return euler(q, sequence);
}"""


@pytest.mark.few(1)
@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_of_a_rotation(desk: SpaceDesk, sequence: str) -> None:
    """Those of SciPy, for rotations about body axes in any order."""
    for rotation in Rotation.random(5, rng=np.random.default_rng(4)):
        x, y, z, w = rotation.as_quat()
        angles = desk.page.evaluate(ANGLES, [[w, x, y, z], sequence])
        assert angles == pytest.approx(rotation.as_euler(sequence.upper()), abs=1e-9)


def at_start(model: Any, body: str) -> list[float]:
    """Position and Euler parameters of a body after assembly."""
    pose = da.solve_assembly(model).pose(body)
    return [pose[key] for key in ("x", "y", "z", "e0", "e1", "e2", "e3")]


EQUATIONS = {
    "Revolute": 5,
    "Prismatic": 5,
    "Cylindrical": 4,
    "Spherical": 3,
    "Universal": 4,
    "Screw": 5,
    "Weld": 6,
    "Planar": 3,
}
"""Kind of a joint → its number of equations (docs/spatial.md)."""
JOINT = """async (kind) => {
    const { joint } = await import("./assets/space_shapes.js"), p = [-0.15, 0.02, 0.1];
    const place = { p, names: [], body: "two", joint: null, normal: null, how: "" };
    const ends = [place, { ...place, body: "one" }];
    return joint(ends, studio.space.poses, kind, [0, 0.6, 0.8]).operations;
}"""


def test_joints_of_every_kind(desk: SpaceDesk, tmp_path: Path) -> None:
    """Where they are drawn, they hold at the drawn position, and leave the free motion."""
    desk.show(BOXES)
    kinds = desk.js("[...document.querySelectorAll('#joint-kind option')].map((o) => o.value)")
    assert set(kinds) == set(EQUATIONS)
    for kind, equations in EQUATIONS.items():
        text = apply(BOXES, desk.page.evaluate(JOINT, kind))
        (tmp_path / f"{kind}.toml").write_text(text)
        model = load_model_file(tmp_path / f"{kind}.toml").model()
        assert model.diagnosis.degrees_of_freedom == 12 - equations, kind
        assert at_start(model, "one")[:3] == pytest.approx((0.2, 0.3, 0.2), abs=1e-6), kind
        assert at_start(model, "two")[:3] == pytest.approx((-0.2, 0.0, 0.1), abs=1e-6), kind


FORMS = (
    'rotation = { type = "axis_angle", axis = [0.0, 2.0, 0.0], angle = "5.729577951308232 deg" }',
    'rotation = { type = "euler", sequence = "zxz", angles = [0.1, 0.2, 0.3] }',
    'rotation = { type = "from_matrix", rows = [[0, 0, 1], [1, 0, 0], [0, 1, 0]] }',
    "",
)
"""Orientations of a file."""
ROTATED = """async ([document, after]) => {
    const { moved, poseOf } = await import("./assets/space_targets.js"), { poses } = studio.space;
    const choice = { section: "bodies", name: "one" }, before = poseOf(poses, document, choice);
    return moved(poses, document, choice, before, { p: before.p, q: after });
}"""


@pytest.mark.few(2)
@pytest.mark.parametrize("form", FORMS)
def test_a_rotation_is_written_in_the_form_of_the_file(
    desk: SpaceDesk, form: str, tmp_path: Path
) -> None:
    desk.show(BOXES)
    text = BOXES.replace('rotation = { type = "bryant", x = 0.0, y = 0.1, z = 0.0 }', form)
    rotation = Rotation.from_rotvec([0.4, -0.7, 0.2])
    x, y, z, w = rotation.as_quat()
    changed = apply(text, desk.page.evaluate(ROTATED, [tomllib.loads(text), [w, x, y, z]]))
    (tmp_path / "rotated.toml").write_text(changed)
    model = load_model_file(tmp_path / "rotated.toml").model()
    e0, e1, e2, e3 = at_start(model, "one")[3:]
    assert (Rotation.from_quat([e1, e2, e3, e0]).inv() * rotation).magnitude() < 1e-8
    unchanged = [line for line in text.splitlines() if not line.startswith("rotation")]
    assert [line for line in changed.splitlines() if not line.startswith("rotation")] == unchanged
    if form:
        kind = form.split('"')[1]
        assert f'"{kind}"' in changed


MOVED = """async ([choice, shift]) => {
    const { moved, poseOf } = await import("./assets/space_targets.js"), { space } = studio;
    const before = poseOf(space.poses, space.document, choice);
    const p = before.p.map((v, k) => v + shift[k]);
    return moved(space.poses, space.document, choice, before, { p, q: before.q });
}"""


@pytest.mark.thorough
def test_a_joint_moves_in_both_bodies(desk: SpaceDesk, tmp_path: Path) -> None:
    """The joint of two bodies is elsewhere, and the bodies stay."""
    desk.show(BOXES)
    text = apply(BOXES, desk.page.evaluate(JOINT, "Revolute"))
    desk.show(text)
    choice = {"section": "joints", "name": "A"}
    operations = desk.page.evaluate(MOVED, [choice, [0.05, 0.0, -0.1]])
    moved = apply(text, operations)
    assert moved != text
    (tmp_path / "moved.toml").write_text(moved)
    model = load_model_file(tmp_path / "moved.toml").model()
    assert at_start(model, "one")[:3] == pytest.approx((0.2, 0.3, 0.2), abs=1e-6)
    assert at_start(model, "two")[:3] == pytest.approx((-0.2, 0.0, 0.1), abs=1e-6)
    places = [
        next(end["at"] for end in data["joints"]["A"]["connect"] if end["body"] == "two")
        for data in map(tomllib.loads, (text, moved))
    ]
    assert np.subtract(places[1], places[0]) == pytest.approx([0.05, 0.0, -0.1], abs=1e-6)
