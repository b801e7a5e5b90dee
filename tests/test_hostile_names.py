"""Names on pages of every kind: markup stays text, long names and other directions do no harm."""

from __future__ import annotations

import json
from typing import Any

import pytest
from browser import browser, show  # noqa: F401
from test_decision_files import ROD, SYNTHESIS, TASKS, written
from test_report_page import HOSTILE, data_of
from test_spatial_page import SMALL, joints
from test_structure_page import solved

import dalembert as da
from dalembert import planar
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.synthesis import make_synthesis
from dalembert.io.model_file import load_model_file

FIXED = set(
    "kind symbol role better place directions kind_of_state data code "
    "columns numbers states".split()
)
"""Keys of words that the program chooses itself, as are the names of fields of a structure."""
NAMES = {
    "markup": lambda text: HOSTILE + text,
    "long": lambda text: "\u0639\u202e\u2067" + "W" * 200 + text,
}

WIDE = """[...document.querySelectorAll("body *")].filter(e => {
    for (let p = e.parentElement; p; p = p.parentElement) {
        if (getComputedStyle(p).overflowX !== "visible") return false;
    }
    const box = e.getBoundingClientRect();
    return box.width && box.right > innerWidth + 1;
}).slice(0, 6).map(e => `${e.parentElement.id} ${e.tagName} ${e.textContent.slice(-30)}`)"""
"""Elements beyond the right edge of the window, in no part that clips or scrolls."""


def renamed(data: Any, name: Any, key: str = "") -> Any:
    """The same data with every free text changed, in the same way where it is the same."""
    if isinstance(data, dict):
        return {k: renamed(v, name, k) for k, v in data.items()}
    if isinstance(data, list):
        return [renamed(v, name, key) for v in data]
    if key == "exact":  # of live pages: JSON of its own
        return json.dumps(renamed(json.loads(data), name))
    free = isinstance(data, str) and key not in FIXED and data not in ("", "ground")
    return name(data) if free else data


def shaft() -> da.Motion:
    system = da.System("shaft", gravity=(0, -9.81))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, 2.0))
    bar = system.add(planar.Bar("bar", length=length, mass=1.0))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), bar.start))
    model = system.build()
    return da.solve_dynamics(model, 0.2, step=0.02)


def decision(task: str, folder: Any) -> Any:
    text = SYNTHESIS if task == "synthesize" else ROD + TASKS[task]
    file = load_model_file(written(folder, text))
    if task == "synthesize":
        return make_synthesis(file)(progress=False)
    model = file.model()
    stress, mass = da.final("rod.stress"), da.final("mass")
    return da.pareto(model, [stress, mass], analysis=make_analysis(file, model), points=3)


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", ["planar", "spatial", "structure", "pareto", "synthesize"])
def test_names_stay_text(kind, show, tmp_path):  # noqa: F811
    results = {"planar": shaft, "spatial": joints, "structure": lambda: solved("plate")}
    result = results[kind]() if kind in results else decision(kind, tmp_path)
    page = data_of(result.report(tmp_path / "page.html").read_text(encoding="utf-8"))
    for name in NAMES.values():
        hostile = renamed(page, name)
        hostile["title"] = name(page["title"]) * 40
        view = show(hostile, viewport=SMALL)
        view.frames(2)
        assert view.js("document.querySelectorAll('#bad, img').length") == 0
        assert view.js("document.title.length") > 1000
        wide = view.js(WIDE)
        assert not wide, "\n".join(wide)
