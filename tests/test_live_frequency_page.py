"""Live pages of frequency responses in a browser: curves, shapes and slopes as in Python."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Visit, visit
from live_visits import SLOPE, SLOPES, VALUES, change, close, settle

import dalembert as da
from dalembert import planar, structures

SHARE, MASS, NATURAL = 0.05, 100.0, 2 * math.pi * 5
LINES = "dalembert.charts[0].view.lines.map(({ re, im }) => [re, im])"
"""Complex amplitudes of the Bode plot."""


def absorber() -> da.Model:
    """A machine on springs with a vibration absorber (Den Hartog)."""
    system = da.System("absorber")
    stiffness = system.parameter("stiffness", 3900.0, "N/m", bounds=(3000, 7000))
    damping = system.parameter("damping", 25.0, "N s/m", bounds=(0, 200))
    push = system.input("push", unit="N")
    machine = system.add(planar.Particle("machine", mass=MASS))
    body = system.add(planar.Particle("absorber", mass=SHARE * MASS, position=(0, 0.4)))
    system.add(planar.PinInSlot("guide", system.ground.center, machine.center, axis=(0, 1)))
    system.add(planar.PinInSlot("slide", system.ground.center, body.center, axis=(0, 1)))
    ends = system.ground.point(0, -0.4), machine.center
    system.add(planar.Spring("springs", *ends, stiffness=MASS * NATURAL**2, free_length=0.4))
    numbers = {"stiffness": stiffness, "damping": damping, "free_length": 0.4}
    system.add(planar.Spring("tuning", machine.center, body.center, **numbers))
    system.add(planar.Force("force", machine.center, (0, push)))
    system.output("gain", machine.center.y * (MASS * NATURAL**2))
    return system.build()


def exact_height(share: float) -> float:
    """Height of the lowest equal peaks (Nishihara and Asami, J. Vib. Acoust. 124, 2002)."""
    q = math.sqrt(4 + 3 * share)
    square = (8 + 9 * share) ** 2 * (16 + 9 * share) - 128 * q**3
    return math.sqrt(square / (3 * (32 + 27 * share))) / (3 * share)


@pytest.fixture
def page(browser: Any, tmp_path: Path) -> Any:
    analysis = da.FrequencyResponse(outputs=["gain", "absorber.y"], span=(3, 8))
    response = analysis.run(absorber())
    path = response.report(tmp_path / "absorber.html")
    with visit(browser, path) as found:
        settle(found)
        yield found
        assert (found.requests, found.console) == ([], [])


def compare(page: Visit, other: Any) -> None:
    """Curves of the page and of a result at its frequencies."""
    frequencies = np.array(page.js("[...dalembert.picture.result.times]"))
    at = other.at(frequencies)
    for name, parts in zip(other.outputs, page.js(LINES), strict=True):
        expected = at.complex_values(name)[:, 0]
        close(parts, [expected.real, expected.imag], VALUES)


def test_curves_peaks_and_slopes_follow_the_sliders(page: Visit) -> None:
    model, random = absorber(), np.random.default_rng(7)
    names = [f"{name}.amplitude" for name in ("gain", "absorber.y")]
    labels = page.js("dalembert.table.responses.map(({ label }) => label)")
    assert labels == [f"maximum({name})" for name in names]
    for _ in range(3):
        values = {"stiffness": random.uniform(3000, 7000), "damping": random.uniform(5, 200)}
        change(page, dict(enumerate(values.values())))
        analysis = da.FrequencyResponse(outputs=["gain", "absorber.y"], span=(3, 8))
        other = analysis.run(model, values)
        compare(page, other)
        responses = [da.maximum(name) for name in names]
        expected = [da.evaluate(other, response) for response in responses]
        close(page.js("dalembert.table.values"), expected, VALUES)
        for k, response in enumerate(responses):
            close(page.js(SLOPE.format(k)), da.sensitivity(other, response).values, SLOPES)
    assert "Dashed: initial design" in page.page.inner_text(".other-run")
    assert page.page.locator("#board path.dashed").count() >= 3


def test_the_shape_is_that_of_the_chosen_frequency(page: Visit) -> None:
    page.page.select_option("#case", "0")
    peak = int(page.js("dalembert.picture.shown.peaks.indexOf(true)"))
    page.page.select_option("#case", str(peak))
    before = page.js("dalembert.picture.shown.values[dalembert.motion.chosen]")
    change(page, {0: 5000.0})
    states = page.js("dalembert.picture.shown")
    chosen = page.js("dalembert.motion.chosen")
    assert states["peaks"][chosen]
    frequency = float(states["values"][chosen])
    assert frequency != before
    other = da.frequency_response(absorber(), [frequency], parameters={"stiffness": 5000.0})
    motions = [other.complex_values(f"{name}.y")[0, 0] for name in ("machine", "absorber")]
    bodies = page.js("dalembert.motion.bodies.map(({ y }) => [...y])")
    columns = [np.reshape(body, (6, -1))[:, chosen] for body in bodies[:2]]
    shapes = [column[1] + 1j * column[2] for column in columns]
    assert shapes[1] / shapes[0] == pytest.approx(motions[1] / motions[0], rel=VALUES)
    text = page.page.locator(".readout").first.inner_text()
    assert float(text.split(" Hz")[0]) == pytest.approx(frequency, rel=1e-4)


@pytest.mark.thorough
def test_improvement_reaches_the_optimum_of_equal_peaks(page: Visit) -> None:
    page.js("dalembert.improvement.goals.set(dalembert.table.responses[0], 'minimise')")
    page.js("void dalembert.improvement.start()")
    page.until("!dalembert.improvement.running && dalembert.improvement.history.length > 1")
    assert "Converged" in page.page.locator("#improve-status").text_content()
    settle(page)
    heights = page.js("dalembert.table.values[0]")
    assert heights == pytest.approx(exact_height(SHARE), rel=1e-7)
    assert len(page.js("dalembert.table.values")) == 2


@pytest.mark.thorough
def test_undamped_resonances_are_infinite(page: Visit) -> None:
    change(page, {1: 0.0})
    assert "No damping acts on the resonance" in page.page.inner_text(".live-status.warning")
    assert page.js("dalembert.table.values[0]") == np.inf
    change(page, {1: 40.0})
    assert page.page.locator(".live-status.warning").count() == 0


@pytest.mark.thorough
def test_peaks_are_added(page: Visit) -> None:
    page.page.click("#add-response")
    page.page.select_option(".add-response select >> nth=0", label="peak 2")
    page.page.select_option(".add-response .measure", label="gain.amplitude")
    page.page.click("#add-response-now")
    settle(page)
    other = da.frequency_response(absorber(), outputs=["gain"], span=(3, 8))
    expected = da.evaluate(other, da.peak(2, "gain.amplitude"))
    assert page.js("dalembert.table.values.at(-1)") == pytest.approx(expected, rel=VALUES)
    change(page, {0: 5000.0})
    assert "%" in page.page.locator(".responses tbody tr").last.inner_text()


@pytest.mark.thorough
def test_a_structure_follows_its_sliders(browser: Any, tmp_path: Path) -> None:
    """A mast on a shaken foundation: curves, slopes and shapes."""
    mast = da.Structure("mast")
    area = mast.parameter("area", 2e-3, "m^2", bounds=(1e-3, 4e-3))
    tip = mast.parameter("tip", 30.0, "kg", bounds=(10, 60))
    shake = mast.input("shake", unit="m")
    nodes = [mast.node(f"n{k}", 0.0, 0.8 * k) for k in range(5)]
    section = {"area": area, "second_moment": area * area / 12, "modulus": 2.1e11}
    for k in range(4):
        frame = structures.Frame(f"e{k}", nodes[k], nodes[k + 1], density=7850.0, **section)
        mast.add(frame)
    mast.add(structures.PointMass("head", nodes[4], mass=tip))
    mast.support(nodes[0], ux=shake, uy=0, rz=0)
    model = mast.build()
    analysis = da.FrequencyResponse(
        inputs=["shake"], outputs=["n4.ux", "e0.moment_i"], loss_factor=0.02
    )
    path = analysis.run(model).report(tmp_path / "mast.html")
    with visit(browser, path) as page:
        settle(page)
        assert page.js("dalembert.design.parameters.length") == 3
        change(page, {0: 3e-3, 1: 20.0})
        other = analysis.run(model, {"area": 3e-3, "tip": 20.0})
        compare(page, other)
        responses = [da.maximum(f"{name}.amplitude") for name in analysis.outputs]
        expected = [da.evaluate(other, response) for response in responses]
        close(page.js("dalembert.table.values"), expected, VALUES)
        for k, response in enumerate(responses):
            close(page.js(SLOPE.format(k)), da.sensitivity(other, response).values, SLOPES)
        chosen = page.js("dalembert.motion.chosen")
        frequency = page.js("dalembert.picture.shown.values")[chosen]
        shape = np.array(
            page.js("[...dalembert.motion.mesh.displacements[dalembert.motion.chosen]]")
        )
        motion = other.at(frequency).motions[0, :, 0]
        turned = (motion * np.exp(-0.5j * np.angle(np.sum(motion**2)))).real
        turned /= np.abs(turned.reshape(-1, 3)[:, :2]).max()
        close(shape * np.sign(shape @ turned), turned, VALUES)
        assert "NaN" not in page.page.inner_text("#board")
        assert (page.requests, page.console) == ([], [])
