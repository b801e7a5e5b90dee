"""Pages of frequency responses: charts, choice of the frequency, deflection shapes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial, structures
from dalembert.report.packing import pack, unpack


def carts() -> da.Model:
    system = da.System("two carts")
    push = system.input("push", unit="N")
    previous = system.ground.center
    for k in range(2):
        body = system.add(planar.Particle(f"m{k}", mass=1.0, position=(0.5 * (k + 1), 0)))
        system.add(planar.PinInSlot(f"r{k}", system.ground.center, body.center))
        numbers = {"stiffness": 100.0, "damping": 0.4, "free_length": 0.5}
        system.add(planar.Spring(f"s{k}", previous, body.center, **numbers))
        previous = body.center
    system.add(planar.Force("force", previous, (push, 0)))
    return system.build()


def plate() -> da.Model:
    system = da.System("plate", gravity=(0, 0, 0))
    moment = system.input("moment", unit="N m")
    body = system.add(spatial.Body("plate", mass=3.0, inertia=(0.2, 0.4, 0.5)))
    frames = system.ground.frame((0, 0, 0)), body.frame((0, 0, 0))
    system.add(spatial.Revolute("hinge", *frames))
    system.add(spatial.TorsionSpring("spring", *frames, stiffness=8.0, damping=0.1))
    system.add(spatial.Torque("torque", body, (0, 0, moment)))
    return system.build()


def mast() -> da.StructuralModel:
    mast = da.Structure("mast")
    nodes = [mast.node(f"n{k}", 0.0, 0.5 * k) for k in range(5)]
    for k in range(4):
        section = {"area": 2e-3, "second_moment": 4e-6, "modulus": 2.1e11, "density": 7850.0}
        mast.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **section))
    mast.support(nodes[0])
    mast.load(nodes[4], case="wind", fx=1.0)
    return mast.build()


RESPONSES = {
    "planar": lambda: da.frequency_response(carts(), outputs=["m0.x", "m1.x"]),
    "spatial": lambda: da.frequency_response(plate(), outputs=["hinge.angle"]),
    "structure": lambda: da.frequency_response(mast(), outputs=["n4.ux"], loss_factor=0.02),
    "random": lambda: da.RandomResponse(psd={"push": 1.0}, outputs=["m0.x"]).run(carts()),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("name", RESPONSES)
def test_the_page_shows_the_highest_peak(name: str, show: Any) -> None:
    response = RESPONSES[name]()
    page = show(response)
    output = next(iter(response.outputs))
    frequency, height = max(response.peaks(output), key=lambda peak: peak[1])
    text = page.page.locator(".readout").last.inner_text()
    assert float(text.split(" Hz")[0]) == pytest.approx(frequency, rel=1e-3)
    assert height > 0
    assert page.page.locator("section.beside section, .beside .panel").count() >= 2
    chosen = page.page.locator("#case").input_value()
    assert int(chosen) == page.js("dalembert.motion.chosen")


@pytest.mark.thorough
def test_a_click_chooses_a_frequency(show: Any) -> None:
    page = show(RESPONSES["planar"]())
    chart = page.page.locator("svg.chart").first
    box = chart.bounding_box()
    seen = set()
    for share in (0.2, 0.5, 0.9):
        page.page.mouse.click(box["x"] + share * box["width"], box["y"] + 80)
        page.frames()
        seen.add(page.js("dalembert.motion.chosen"))
    assert len(seen) == 3
    page.page.keyboard.press("ArrowLeft")
    assert page.js("dalembert.motion.chosen") == max(seen) - 1


def test_small_values_keep_their_digits() -> None:
    """Amplitudes over eleven decades and densities over many more, after packing."""
    response = da.RandomResponse(psd={"push": 1.0}, outputs=["m0.x"], span=(0.01, 1e4)).run(carts())
    exact = response.page()["views"]
    shown = unpack(pack(response.page()))["views"]
    for before, after in zip(exact, shown, strict=True):
        np.testing.assert_allclose(
            10 ** np.asarray(after["x"], float), 10 ** before["x"], rtol=5e-5
        )
        (one,), (other,) = before["lines"], after["lines"]
        assert np.ptp(one["level"]) > 10
        level, wanted = (np.asarray(line["level"], dtype=float) for line in (other, one))
        np.testing.assert_allclose(10**level, 10**wanted, rtol=5e-4)


def test_shapes_have_the_phases_of_the_motion() -> None:
    """At each drawn frequency the parts move like the complex amplitudes."""
    response = RESPONSES["planar"]()
    payload = response.page()
    states = payload["views"][0]["states"]
    lines = payload["views"][0]["lines"]
    first, second = (np.reshape(body["x"], (6, -1)) for body in payload["scene"]["bodies"][:2])
    shapes = [body[1] + 1j * body[2] for body in (first, second)]
    amplitudes = [
        10 ** np.array(line["level"]) * np.exp(1j * np.array(line["phase"])) for line in lines
    ]
    ratio = amplitudes[0][states] / amplitudes[1][states]
    np.testing.assert_allclose(shapes[0] / shapes[1], ratio, rtol=1e-6)
