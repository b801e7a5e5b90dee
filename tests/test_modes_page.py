"""Pages of modes of mechanisms: pictures to second order, amplitudes, eigenvalues."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mode_models import carts, double_pendulum, suspended_body

import dalembert as da
from dalembert.report.overlay import overlay
from dalembert.results.pictures.animation import write_film


def blocks(body: dict[str, Any], names: str) -> np.ndarray:
    """(6, components, modes) columns of a body: at rest, and their oscillation."""
    return np.stack([np.reshape(body[name], (6, -1)) for name in names.split()], axis=1)


@pytest.mark.parametrize("coordinates", [da.AbsoluteCoordinates(), da.JointCoordinates()])
def test_pictures_close_the_joints_to_second_order(coordinates: Any) -> None:
    """The gap between two bars is cubic in the amplitude."""
    modes = da.linearize(double_pendulum(damping=1.0), coordinates=coordinates)
    upper, lower = (blocks(b, "x y angle") for b in modes.page()["scene"]["bodies"])

    def gap(amplitude: float, phase: float) -> np.ndarray:
        s, c = amplitude * np.sin(phase), amplitude * np.cos(phase)
        terms = np.array([1, s, c, s**2, 2 * s * c, c**2])
        poses = [np.tensordot(terms, b, 1) for b in (upper, lower)]
        ends = []
        for (x, y, angle), along in zip(poses, (0.5, -0.4), strict=True):
            ends.append(np.array([x + along * np.cos(angle), y + along * np.sin(angle)]))
        return np.abs(ends[0] - ends[1]).max(axis=0)

    for phase in (0.0, 1.0, 2.5):
        assert np.all(gap(0.0, phase) < 1e-9)
        np.testing.assert_allclose(gap(0.1, phase) / gap(0.05, phase), 8.0, rtol=0.1)


def test_shapes_are_those_of_the_modes() -> None:
    modes = da.linearize(carts())
    bodies = modes.page()["scene"]["bodies"]
    for k, body in enumerate(bodies):
        rest, real, imag, *squares = blocks(body, "x y angle")
        np.testing.assert_allclose(squares, 0.0, atol=1e-12)
        np.testing.assert_allclose(rest[0], 0.5 * (k + 1), atol=1e-9)
        np.testing.assert_allclose(real, modes.shapes.real[3 * k : 3 * k + 3], atol=1e-9)
        np.testing.assert_allclose(imag, modes.shapes.imag[3 * k : 3 * k + 3], atol=1e-9)


@pytest.mark.thorough
@pytest.mark.parametrize("build", [carts, double_pendulum, suspended_body])
def test_the_largest_movement_is_a_tenth_of_the_mechanism(build: Any, show: Any) -> None:
    modes = da.linearize(build())
    page = show(modes)
    assert page.page.locator("#case option").count() == modes.numbers.size
    size = page.js("dalembert.scene.size")
    for k in range(modes.numbers.size):
        page.page.select_option("#case", str(k))
        page.frames()
        assert page.js("dalembert.motion.chosen") == k
        moved = page.js("dalembert.motion.swing.automatic")
        assert 0.01 * size < moved < 0.101 * size
        assert page.page.locator("#eigenvalues tr.chosen th").inner_text() == str(k + 1)
    before = page.picture("#scene")
    page.js("dalembert.player.seek(0)")
    page.frames()
    assert page.picture("#scene") != before
    page.page.fill("#scale", "0")
    page.frames()
    assert page.page.inner_text("#factor") == "up to 0 µm"


def test_a_row_or_a_dot_chooses_a_mode(show: Any) -> None:
    page = show(da.linearize(carts()))
    page.page.locator("#eigenvalues tbody tr").nth(2).click()
    assert page.page.input_value("#case") == "2"
    page.page.locator("#complex-plane circle").first.click(force=True)
    assert page.page.input_value("#case") != "2"
    page.page.keyboard.press("ArrowRight")
    cells = page.page.locator("#eigenvalues tr.chosen td").all_inner_texts()
    k = page.js("dalembert.motion.chosen")
    modes = da.linearize(carts())
    numbers = [float(text) for text in cells[:4]]
    tau = -1 / modes.eigenvalues[k].real
    expected = [modes.frequencies[k], abs(modes.eigenvalues[k]), modes.damping_ratios[k], tau]
    np.testing.assert_allclose(numbers, expected, rtol=1e-3)
    assert cells[4] == "decaying oscillation"


@pytest.mark.thorough
def test_undamped_modes_have_no_complex_plane(show: Any) -> None:
    model = double_pendulum(damping=0.0)
    page = show(da.linearize(model))
    assert page.page.locator("#complex-plane").is_hidden()
    assert "ζ" not in page.page.inner_text("#case option >> nth=0")


@pytest.mark.thorough
def test_unstable_modes_are_named(show: Any) -> None:
    system = da.System("inverted", gravity=(0.0, -9.81))
    bar = system.add(da.planar.Bar("bar", length=1.0, mass=1.0, angle=np.pi / 2))
    system.add(da.planar.Revolute("O", system.ground.center, bar.start))
    modes = da.linearize(system.build(), equilibrium=False)
    page = show(modes)
    names = page.page.locator("#case option").all_inner_texts()
    assert [name.rpartition(", ")[2] for name in names] == ["decays", "diverges"]
    assert page.page.inner_text("#eigenvalues tr >> nth=2").endswith("divergence")


def test_pages_use_preferred_units(show: Any, tmp_path: Path) -> None:
    modes = da.linearize(carts())
    page = show(modes.page(units=["mHz", "mm"]))
    assert page.page.inner_text("#case option >> nth=0").startswith("mode 1: 2436.2 mHz")
    assert "frequency [mHz]" in page.page.inner_text("#eigenvalues thead").replace("\xa0", " ")


@pytest.mark.thorough
def test_two_runs_on_one_page(show: Any) -> None:
    first, second = (da.linearize(carts(), parameters={"mass": mass}) for mass in (1.0, 2.0))
    page = show(overlay(first.page(), second.page(), "second.nc"))
    assert page.js("dalembert.motion.ghosts.length") == 3
    assert page.page.locator("#ghosts").inner_text() == "Other run"
    motion = da.solve_equilibrium(carts())
    with pytest.raises(da.FileError, match="modes are compared with modes"):
        overlay(first.page(), motion.page(), "motion.nc")


def test_modes_have_no_film(tmp_path: Path) -> None:
    with pytest.raises(da.FileError, match="their page shows them"):
        write_film(da.linearize(carts()).page(), tmp_path / "film.gif")


@pytest.mark.thorough
def test_the_optimum_of_a_frequency_shows_the_first_design(show: Any) -> None:
    model = double_pendulum()
    first = da.at(1, "frequency")
    best = da.optimize(model, maximize=first, vary=["first"], analysis=da.Modal())
    page = show(best.page())
    assert page.js("dalembert.motion.ghosts.length") == 2
    assert page.page.locator("#ghosts").inner_text() == "First design"


def test_a_parameter_may_have_the_name_of_a_measure() -> None:
    system = da.System("swing", gravity=(0.0, -9.81))
    length = system.parameter("frequency", 1.0, "m", bounds=(0.5, 2.0))
    bar = system.add(da.planar.Bar("bar", length=length, mass=1.0, angle=-1.5))
    system.add(da.planar.Revolute("O", system.ground.center, bar.start))
    modes = da.linearize(system.build())
    expected = np.sqrt(1.5 * 9.81) / (2 * np.pi)
    assert modes.frequencies == pytest.approx([expected], rel=1e-9)


def test_a_mechanism_without_modes_has_a_page(show: Any) -> None:
    system = da.System("truss", gravity=(0.0, -9.81))
    bar = system.add(da.planar.Bar("bar", length=1.0, mass=1.0, angle=0.3))
    system.add(da.planar.Revolute("O", system.ground.center, bar.start))
    system.add(da.planar.RotationalDriver("hand", system.ground, bar, 0.3))
    modes = da.linearize(system.build(), equilibrium=False)
    assert modes.numbers.size == 0
    page = show(modes)
    assert page.page.locator("#case").count() == 0
    assert page.js("dalembert.motion.bodies.length") == 1
