"""Live pages of equilibria in a browser: positions, states and slopes as in Python, failures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import visit
from live_visits import SLOPE, SLOPES, VALUES, close, settle

import dalembert as da
from dalembert import planar


def test_an_equilibrium_follows_its_sliders(browser: Any, tmp_path: Path) -> None:
    system = da.System("hanging", gravity=(0.0, -9.81))
    stiffness = system.parameter("k", 400.0, "N/m", bounds=(100, 1000))
    arm = system.add(planar.Bar("arm", length=0.5, mass=2.0))
    system.add(planar.Revolute("O", system.ground.center, arm.start))
    ends = (system.ground.point(0.3, 0.5), arm.end)
    system.add(planar.Spring("S", *ends, stiffness=stiffness, free_length=0.3))
    model = system.build()
    path = da.solve_equilibrium(model).report(tmp_path / "arm.html")
    with visit(browser, path) as found:
        settle(found)
        assert found.page.locator("#live").is_visible()
        anchor = found.js("dalembert.scene.screen([0.3, 0.5])")  # of the spring in the ground
        assert anchor[1] > 0
        labels = "dalembert.table.responses.map(({ label }) => label)"
        assert found.js(labels) == ["arm.angle", "O.force_norm"]
        found.js("dalembert.design.set(0, 700)")
        settle(found)
        again = da.solve_equilibrium(model, parameters={"k": 700.0})
        angle = float(again.values("arm.angle")[0])
        assert found.js("dalembert.table.values[0]") == pytest.approx(angle, rel=1e-9)
        shown = found.page.locator("#values tr", has_text="arm.angle").locator(".right")
        assert float(shown.inner_text()) == pytest.approx(angle, rel=1e-5)
        assert found.js("dalembert.motion.ghosts.length") == 1
        assert "are those of the initial design" in found.page.inner_text(".live-note")
        assert (found.requests, found.console) == ([], [])


@pytest.mark.thorough
def test_an_equilibrium_with_states_follows_its_sliders(browser: Any, tmp_path: Path) -> None:
    """Positions, states and signals with gradients; instability and failure in the page."""
    system = da.System("controlled arm", gravity=(0, -9.81))
    gain = system.parameter("gain", 150.0, "N m", bounds=(0, 4000))
    target = system.parameter("target", 0.4, "rad", bounds=(-1.5, 1.5))
    reach = system.parameter("reach", 0.6, "m", bounds=(0.4, 2.5))
    arm = system.add(planar.Bar("arm", length=0.6, mass=2.0, angle=0.3))
    stay = system.add(planar.Bar("stay", length=0.7, mass=0.5, angle=1.5))
    system.add(planar.Revolute("O", system.ground.center, arm.start))
    system.add(planar.Revolute("A", arm.end, stay.start))
    system.add(planar.PinInSlot("B", system.ground.point(0, reach), stay.end))
    gains = {"proportional": gain, "integral": 60.0, "derivative": 30.0, "filter_time": 0.02}
    control = system.add(da.blocks.PID("control", target, arm.angle, **gains))
    lag = system.add(da.blocks.LowPass("lag", control.output, cutoff=200.0))
    system.add(planar.Torque("motor", arm, lag.output))
    model = system.build()
    path = da.solve_equilibrium(model).report(tmp_path / "arm.html")
    with visit(browser, path) as found:
        settle(found)
        labels = found.js("dalembert.table.responses.map(({ label }) => label)")
        assert labels[:2] == ["arm.angle", "stay.angle"] and "control.integral" in labels
        random = np.random.default_rng(4)
        for _ in range(3):
            values = [random.uniform(a, b) for a, b in ((100, 250), (0.1, 0.7), (0.45, 0.7))]
            named = dict(zip(model.parameters, values, strict=True))
            found.js(f"dalembert.design.replace({values})")
            settle(found)
            again = da.solve_equilibrium(model, parameters=named)
            expected = [float(again.values(label)[0]) for label in labels]
            close(found.js("dalembert.table.values"), expected, VALUES)
            number = labels.index("control.integral")
            slopes = da.sensitivity(again, da.final("control.integral")).values
            close(found.js(SLOPE.format(number)), slopes, SLOPES)
        shown = found.page.locator("#values tr", has_text="control.integral").locator(".right")
        assert float(shown.inner_text()) == pytest.approx(expected[number], rel=1e-4)
        found.js("dalembert.design.replace([4000, 0.4, 0.6])")
        settle(found)
        assert "not stable: 2 motions" in found.page.inner_text(".live-status.warning")
        picture = found.picture("#scene")
        found.js("dalembert.design.replace([150, 0.4, 2.5])")
        settle(found)
        status = found.page.inner_text(".live-status.error")
        assert "Not converged: no equilibrium was found: B stays open by" in status
        assert "last valid design" in status and found.picture("#scene") == picture
        found.js("dalembert.design.replace([150, 0.4, 0.6])")
        settle(found)
        assert found.page.locator(".live-status.error").count() == 0
        assert (found.requests, found.console) == ([], [])
