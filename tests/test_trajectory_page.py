"""Pages of trajectories, of mechanisms found and of reliable optima in a browser."""

from __future__ import annotations

import pytest
from browser import browser, show  # noqa: F401
from test_decision_files import ROD, written
from test_reliable_files import RELIABLE
from test_synthesis_files import ANGLES, OWN, filled
from test_trajectory_files import BLOCK

import dalembert as da
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.designs import make_design
from dalembert.io.decisions.synthesis import make_synthesis
from dalembert.io.decisions.trajectories import make_trajectory
from dalembert.io.model_file import load_model_file


def drawn(page, decision) -> None:
    """Every view, on a screen and on paper."""
    assert page.page.locator("section[id^=view-]").count() == len(decision.views())
    assert page.js("[...document.querySelectorAll('svg.chart')].every(s => s.children.length)")
    page.js("window.dispatchEvent(new Event('beforeprint'))")
    page.js("window.dispatchEvent(new Event('afterprint'))")


def test_a_trajectory_beside_its_beginning(show, tmp_path):  # noqa: F811
    file = load_model_file(written(tmp_path, BLOCK))
    model = file.model()
    best = da.optimize_trajectory(model, **make_trajectory(file, model))
    page = show(best, still=True)
    drawn(page, best)
    before = page.picture("#scene")
    assert "Initial position" in page.page.inner_text("#ghosts")
    page.page.click("#ghosts")
    page.frames(3)
    assert page.picture("#scene") != before


@pytest.mark.thorough
def test_a_mechanism_found_and_a_reliable_optimum(show, tmp_path):  # noqa: F811
    text = filled(OWN, angles=ANGLES, outputs=0.1 * ANGLES)
    computed = make_synthesis(load_model_file(written(tmp_path, text)))(progress=False)
    drawn(show(computed), computed)
    file = load_model_file(written(tmp_path, ROD + RELIABLE))
    model = file.model()
    design = make_design(file, model)
    best = da.optimize_reliable(model, **design, analysis=make_analysis(file, model))
    page = show(best)
    drawn(page, best)
    assert "worst points" in page.page.inner_text("#panels").lower()
