"""Insight and design tasks of the studio in a browser."""

# ruff: noqa: E501

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studio_desk import Desk, opened, reset
from studio_runs import Studio

import dalembert as da

EXAMPLES = Path(__file__).parents[1] / "examples"
EDGES = {
    "crank": (0.0, 0.0, 0.1, 0.3),
    "coupler": (0.1, 0.3, 0.8, 0.5),
    "rocker": (0.9, 0, 0.8, 0.5),
}


def four_bar_text() -> str:
    """A driven crank and rocker with parameters, and tasks for it."""
    bodies, joints = [], []
    for name, (x0, y0, x1, y1) in EDGES.items():
        length, angle = math.hypot(x1 - x0, y1 - y0), math.atan2(y1 - y0, x1 - x0)
        value = '"c"' if name == "coupler" else repr(length)
        bodies.append(
            f'{name} = {{ type = "Bar", length = {value}, mass = 1.0, angle = {angle!r} }}'
        )
    ends = (
        ("O", '{ body = "ground", at = [0.0, 0.0] }, "crank.start"'),
        ("A", '"crank.end", "coupler.start"'),
        ("B", '"coupler.end", "rocker.end"'),
        ("C", '{ body = "ground", at = [0.9, 0.0] }, "rocker.start"'),
    )
    joints = [f'{name} = {{ type = "Revolute", connect = [{pair}] }}' for name, pair in ends]
    length = math.hypot(0.7, 0.2)
    return "\n".join(
        [
            'format = 1\nname = "four-bar"\n',
            f"[parameters]\nc = {{ value = {length!r}, bounds = [0.7, 0.8] }}\n",
            "[bodies]",
            *bodies,
            "\n[joints]",
            *joints,
            "\n[drivers]",
            'motor = { type = "RotationalDriver", connect = ["ground", "crank"], '
            f'law = "{math.atan2(3, 1)!r} + 2*pi*t" }}\n',
        ]
    )


@pytest.fixture
def desk(browser: Any, studio_server: Studio, tmp_path: Path) -> Iterator[tuple[Desk, Studio]]:
    """A page with a four-bar."""
    (tmp_path / "model.toml").write_text(four_bar_text())
    reset(studio_server, path=str(tmp_path / "model.toml"))
    with opened(browser, studio_server, "0", (1500, 900)) as visit:
        yield visit, studio_server


def test_an_analysis_is_shown_and_written(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    text = visit.text
    visit.page.click("#tab-analysis")
    visit.page.click(".analysis [role=tab]:has-text('Dynamics')")
    visit.until("studio.insight.analysis.fields?.type === 'Dynamics'", 20)
    visit.settle()
    assert visit.text == text  # shown, not written
    visit.page.fill(".analysis [name=duration]", "0.5")
    visit.page.keyboard.press("Enter")
    visit.until("studio.pictures.page.motion.end === 0.5", 30)
    visit.page.click("text=Write into the text")
    visit.until("studio.file.document?.analysis?.duration === 0.5", 20)
    assert visit.text.startswith(text.rstrip("\n")) and 'type = "Dynamics"' in visit.text
    visit.until("studio.insight.analysis.fields === null", 10)
    visit.settle()
    visit.page.keyboard.press("Control+z")
    visit.until("!studio.file.document.analysis", 10)
    assert visit.text == text
    visit.page.click(".analysis [role=tab]:has-text('Modes')")
    visit.until("document.querySelector('.obstacle')?.innerText.includes('no modes')", 20)
    visit.page.fill(".analysis [name=law-motor]", "pi*t")
    visit.page.keyboard.press("Enter")
    visit.until("studio.file.document.drivers.motor.law === 'pi*t'", 10)


@pytest.mark.thorough
def test_an_obstacle_is_stated_over_the_drawn_position(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.js("studio.edit('x', [{ op: 'remove', section: 'drivers', name: 'motor' }])")
    visit.until("!studio.file.document.drivers?.motor", 10)
    visit.page.click("#tab-analysis")
    visit.page.click(".analysis [role=tab]:text-is('Kinematics')")
    visit.until("document.querySelector('.obstacle')", 30)
    visit.settle()
    assert "1 degree of freedom undetermined" in visit.page.inner_text(".obstacle")
    assert visit.js("studio.pictures.page.motion.bodies.length") == 3
    assert not visit.js("studio.pictures.page.motion.moves")
    visit.page.click(".obstacle >> text=Show the dynamics")
    visit.until("!document.querySelector('.obstacle')", 30)


@pytest.mark.thorough
def test_overlays_are_the_kinematics_of_the_mechanism(
    desk: tuple[Desk, Studio], tmp_path: Path
) -> None:
    visit, _ = desk
    seen = visit.page.evaluate("""async () => {
        const k = await import("./assets/plane_kinematics.js"), { motion } = studio.pictures.page;
        const cursor = { i: 40, f: 0 }, twist = (name) => k.twistOf(motion, motion.byName.get(name), cursor);
        return {
            time: motion.time[40],
            centre: k.instantCentre(twist("coupler"), k.GROUND),
            joint: k.instantCentre(twist("coupler"), twist("rocker")),
            pin: motion.at(motion.byName.get("coupler"), [motion.points.find((p) => p.name === "coupler.end").point[0], 0], cursor),
            crank: k.instantCentre(twist("crank"), k.GROUND),
            angles: k.transmissions(motion, cursor).map(({ body, angle }) => [body.name, angle]),
            limits: k.limitPositions(motion).slice(0, 2).map(({ body, cursor: { i, f } }) => [body.name, motion.time[i] + f * (motion.time[i + 1] - motion.time[i])]),
            speed: k.velocityAt(twist("crank"), motion.at(motion.byName.get("crank"), motion.points.find((p) => p.name === "crank.end").point, cursor)),
        };
    }""")
    # the four-bar in closed form: intersection of two circles around the pin A and the pivot C
    a, b, c, g = math.hypot(0.1, 0.3), math.hypot(0.7, 0.2), math.hypot(0.1, 0.5), 0.9

    def places(time: float) -> tuple[complex, complex]:
        pin = a * np.exp(1j * (math.atan2(3, 1) + 2 * math.pi * time))
        span = g - pin
        along = (abs(span) ** 2 + b * b - c * c) / (2 * abs(span))
        return pin, pin + span / abs(span) * complex(along, math.sqrt(b * b - along * along))

    pin, end = places(seen["time"])
    assert seen["pin"] == pytest.approx([end.real, end.imag], abs=1e-6)
    assert seen["crank"] == pytest.approx([0, 0], abs=1e-9)
    assert seen["joint"] == pytest.approx([end.real, end.imag], abs=1e-6)
    # centre of the coupler: intersection of the lines O A and C B
    s = np.linalg.solve([[pin.real, g - end.real], [pin.imag, -end.imag]], [g, 0])
    assert seen["centre"] == pytest.approx([s[0] * pin.real, s[0] * pin.imag], rel=1e-6)
    speed = 2j * math.pi * pin
    assert seen["speed"] == pytest.approx([speed.real, speed.imag], abs=1e-6)
    between = abs(np.angle((pin - end) / (g - end)))
    assert seen["angles"] == [["rocker", pytest.approx(min(between, math.pi - between), abs=1e-6)]]
    # limits: coupler and crank are in line, so that the distance O B is b + a or b - a
    distances = sorted(abs(places(time)[1]) for _, time in seen["limits"])
    assert distances == pytest.approx([b - a, b + a], abs=2e-4)
    visit.page.keyboard.press("8")
    assert "This analysis has no reactions" in visit.page.inner_text("#notice")


@pytest.mark.thorough
def test_targets_are_clicked_and_a_candidate_is_inserted(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    target = da.FourBar(crank=0.1, coupler=0.3, follower=0.25, ground=0.3, u=0.2, v=0.1)
    points = target.path(np.linspace(0.2, 5, 6)).round(4).tolist()
    visit.js(
        "studio.edit('clear', [{ op: 'remove', section: 'bodies', name: 'crank' }, { op: 'remove', section: 'bodies', name: 'coupler' }, { op: 'remove', section: 'bodies', name: 'rocker' }])"
    )
    visit.until("!studio.file.document.bodies", 10)
    visit.settle()
    visit.page.click("#tab-synthesis")
    visit.js(
        "(() => { const { view } = studio.pictures.page.scene; Object.assign(view, { x: 0.2, y: 0.1, s: 900, fitted: false }); view.onChange(); })()"
    )
    visit.page.click("text=Click points (⇧T)")
    for k, point in enumerate(points):
        place = visit.page.evaluate(
            """([x, y]) => {
            const { canvas, view } = studio.pictures.page.scene, [u, v] = view.screen([x, y]);
            const inner = canvas.getBoundingClientRect(), outer = studio.pictures.frame.getBoundingClientRect();
            return [u + inner.left + outer.left, v + inner.top + outer.top];
        }""",
            point,
        )
        visit.page.keyboard.down("Alt")
        visit.page.mouse.click(*place)
        visit.page.keyboard.up("Alt")
        visit.until(f"studio.file.document.synthesis?.points.length === {k + 1}", 10)
        visit.settle()
    clicked = visit.js("studio.file.document.synthesis.points")
    assert np.allclose(clicked, points, atol=2e-3)
    visit.page.fill(".synthesis [name=starts]", "3")
    visit.page.keyboard.press("Enter")
    visit.until("studio.file.document.synthesis.starts === 3", 10)
    text = visit.text
    visit.page.click("#start-synthesis")
    visit.until("studio.insight.synthesis.task?.status === 'done'", 60)
    assert visit.page.locator(".candidate").count() >= 1
    visit.until(
        "[...document.querySelectorAll('.candidate canvas')].every((c) => { const copy = new OffscreenCanvas(c.width, c.height).getContext('2d', { willReadFrequently: true }); copy.drawImage(c, 0, 0); return copy.getImageData(0, 0, c.width, c.height).data.some((v) => v); })",
        10,
    )
    assert visit.js(
        "[...document.querySelectorAll('.candidate')].every((c) => [...c.querySelectorAll('.defect, .good')].every((m) => { const [a, b] = [c, m].map((n) => n.getBoundingClientRect()); return b.left >= a.left && b.top >= a.top && b.bottom <= a.bottom; }))"
    )
    visit.page.click(".candidate >> nth=0 >> text=Insert")
    visit.until("studio.file.document.bodies?.crank1", 10)
    visit.settle()
    assert visit.js("studio.described.facts.free") == 0
    curve = visit.js(
        """(() => { const { motion } = studio.pictures.page, p = motion.points.find(({ name }) => name === "coupler1.P"); return motion.frames(400).map((c) => motion.at(p.body, p.point, c)); })()"""
    )
    assert visit.js("studio.insight.synthesis.task.cards[0].distance") < 1e-6
    z, w = (np.array(way) @ [1, 1j] for way in (clicked, curve))
    edge = np.diff(w)
    share = np.clip(np.real((z[:, None] - w[:-1]) * np.conj(edge)) / np.abs(edge) ** 2, 0, 1)
    away = np.abs(z[:, None] - w[:-1] - share * edge).min(axis=1)
    assert np.max(away) < 1e-3  # sag of the chords between the instants
    visit.page.keyboard.press("Control+z")
    visit.until("!studio.file.document.bodies", 10)
    assert visit.text == text


@pytest.mark.thorough
def test_an_optimum_is_written_into_the_text(desk: tuple[Desk, Studio], browser: Any) -> None:
    visit, studio = desk
    visit.page.click("#tab-analysis")
    visit.page.click(".analysis [role=tab]:text-is('Kinematics')")
    visit.until("studio.insight.analysis.fields", 20)
    visit.page.click("text=Write into the text")
    visit.until("studio.file.document.analysis", 20)
    visit.page.click("#tab-design")
    visit.page.fill("[name=new-response]", "reach")
    visit.page.fill("[name=new-measure]", "(c - 0.75)**2")
    visit.page.click(".design >> text=Add")
    visit.until("studio.file.document.responses?.reach", 10)
    visit.page.select_option("[name=aim-reach]", "minimize")
    visit.until("studio.file.document.optimize?.minimize === 'reach'", 10)
    other = browser.new_page()
    other.goto(studio.address)
    visit.page.click("#start-task")
    visit.until("studio.insight.design.tasks.optimize?.status === 'done'", 60)
    assert "optimal" in visit.page.inner_text(".design .task .result")
    Desk(other).until("studio.insight.design.tasks.optimize?.status === 'done'", 20)
    other.close()
    text = visit.text
    visit.page.click("text=Show the result")
    visit.until(
        "document.querySelector('.result-panel iframe').contentWindow.dalembert?.motion", 30
    )
    visit.page.click("text=Write its parameters into the text")
    visit.until("Math.abs(studio.file.document.parameters.c.value - 0.75) < 1e-4", 10)
    visit.page.keyboard.press("Control+z")
    visit.until("studio.file.document.parameters.c.value < 0.74", 10)
    assert visit.text == text
