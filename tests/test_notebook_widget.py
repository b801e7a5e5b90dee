"""Widget of notebooks: sliders of its page and parameters in Python stay in step."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Visit, browser  # noqa: F401

import dalembert as da
from dalembert import planar
from dalembert.report.scripts import asset

SHIM = """async ([esm, state]) => {
    const listeners = {};
    const model = {
        state, saved: [], get: (key) => state[key], set: (key, value) => { state[key] = value; },
        save_changes() { this.saved.push(structuredClone(state.parameters)); },
        on: (event, act) => { (listeners[event] ??= []).push(act); },
        off: (event, act) => { listeners[event] = listeners[event].filter((a) => a !== act); },
        from_python(parameters) {
            state.parameters = parameters;
            for (const act of listeners["change:parameters"] ?? []) act();
        },
    };
    const file = new Blob([esm], { type: "text/javascript" });
    const widget = (await import(URL.createObjectURL(file))).default;
    window.model = model;
    window.end = widget.render({ model, el: document.body });
}"""
"""The least of a notebook: a model with state, and the element of an output."""


def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0, -9.81))
    length = system.parameter("l", 500, "mm", bounds=(300, 800))
    mass = system.parameter("m", 1.0, "kg")
    bar = system.add(planar.Bar("bar", length=length, mass=mass))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    return system.build()


def test_the_error_without_the_package_names_the_remedy(monkeypatch: Any) -> None:
    from dalembert.analysis import explore

    explore._widget_class.cache_clear()
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(da.UnsupportedError, match=r"pip install 'dalembert\[notebook\]'"):
        pendulum().explore()


def test_parameters_and_results_in_python() -> None:
    pytest.importorskip("anywidget")
    model = pendulum()
    widget = model.explore()
    assert widget.parameters == {"l": 0.5, "m": 1.0}
    first = widget.motion
    assert widget.result is first and first.time[-1] == 3.0
    seen: list[dict[str, float]] = []
    widget.on_change(seen.append)
    widget.parameters = {"l": "400 mm"}
    assert seen == [{"l": 0.4, "m": 1.0}] == [widget.parameters]
    expected = da.solve_dynamics(model, 3.0, outputs=151, parameters={"l": 0.4})
    np.testing.assert_allclose(widget.motion["bar.angle"], expected["bar.angle"], rtol=1e-9)
    assert widget.motion is widget.motion is not first
    for wrong, message in (({"x": 1}, "unknown parameter"), ({"l": None}, "a number")):
        with pytest.raises(da.ModelError, match=message):
            widget.parameters = wrong
    with pytest.raises(da.ModelError, match="finite"):
        widget.parameters = {"l": float("nan")}
    for outside in (0.29, 2.0, "2 m"):  # the slider would show another design than the result
        with pytest.raises(da.ModelError, match=r"l: .* outside the bounds 0\.3 to 0\.8"):
            widget.parameters = {"l": outside}
    assert widget.parameters == {"l": 0.4, "m": 1.0}
    widget.parameters = {"l": 0.8 + 1e-10}  # of a page, whose bounds are rounded
    assert widget.parameters["l"] == 0.8
    chosen = model.explore(da.Dynamics(duration=0.5, step=0.01), height=300)
    assert chosen.height == 300 and chosen.motion.time[-1] == 0.5


def test_two_widgets_of_one_model_are_independent() -> None:
    """Also with numbers of NumPy, and after a function of ``on_change`` that fails."""
    pytest.importorskip("anywidget")
    model = pendulum()
    analysis = da.Dynamics(duration=0.1, step=0.01)
    one, two = model.explore(analysis), model.explore(analysis)
    for k, kind in enumerate((np.float32, np.float64, np.int64, int, float) * 20):
        one.parameters = {"m": kind(k + 1)}
    assert one.parameters == {"l": 0.5, "m": 100.0} and two.parameters == {"l": 0.5, "m": 1.0}
    assert one.result.parameters[1] == 100.0 and two.result.parameters[1] == 1.0

    def fails(values: dict[str, float]) -> None:
        raise RuntimeError("by the user")

    two.on_change(fails)
    with pytest.raises(RuntimeError, match="by the user"):
        two.parameters = {"l": 0.4}
    assert two.parameters["l"] == 0.4 == two.result.parameters[0]
    assert one.parameters["l"] == 0.5


@pytest.mark.thorough
def test_sliders_and_parameters_follow_each_other(browser: Any) -> None:  # noqa: F811
    pytest.importorskip("anywidget")
    widget = pendulum().explore(da.Dynamics(duration=0.5, step=0.01))
    page = browser.new_page()
    visit = Visit(page)
    page.on("pageerror", lambda error: visit.errors.append(str(error)))
    page.goto("about:blank")
    state = {key: getattr(widget, key) for key in ("page", "height", "parameters")}
    page.evaluate(SHIM, [asset("notebook/widget.js"), state])
    design = "document.querySelector('iframe').contentWindow.dalembert?.design"
    visit.until(design, 60)
    page.wait_for_timeout(150)
    visit.js(f"{design}.set({design}.parameters.findIndex((p) => p.name === 'l'), 0.625)")
    visit.until("window.model.saved.length === 1", 10)
    assert visit.js("window.model.saved[0]") == {"l": 0.625, "m": 1.0}
    widget.parameters = visit.js("window.model.saved[0]")
    assert widget.motion.parameters[0] == 0.625
    visit.js("window.model.from_python({ l: 0.4, m: 1 })")
    visit.until(f"{design}.values.includes(0.4)", 10)
    page.wait_for_timeout(200)
    assert visit.js("window.model.saved.length") == 1  # not sent back
    visit.js("window.end()")
    page.close()


@pytest.mark.thorough
def test_a_notebook_runs_it(tmp_path: Path) -> None:
    pytest.importorskip("anywidget")
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    folder = str(Path(__file__).parent)
    cells = [
        f"import sys; sys.path.insert(0, {folder!r})\n"
        "from test_notebook_widget import pendulum\nwidget = pendulum().explore()\nwidget",
        "widget.parameters = {'l': 0.4}\nround(float(widget.motion.parameters[0]), 3)",
    ]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in cells])
    done = nbclient.NotebookClient(notebook, timeout=120).execute()
    kinds = [set(output.data) for output in done.cells[0].outputs if "data" in output]
    assert any("application/vnd.jupyter.widget-view+json" in kind for kind in kinds)
    assert done.cells[1].outputs[0].data["text/plain"] == "0.4"
