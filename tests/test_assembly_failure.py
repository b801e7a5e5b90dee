"""A mechanism that cannot be assembled: what is told, and the page that draws it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from browser import visit

import dalembert as da
from dalembert import planar
from dalembert.cli import main


def frame(span: float) -> da.System:
    """Crank of 0.3 m and rocker of 0.6 m on the ground, ``span`` apart."""
    system = da.System("frame")
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.0, angle=1.57))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=1.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("O2", system.ground.point(span, 0), rocker.start))
    return system


def four_bar(coupler: float, span: float) -> da.System:
    system = frame(span)
    bar = system.add(planar.Bar("coupler", length=coupler, mass=1.0))
    system.add(planar.Revolute("A", system.elements["crank"].end, bar.start))
    system.add(planar.Revolute("B", bar.end, system.elements["rocker"].end))
    return system


def linked() -> da.System:
    system = frame(1.0)
    ends = system.elements["crank"].end, system.elements["rocker"].end
    system.add(planar.RigidLink("link", *ends, length=2.5))
    return system


def driven() -> da.System:
    system = four_bar(1.0, 1.0)
    far = system.elements["rocker"].end
    system.add(planar.DistanceDriver("ram", system.ground.point(0, 0), far, 2.0))
    return system


def prescribed() -> da.System:
    system = four_bar(1.0, 1.0)
    system.initial(system.elements["crank"].end.y, 3.0)
    return system


def blocked() -> da.System:
    """A slider crank whose rail is higher than crank and rod reach."""
    system = da.System("slider crank")
    crank = system.add(planar.Bar("crank", length=0.5, mass=1.0, angle=1.5))
    rod = system.add(planar.Bar("rod", length=0.3, mass=1.0))
    piston = system.add(planar.Body("piston", mass=1.0, inertia=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, piston.center))
    system.add(planar.Prismatic("rail", system.ground.point(0, 1), piston.center))
    return system


FAILURES = {
    "too long a span": (lambda: four_bar(1.0, 2.0), "B", "0.1 m apart at best, 0 m wanted"),
    "too short a coupler": (lambda: four_bar(0.05, 1.0), "B", "0.05 m apart at best, 0 m wanted"),
    "too long a link": (linked, "link", "requires 2.5 m, at most 1.9 m can be reached"),
    "too far a ram": (driven, "ram", "requires 2 m, at most 1.3 m can be reached"),
    "too high a point": (
        prescribed,
        "the initial value of crank.end.y",
        "requires 3 m, at most 0.3 m can be reached",
    ),
    "too high a rail": (blocked, "B", "0.2 m apart at best, 0 m wanted"),
}
"""By geometry: stretched or folded chains of the lengths given."""


def failure(make) -> da.AssemblyError:
    with pytest.raises(da.AssemblyError) as caught:
        make().build()
    return caught.value


@pytest.mark.few(1)
@pytest.mark.parametrize("name", FAILURES)
def test_wanted_and_reachable_are_told(name):
    make, joint, text = FAILURES[name]
    error = failure(make)
    assert error.position.joint == joint and f"{joint} " in str(error) and text in str(error)
    assert np.all(np.isfinite(error.position.y)) and error.residual > 0


def test_bodies_and_the_loop_are_told():
    error = failure(lambda: four_bar(1.0, 2.0))
    assert "B (coupler, rocker)" in str(error) and "in the loop O1–A–B–O2" in str(error)
    assert np.linalg.norm(np.diff(error.position.ends, axis=0)) == pytest.approx(0.1, abs=1e-6)


def test_the_other_joints_are_closed():
    """The drawing shows one gap: at the best position only the joint that is told is open."""
    position = failure(blocked).position
    poses = dict(zip(("crank", "rod", "piston"), position.y.reshape(-1, 3), strict=True))
    x, y, angle = poses["crank"]
    assert math.hypot(x - 0.25 * math.cos(angle), y - 0.25 * math.sin(angle)) < 1e-6
    assert abs(poses["piston"][1] - 1.0) < 1e-6 and abs(poses["piston"][2]) < 1e-6


@pytest.mark.few(1)
@pytest.mark.parametrize("name", FAILURES)
def test_every_failure_has_its_page(name, tmp_path):
    make, joint, _ = FAILURES[name]
    page = da.assembly_report(failure(make), tmp_path / "page.html")
    assert joint in page.read_text(encoding="utf-8")


@pytest.mark.thorough
def test_the_page_shows_the_gap(browser, tmp_path):
    page = da.assembly_report(failure(lambda: four_bar(1.0, 2.0)), tmp_path / "page.html")
    with visit(browser, page) as shown:
        assert not shown.console
        assert shown.js("dalembert.motion.gaps.map(gap => gap.text)") == ["0.1 m"]
        with_gap = shown.picture("#scene")
        shown.js("dalembert.motion.gaps = [], dalembert.scene.draw()")
        without_gap = shown.picture("#scene")
        shown.js("dalembert.motion.ghosts = [], dalembert.scene.draw()")
        assert len({with_gap, without_gap, shown.picture("#scene")}) == 3


FILE = """
format = 1

[ground.points]
O = [0.0, 0.0]
Q = [1.0, 0.0]

[bodies.bar]
type = "Bar"
length = 0.8
mass = 1.0

[joints.A]
type = "Revolute"
connect = ["ground.O", "bar.start"]

[joints.B]
type = "Revolute"
connect = ["ground.Q", "bar.end"]

[analysis]
type = "Kinematics"
duration = 1.0
"""


@pytest.mark.parametrize("command", ["check", "run"])
def test_commands_draw_it(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("short.toml").write_text(FILE, encoding="utf-8")
    assert main([command, "short.toml"]) == 2
    message = capsys.readouterr().err
    assert "0.2 m apart" in message and "drawn in short.assembly.html" in message
    assert sorted(path.name for path in Path().iterdir()) == ["short.assembly.html", "short.toml"]


def test_no_report_no_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("short.toml").write_text(FILE, encoding="utf-8")
    assert main(["run", "short.toml", "--no-report"]) == 2
    assert [path.name for path in Path().iterdir()] == ["short.toml"]
