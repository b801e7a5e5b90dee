"""Textbook mechanisms drawn from nothing by clicks and typed numbers, against closed forms."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from studio_desk import UNTITLED, Desk
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file

TURN = np.linspace(0, 2 * math.pi, 25)


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


def typed(visit: Desk, key: str, *places: str) -> None:
    """Use a tool whose places are typed."""
    revision = visit.revision
    visit.page.locator("#palette button").first.focus()
    visit.page.keyboard.press(key)
    for place in places:
        visit.page.keyboard.type(place)
        visit.page.keyboard.press("Enter")
    visit.settle(revision + 1)


def model_of(visit: Desk, tmp_path: Path) -> Any:
    assert visit.errors_shown() == []
    (tmp_path / "drawn.toml").write_text(visit.text)
    return load_model_file(tmp_path / "drawn.toml").model()


def turn_of(model: Any) -> Any:
    """A turn of the drawn motor, which takes two seconds."""
    return da.solve_kinematics(model, 2.0, outputs=len(TURN))


def drawn_slider_crank(visit: Desk) -> None:
    typed(visit, "b", "0,0", "0.2<90")
    typed(visit, "b", "0,0.2", "0.4,0")
    visit.draw("o", (0, 0))
    visit.draw("s", (0.4, 0), (0.8, 0))
    visit.draw("m", (0, 0))


@pytest.mark.thorough
def test_slider_crank(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    visit, _ = desk
    drawn_slider_crank(visit)
    assert visit.page.inner_text("#summary") == "1 degree of freedom, 1 driven, 0 free"
    model = model_of(visit, tmp_path)
    motion = turn_of(model)
    rod = math.hypot(0.4, 0.2)
    angle = TURN + math.pi / 2
    wanted = 0.2 * np.cos(angle) + np.sqrt(rod**2 - (0.2 * np.sin(angle)) ** 2)
    assert motion["bar2.end.x"].values == pytest.approx(wanted, abs=1e-8)
    efforts = da.solve_inverse_dynamics(model, 2.0, outputs=201)
    moment = efforts["motor1.moment"].values  # of constant speed: its work in a turn is zero
    assert np.trapezoid(moment, efforts.time) == pytest.approx(0, abs=1e-3 * np.ptp(moment))


@pytest.mark.thorough
def test_quick_return(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """Whitworth's crank and slotted lever: angle of the lever, and ratio of the times."""
    visit, _ = desk
    typed(visit, "b", "0.4,0.2", "0.1<0")  # crank about (0.4, 0.2)
    typed(visit, "b", "0.4,0", "0.35<63.43494882292201")  # lever from below
    visit.draw("o", (0.4, 0.2))
    visit.draw("o", (0.4, 0))
    end = 0.4 + 0.35 * np.exp(1j * math.atan2(2, 1))
    visit.draw("u", (0.5, 0.2), (0.45, 0.1), (end.real, end.imag))
    visit.draw("m", (0.4, 0.2))
    assert visit.page.inner_text("#summary") == "1 degree of freedom, 1 driven, 0 free"
    motion = turn_of(model_of(visit, tmp_path))
    pin = 0.1 * np.exp(1j * TURN) + 0.2j
    lever = motion["bar2.angle"].values
    assert np.exp(1j * lever) == pytest.approx(pin / abs(pin), abs=1e-7)
    half = math.asin(0.1 / 0.2)  # limits of the lever from the vertical
    fine = da.solve_kinematics(model_of(visit, tmp_path), 2.0, outputs=2001)["bar2.angle"].values
    assert np.ptp(fine) == pytest.approx(2 * half, abs=1e-4)


@pytest.mark.thorough
def test_gear_train(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """Two gears of 0.1 and 0.2 m: the second turns half as fast, backwards."""
    visit, _ = desk
    typed(visit, "b", "0.2,0.2", "0.1<90")
    typed(visit, "b", "0.5,0.2", "0.2<90")
    visit.draw("o", (0.2, 0.2))
    visit.draw("o", (0.5, 0.2))
    visit.draw("g", (0.2, 0.2), (0.5, 0.2), (0.3, 0.2))
    visit.draw("m", (0.2, 0.2))
    motion = turn_of(model_of(visit, tmp_path))
    assert motion["bar1.angle"].values - math.pi / 2 == pytest.approx(TURN, abs=1e-8)
    assert motion["bar2.angle"].values - math.pi / 2 == pytest.approx(-TURN / 2, abs=1e-8)


@pytest.mark.thorough
def test_stephenson_six_bar(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """Grübler: 3·5 − 2·7 = 1; the four-bar loop and the dyad close at every instant."""
    visit, _ = desk
    typed(visit, "b", "0,0", "0,0.15")
    visit.draw("p", (0, 0.15), (0.5, 0.4), (0.3, 0.5), (0, 0.15))
    typed(visit, "b", "0.5,0.4", "0.6,0")
    typed(visit, "b", "0.3,0.5", "0.8,0.5")
    typed(visit, "b", "0.8,0.5", "0.9,0")
    for place in ((0, 0), (0.6, 0), (0.9, 0)):
        visit.draw("o", place)
    visit.draw("m", (0, 0))
    assert visit.page.inner_text("#summary") == "1 degree of freedom, 1 driven, 0 free"
    assert len(visit.document["joints"]) == 7
    motion = turn_of(model_of(visit, tmp_path))
    place = {
        n: motion[f"{n}.x"].values + 1j * motion[f"{n}.y"].values
        for n in ("bar1.end", "plate1.P1", "plate1.P2", "plate1.P3", "bar4.start")
    }
    assert place["bar1.end"] == pytest.approx(0.15 * np.exp(1j * (TURN + math.pi / 2)), abs=1e-8)
    assert abs(place["plate1.P2"] - place["bar1.end"]) == pytest.approx(math.hypot(0.5, 0.25))
    assert abs(place["plate1.P2"] - 0.6) == pytest.approx(math.hypot(0.1, 0.4))
    assert abs(place["bar4.start"] - 0.9) == pytest.approx(math.hypot(0.1, 0.5))
    assert abs(place["plate1.P3"] - place["bar4.start"]) == pytest.approx(0.5)


@pytest.mark.thorough
def test_scissor_lift(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """Height of both upper ends over the width of the base."""
    visit, _ = desk
    typed(visit, "b", "0.1,0.1", "0.7,0.5")
    typed(visit, "b", "0.7,0.1", "0.1,0.5")
    visit.draw("o", (0.1, 0.1))
    visit.draw("s", (0.7, 0.1), (0.9, 0.1))
    visit.draw("o", (0.4, 0.3))  # where the bars cross
    assert visit.page.inner_text("#summary") == "1 degree of freedom"
    visit.draw("N", (0.1, 0.1), (0.7, 0.1))
    motion = turn_of(model_of(visit, tmp_path))
    base = 0.6 + 0.06 * np.sin(math.pi * motion.time)
    height = 0.1 + np.sqrt(0.6**2 + 0.4**2 - base**2)
    for name in ("bar1.end", "bar2.end"):
        assert motion[f"{name}.y"].values == pytest.approx(height, abs=1e-6)


@pytest.mark.thorough
def test_boom_with_a_cylinder(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """The length of a cylinder gives the angle of the boom by the law of cosines."""
    visit, _ = desk
    typed(visit, "b", "0.2,0", "0.8<30")
    visit.draw("o", (0.2, 0))
    boom = complex(0.2, 0) + 0.8 * np.exp(1j * math.pi / 6)
    visit.draw("N", (0.6, 0), (boom.real, boom.imag))
    (driver,) = visit.document["drivers"].values()
    length = abs(boom - 0.6)
    assert driver["law"].startswith(f"{length:.6f}"[:6])
    assert visit.page.inner_text("#summary") == "1 degree of freedom, 1 driven, 0 free"
    motion = turn_of(model_of(visit, tmp_path))
    lengths = length + 0.1 * length * np.sin(math.pi * motion.time)
    angle = np.arccos((0.8**2 + 0.4**2 - lengths**2) / (2 * 0.8 * 0.4))
    assert motion["bar1.angle"].values == pytest.approx(angle, abs=1e-6)


@pytest.mark.thorough
def test_cam_and_follower(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """A circular cam about a centre off its pin lifts the follower as an eccentric does."""
    visit, _ = desk
    typed(visit, "b", "0.2,0.2", "0.1<0")
    typed(visit, "b", "0.5,0.2", "0.3<0")
    visit.draw("o", (0.2, 0.2))
    visit.draw("i", (0.65, 0.2), (0.65, 0.5), (0.9, 0.2))
    visit.draw("c", (0.3, 0.2), (0.5, 0.2))
    visit.draw("m", (0.2, 0.2))
    assert visit.page.inner_text("#summary") == "1 degree of freedom, 1 driven, 0 free"
    motion = turn_of(model_of(visit, tmp_path))
    off, radius = 0.1, 0.2
    reach = off * np.cos(TURN) + np.sqrt(radius**2 - (off * np.sin(TURN)) ** 2)
    away = np.abs(motion["bar2.start.x"].values - (0.2 + reach))
    assert np.max(away) < 2e-3  # a spline of twelve points


def test_typed_places_need_no_pointer(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    typed(visit, "b", "100 mm,50 mm", "300 mm<90")
    bar = visit.document["bodies"]["bar1"]
    assert bar["position"] == pytest.approx([0.1, 0.2]) and bar["length"] == pytest.approx(0.3)
    visit.press("Control+z")
    assert visit.text == UNTITLED


@pytest.mark.thorough
def test_a_braced_rectangle(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    """Two diagonals, one of them redundant: it closes in spite of the rounding of drawn numbers."""
    visit, _ = desk
    corners = ["0,0", "0.7,0", "0.7,0.3", "0,0.3"]
    for start, end in [*zip(corners, [*corners[1:], corners[0]], strict=True), ("0,0", "0.7,0.3")]:
        typed(visit, "b", start, end)
    typed(visit, "b", "0.7,0", "0,0.3")
    assert model_of(visit, tmp_path).diagnosis.degrees_of_freedom == 3
