"""Pages in Firefox: they run from a file, follow their sliders and equal Python."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from firefox import Firefox, firefox
from test_live_page import INITIAL, RESPONSES, four_bar
from test_live_structure_page import truss

import dalembert as da
from dalembert import spatial

READY = (
    "document.documentElement.dataset.live && !dalembert.solver.running && "
    "!dalembert.solver.waiting && dalembert.solver.number >= 2"
)
SLOPES = """dalembert.solver.request({ parameters: dalembert.design.values,
    responses: dalembert.table.responses, gradients: dalembert.table.responses.map((_, k) => k) })
    .then(({ slopes }) => slopes.map((row) => [...row]))"""


@pytest.fixture(scope="module")
def tab() -> Iterator[Firefox]:
    with firefox() as started:
        yield started


def open_live(tab: Firefox, path: Path) -> None:
    tab.console.clear()
    tab.requests.clear()
    tab.open(path)
    tab.until(READY)


def check_values(tab: Firefox, result, responses) -> None:
    values = np.array(tab.js("dalembert.table.values"))
    expected = np.array([da.evaluate(result, response) for response in responses])
    assert np.abs(values / expected - 1).max() < 1e-9
    slopes, gradients = np.array(tab.js(SLOPES)), da.sensitivity(result, responses).values
    scale = np.abs(gradients).max(axis=1, keepdims=True)
    assert np.abs((slopes - gradients) / scale).max() < 1e-8


def check_silence(tab: Firefox, path: Path) -> None:
    """Neither requests beyond the file nor messages of the console."""
    own = path.resolve().as_uri()
    assert [url for url in tab.requests if not url.startswith((own, "blob:", "data:"))] == []
    assert tab.console == []


def test_a_motion_follows_its_sliders(tab: Firefox, tmp_path: Path) -> None:
    motion = da.solve_dynamics(four_bar(), 2.0, step=0.004)
    path = motion.report(tmp_path / "live.html", responses=RESPONSES)
    open_live(tab, path)
    changed = INITIAL | {"l1": 0.36, "l2": 1.1, "m": 2.0}
    names = tab.js("dalembert.design.parameters.map(({ name }) => name)")
    tab.js(f"dalembert.design.replace({[changed[name] for name in names]}, 'test') ?? null")
    tab.until(READY)
    check_values(tab, motion.analysis.run(motion.model, changed), RESPONSES)
    check_silence(tab, path)


def top() -> da.Model:
    system = da.System("top", gravity=(0.0, 0.0, -9.81))
    mass = system.parameter("mass", 0.5, "kg", bounds=(0.2, 1.0))
    spin = (0.0, 0.0, 60.0)
    disc = spatial.Cylinder("disc", radius=0.05, length=0.02, mass=mass, angular_velocity=spin)
    system.add(disc)
    foot = disc.point(0.0, 0.0, -0.08)
    system.add(spatial.Spherical("foot", system.ground.point(0, 0, 0), foot))
    return system.build()


@pytest.mark.thorough
def test_a_spatial_motion_is_drawn(tab: Firefox, tmp_path: Path) -> None:
    motion = da.solve_dynamics(top(), 0.5, step=0.002)
    responses = [da.maximum("foot.force_norm"), da.mean("kinetic_energy")]
    path = motion.report(tmp_path / "top.html", responses=responses)
    open_live(tab, path)
    tab.js("dalembert.design.replace([0.8], 'test') ?? null")
    tab.until(READY)
    check_values(tab, motion.analysis.run(motion.model, {"mass": 0.8}), responses)
    check_silence(tab, path)


@pytest.mark.thorough
def test_a_structure_follows_its_sliders(tab: Firefox, tmp_path: Path) -> None:
    result = da.solve_statics(truss())
    responses = [da.at(0, "compliance"), da.maximum("bar0.stress")]
    path = result.report(tmp_path / "truss.html", responses=responses)
    open_live(tab, path)
    values = tab.js("dalembert.design.values")
    tab.js(f"dalembert.design.replace({[1.2 * value for value in values]}, 'test') ?? null")
    tab.until(READY)
    other = {p.name: 1.2 * p.value for p in result.model.parameters.values()}
    check_values(tab, result.analysis.run(result.model, other), responses)
    check_silence(tab, path)
