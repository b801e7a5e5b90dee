"""The page of a mechanism in space: what it draws, and how one looks at it."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from browser import Visit, visit
from scipy.spatial.transform import Rotation, Slerp

import dalembert as da
from dalembert import planar, spatial
from dalembert.report.page import render_page, write_page

TILT = 0.6
SMALL = (1000, 560)
"""Size of a window in which software draws fast."""


@functools.cache
def heavy_top() -> da.Motion:
    """A disc on a stick whose foot stays where it is."""
    system = da.System("heavy top", gravity=(0, 0, -9.81))
    spin = 60 * np.array([0, -np.sin(TILT), np.cos(TILT)])
    rotor = spatial.Body(
        "rotor",
        mass=15.0,
        inertia=(0.23, 0.23, 0.46),
        center_of_mass=(0, 0, 1),
        points={"tip": (0, 0, 0), "head": (0, 0, 1.2)},
        rotation=da.rotation.axis_angle((1, 0, 0), TILT),
        angular_velocity=tuple(spin),
    )
    system.add(rotor)
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), rotor.point("tip")))
    return da.solve_dynamics(system.build(), duration=1.0, step=0.01)


@functools.cache
def joints() -> da.Motion:
    """A solid of every shape on a joint of every kind, with a spring, a damper and loads."""
    system, up = da.System("joints", gravity=(0, 0, -0.1)), (0, 0, 0.2)
    ground = system.ground

    def solid(kind: Any, name: str, x: float, **arguments: Any) -> Any:
        return system.add(kind(name, density=800, position=(x, 0, 0), **arguments))

    box = solid(spatial.Box, "box", 0.0, size=(0.1, 0.1, 0.3), angular_velocity=(0, 0, 1))
    system.add(spatial.Cylindrical("C", ground.frame(up), box.frame(up)))
    slab = solid(spatial.Box, "slab", 0.5, size=(0.3, 0.1, 0.1), velocity=(0.3, 0, 0))
    along = {"axis": (1, 0, 0), "x": (0, 0, 1)}
    rail = ground.frame((0.5, 0, 0.2), **along)
    system.add(spatial.Prismatic("P", rail, slab.frame(up, **along)))
    pill = solid(spatial.Capsule, "pill", 1.0, radius=0.05, length=0.3, angular_velocity=(2, 1, 0))
    arm = ground.frame((1, 0, 0.2), axis=(1, 0, 0))
    system.add(spatial.Universal("U", arm, pill.frame(up, axis=(0, 1, 0))))
    drum = solid(spatial.Cylinder, "drum", 1.5, radius=0.06, length=0.3, angular_velocity=(0, 0, 5))
    system.add(spatial.Screw("S", ground.frame((1.5, 0, 0.2)), drum.frame(up), pitch=0.05))
    ball = solid(spatial.Sphere, "ball", 2.0, radius=0.1, angular_velocity=(0, 0, 4))
    table = ground.frame((2, 0, -0.1))
    system.add(spatial.Planar("T", table, ball.frame((0, 0, -0.1))))
    wheel = system.add(spatial.Body("wheel", mass=1, inertia=(0.005, 0.01, 0.005)))
    system.add(spatial.RollingDisc("D", wheel, ground.frame((0, 0, -0.1)), radius=0.1))
    bob = system.add(spatial.Particle("bob", mass=1.0, position=(1, -0.6, 0)))
    hook = ground.point(1, -0.6, 0.5)
    system.add(spatial.Spring("k", hook, bob.center, stiffness=100, damping=1, free_length=0.4))
    system.add(spatial.Force("wind", bob.center, (3, 0, 0)))
    system.add(spatial.Torque("spin", ball, (0, 0, 0.1)))
    lid = system.add(spatial.Bar("lid", mass=0.1, length=0.2, radius=0.02, position=(2, 0, 0.1)))
    system.add(spatial.Weld("W", ball.frame(up), lid.frame((0, 0, 0.1))))
    return da.solve_dynamics(system.build(), duration=0.2, step=0.01)


@functools.cache
def hinges() -> da.Motion:
    """Three bars on hinges about two axes, the last on a spring."""
    system = da.System("hinges", gravity=(0, 0, -9.81))
    last, axes = system.ground.frame((0, 0, 0), axis=(0, 1, 0)), [(0, 1, 0), (0, 0, 1), (0, 1, 0)]
    for k, axis in enumerate(axes):
        shape = {"mass": 2.0, "inertia": (0.01, 0.08, 0.08), "position": (0.7 * k + 0.35, 0, 0)}
        bar = system.add(spatial.Body(f"bar{k}", points={"end": (0.35, 0, 0)}, **shape))
        system.add(spatial.Revolute("ABC"[k], last, bar.frame((-0.35, 0, 0), axis=axis)))
        last = bar.frame((0.35, 0, 0), axis=axes[(k + 1) % 3])
    post = system.ground.point(1.4, 0.6, -0.2)
    tie = spatial.Spring("tie", post, bar.point("end"), stiffness=60, damping=1, free_length=0.5)
    system.add(tie)
    return da.solve_dynamics(system.build(), duration=0.6, step=0.01)


@pytest.fixture
def show(show: Any) -> Any:
    return functools.partial(show, viewport=SMALL)


def matrices(page: Visit, time: float) -> dict[str, np.ndarray]:
    """What the page draws at a time: placement of each body by its name."""
    page.js(f"dalembert.player.seek({time!r})")
    page.frames()
    read = """[...dalembert.scene.painter.groups].filter(([body]) => !body.fixed)
        .map(([body, group]) => [body.name, (group.updateMatrix(), group.matrix.elements)])"""
    return {name: np.reshape(m, (4, 4)).T for name, m in page.js(read)}


def test_page_is_one_file_with_the_library_inside() -> None:
    text = render_page(heavy_top().page())
    assert "three.js authors, MIT licence" in text
    assert len(text) < 1.5e6
    assert len(render_page({"format": 1, "title": "plane", "time": [], "scene": {}})) < 2e5


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("make", "viewport", "scheme"),
    [
        (heavy_top, (1440, 900), "light"),
        (hinges, (390, 844), "dark"),
        (joints, SMALL, "light"),
    ],
)
def test_draws(show: Any, make: Any, viewport: tuple[int, int], scheme: str) -> None:
    page = show(make(), viewport=viewport, scheme=scheme)
    assert page.ink("#scene") > 200
    assert page.ink("#overlay") > 20
    assert page.ink(".plot .base") > 5
    assert page.js("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.few(1)
@pytest.mark.parametrize("make", [heavy_top, hinges])
def test_bodies_stand_where_the_data_say(show: Any, make: Any) -> None:
    motion = make()
    page = show(motion)
    for k in (0, 17, motion.time.size - 1):
        for name, drawn in matrices(page, float(motion.time[k])).items():
            at = motion.data.isel(time=k).sel(body=name)
            turn = Rotation.from_quat(at["euler_parameters"].values, scalar_first=True)
            assert np.allclose(drawn[:3, 3], at["position"], atol=1e-6)
            assert np.allclose(drawn[:3, :3], turn.as_matrix(), atol=1e-6)


@pytest.mark.thorough
def test_between_frames_bodies_turn_about_one_axis(show: Any) -> None:
    motion = heavy_top()
    (drawn,) = matrices(show(motion), 0.2 + 0.01 * 0.3).values()
    parameters = motion.data["euler_parameters"].values[20:22, 0]
    turn = Slerp([0, 1], Rotation.from_quat(parameters, scalar_first=True))(0.3)
    assert np.allclose(drawn[:3, :3], turn.as_matrix(), atol=1e-6)


def test_turns_zooms_pans_and_fits(show: Any) -> None:
    page = show(heavy_top())
    state = """(({ camera: { position: eye }, controls: { target } }) =>
        [eye.toArray(), target.toArray(), eye.distanceTo(target)])(dalembert.scene.view)"""
    home, (x, y), mouse = page.js(state), (350, 250), page.page.mouse
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + 80, y + 30, steps=3)
    mouse.up()
    turned = page.js(state)
    assert np.allclose(turned[1], home[1]) and not np.allclose(turned[0], home[0])
    mouse.wheel(0, -400)
    page.frames()
    assert page.js(state)[2] < 0.95 * turned[2]
    before = page.js(state)
    mouse.down(button="right")
    mouse.move(x, y, steps=3)
    mouse.up(button="right")
    assert not np.allclose(page.js(state)[1], before[1])
    page.page.keyboard.press("4")
    assert np.allclose(page.js(state)[0], home[0])


@pytest.mark.thorough
def test_looks_along_the_axes(show: Any) -> None:
    page = show(hinges())
    for key, axis in {"1": (1, 0, 0), "2": (0, -1, 0), "3": (0, 0, 1)}.items():
        page.page.keyboard.press(key)
        way = page.js("""(({ camera, controls }) => camera.position.clone()
            .sub(controls.target).normalize().toArray())(dalembert.scene.view)""")
        assert np.allclose(way, axis, atol=1e-4)
        title = page.page.get_attribute(f"#look-{'xyz'[int(key) - 1]}", "title")
        assert title.endswith(f"({key})")


@pytest.mark.thorough
def test_toggles_change_the_picture_and_back(show: Any) -> None:
    page = show(hinges())
    page.js("dalembert.player.seek(0.5)")
    page.frames(3)
    start = [page.picture(layer) for layer in ("#scene", "#overlay")]
    for control in ("#reactions", "#grid", "#clear", "#section", ".trace >> nth=2"):
        for changed in (True, False):
            page.page.click(control)
            page.frames(3)
            now = [page.picture(layer) for layer in ("#scene", "#overlay")]
            assert (now != start) is changed, control


@pytest.mark.thorough
def test_arrows_are_as_long_as_asked_and_point_along_the_reaction(show: Any) -> None:
    motion = heavy_top()
    page = show(motion)
    page.page.click("#reactions")
    read = "dalembert.scene.arrows.map(({ way }) => way)"
    page.js("dalembert.player.seek(0.5)")
    page.frames()
    way = page.js(read)[0]
    seen = page.js(f"dalembert.scene.view.direction({motion['O.force'].values[50].tolist()})")[:2]
    length = np.linalg.norm(way)
    assert np.allclose(way / length, seen / np.linalg.norm(seen), atol=1e-5)
    page.js("""(() => { const size = document.getElementById("arrows-force");
        size.value = 0.5; size.dispatchEvent(new Event("input")); })()""")
    page.frames()
    assert np.linalg.norm(page.js(read)[0]) == pytest.approx(length * 10**0.5, rel=1e-3)


@pytest.mark.thorough
def test_section_leaves_out_one_side(show: Any) -> None:
    page = show(hinges())
    page.page.click("#section")
    page.page.select_option("#section-axis", "z")
    numbers = "({ normal, constant }) => [...normal.toArray(), constant]"
    plane = f"({numbers})(dalembert.scene.painter.materials.cut)"
    *normal, constant = page.js(plane)
    assert normal == [0, 0, -1]
    page.page.click("#section-flip")
    assert page.js(plane) == [0, 0, 1, pytest.approx(-constant)]


@pytest.mark.thorough
def test_tooltip_names_what_is_under_the_pointer(show: Any) -> None:
    page = show(hinges())
    box = page.page.locator("#scene").bounding_box()
    for joint, text in ((0, "force"), (2, "revolute")):
        page.js("dalembert.player.seek(0)")
        at = page.js(f"""(({{ motion, scene }}) =>
            scene.screen(motion.placeOf(motion.joints[{joint}])))(dalembert)""")
        page.page.mouse.move(box["x"] + at[0], box["y"] + at[1])
        page.frames(3)
        tip = page.page.inner_text("#tip")
        assert tip.startswith("ABC"[joint]) and text in tip
    page.page.mouse.move(box["x"] + 15, box["y"] + 90)
    page.frames(3)
    assert not page.page.is_visible("#tip")


@pytest.mark.thorough
def test_without_webgl_it_is_painted(show: Any) -> None:
    refuse = """const get = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
            return kind.startsWith("webgl") ? null : get.call(this, kind, ...more); };"""
    page = show(hinges(), before=refuse)
    assert page.ink("#scene") > 100
    drawn = page.picture("#scene")
    page.js("dalembert.player.seek(0.4)")
    page.frames(3)
    assert page.picture("#scene") != drawn


@pytest.mark.thorough
def test_paper_is_light_and_sharp(show: Any) -> None:
    page = show(heavy_top(), scheme="dark")
    page.js("window.dispatchEvent(new Event('beforeprint'))")
    assert page.js("document.documentElement.dataset.theme") == "light"
    canvas = "(({ width, clientWidth }) => width / clientWidth)(document.getElementById('scene'))"
    assert page.js(canvas) == pytest.approx(3, rel=0.01)
    assert page.ink("#scene") > 200
    page.js("window.dispatchEvent(new Event('afterprint'))")
    assert page.js("document.documentElement.dataset.theme") == "dark"


def test_the_force_of_a_rolling_contact_stands_where_it_touches() -> None:
    motion = joints()
    scene = motion.page()["scene"]
    (contact,) = (j for j in scene["joints"] if j["name"] == "D")
    place = np.stack([contact[f"at_{axis}"] for axis in "xyz"], axis=1)
    below = motion["wheel.position"].values - [0, 0, 0.1]
    assert np.allclose(place, below, atol=1e-6)
    assert np.allclose(contact["force_z"], motion["D.force.z"].values)


@pytest.mark.thorough
def test_a_rod_leads_to_a_joint_beside_a_solid(show: Any) -> None:
    system = da.System("hammer", gravity=(0, 0, -9.81))
    head = spatial.Box("head", size=(0.1, 0.1, 0.1), mass=1, position=(0, 0, -0.5))
    system.add(head)
    hook = head.frame((0, 0, 0.5), axis=(0, 1, 0))
    system.add(spatial.Revolute("O", system.ground.frame((0, 0, 0), axis=(0, 1, 0)), hook))
    page = show(da.solve_dynamics(system.build(), duration=0.1, step=0.05))
    tops = page.js("""[...dalembert.scene.painter.groups].find(([body]) => !body.fixed)[1].children
        .filter((part) => part.isMesh).map((part) => (part.geometry.computeBoundingBox(),
            part.geometry.boundingBox.max.z + part.position.z))""")
    assert max(tops) >= 0.5 - 1e-6


@pytest.mark.thorough
def test_bodies_of_the_plane_stand_in_space(show: Any) -> None:
    system = da.System("mixed", gravity=(0, -9.81, 0))
    arm = planar.Bar("arm", length=0.4, mass=1, angle=0.5, angular_velocity=3)
    system.add(arm)
    system.add(planar.Revolute("O", system.ground.point(0, 0), arm.start))
    swing = spatial.Body("swing", mass=1, inertia=(0.01, 0.01, 0.01), position=(0.4, 0, 0))
    system.add(swing)
    system.add(spatial.Spherical("A", arm.point(0.2, 0, 0), swing.point(0, 0.2, 0)))
    motion = da.solve_dynamics(system.build(), duration=0.1, step=0.01)
    assert motion.data["point_position"].shape[2] == motion.data["reaction_moment"].shape[2] == 3
    page = show(motion)
    angle = float(motion["arm.angle"][-1])
    drawn = matrices(page, 0.1)["arm"]
    assert np.allclose(drawn[:3, 0], [np.cos(angle), np.sin(angle), 0], atol=1e-6)
    assert page.js("dalembert.scene.view.up.toArray()") == [0, 1, 0]


@pytest.mark.thorough
def test_what_cannot_be_assembled_is_drawn_with_its_gap(browser: Any, tmp_path: Path) -> None:
    system = da.System("too short")
    a = system.add(spatial.Bar("a", length=0.3, radius=0.01, mass=1))
    b = system.add(spatial.Bar("b", length=0.3, radius=0.01, mass=1, position=(0.6, 0, 0)))
    hinge = a.frame((-0.15, 0, 0))
    system.add(spatial.Revolute("O", system.ground.frame((0, 0, 0)), hinge))
    system.add(spatial.Spherical("A", a.end, b.start))
    system.add(spatial.Spherical("B", b.end, system.ground.point(0.8, 0, 0.3)))
    with pytest.raises(da.AssemblyError) as refused:
        system.build()
    page = da.assembly_report(refused.value, tmp_path / "gap.html")
    with visit(browser, page, viewport=SMALL) as page_visit:
        assert page_visit.js("dalembert.motion.ghosts.length") == 2
        (gap,) = page_visit.js("dalembert.motion.gaps")
        assert np.linalg.norm(np.subtract(gap["from"], gap["to"])) > 0.2
        assert "m" in gap["text"] and page_visit.ink("#scene") > 100
        assert page_visit.console == [] and page_visit.requests == []


@pytest.mark.few(1)
@pytest.mark.parametrize("frames", [0, 1, 2])
def test_nearly_empty_payloads(browser: Any, tmp_path: Path, frames: int) -> None:
    scene = [{}, {"bodies": []}, {"bodies": [{"name": "only"}]}][frames]
    time = [0.5 * k for k in range(frames)]
    payload = {"kind": "spatial", "title": "nearly nothing", "time": time, "scene": scene}
    page = write_page(payload, tmp_path / "empty.html")
    with visit(browser, page, viewport=SMALL) as page_visit:
        assert page_visit.page.is_visible("#player") == (frames == 2)
        assert page_visit.console == [] and page_visit.requests == []


def test_matplotlib_draws_every_solid_where_it_is() -> None:
    motion = joints()
    axes = motion.draw(0.1)
    lines = [np.array(line.get_data_3d()) for line in axes.lines]
    spots = np.hstack(lines)
    for name in ("box", "pill", "drum", "ball", "bob"):
        place = motion[f"{name}.position"].sel(time=0.1).values
        around = np.linalg.norm(spots - place[:, None], axis=0)
        assert np.nanmin(around) < 0.2, name
    assert min(np.ptp(getattr(axes, f"get_{a}lim")()) for a in "xyz") > 0
    plt.close("all")


def test_a_film_of_space_moves() -> None:
    film = hinges().animate(fps=5)
    first = np.array(film._func(0)[0].get_data_3d())
    assert not np.allclose(first, np.array(film._func(1)[0].get_data_3d()))
    film._draw_was_started = True  # it is not meant to be rendered


@pytest.mark.thorough
def test_a_parallel_projection_has_one_scale(show: Any) -> None:
    """Pixels of the drawing are those of the camera, in both projections."""
    page = show(heavy_top(), viewport=SMALL)
    seen = """[[0, 0, 0], [0, -0.5, 0.8], [0.3, 0.4, 0.1]].map((p) => {
        const { view, canvas } = dalembert.scene, { camera } = view;
        const { x, y } = camera.position.clone().set(...p).project(camera);
        const [u, v] = view.screen(p), [w, h] = [canvas.clientWidth, canvas.clientHeight];
        return [u - ((1 + x) * w) / 2, v - ((1 - y) * h) / 2, view.scaleAt(p)];
    })"""
    perspective = np.array(page.js(seen))
    page.page.click("#parallel")
    page.frames()
    parallel = np.array(page.js(seen))
    assert abs(perspective[:, :2]).max() < 1e-3
    assert abs(parallel[:, :2]).max() < 0.05
    assert np.ptp(perspective[:, 2]) > 0.05 * perspective[0, 2]
    assert np.ptp(parallel[:, 2]) < 0.005 * parallel[0, 2]
    assert parallel[:, 2].mean() == pytest.approx(perspective[:, 2].mean(), rel=0.2)
    page.page.click("#parallel")
    page.frames()
    assert np.array(page.js(seen)) == pytest.approx(perspective, abs=1e-3)
