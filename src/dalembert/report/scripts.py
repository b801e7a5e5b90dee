"""Scripts of the pages: modules joined into one scope, in the order of their imports.

Modules use named imports of other files of this folder, and exports of declarations. The page has
neither imports nor comments; names at the top level are unique among the modules of a page.
"""

from __future__ import annotations

import re
from functools import cache
from importlib import resources
from typing import Any

PAGES = {
    "mechanism": "planar_mechanism.js",
    "spatial mechanism": "spatial_mechanism.js",
    "modes": "planar_modes.js",
    "spatial modes": "spatial_modes.js",
    "structure": "planar_structure.js",
    "spatial structure": "spatial_structure.js",
    "decision": "decision.js",
    "live mechanism": "live_planar.js",
    "live spatial mechanism": "live_spatial.js",
    "live modes": "live_planar_modes.js",
    "live spatial modes": "live_spatial_modes.js",
    "live structure": "live_planar_structure.js",
    "live spatial structure": "live_spatial_structure.js",
}
"""Kind of page, and its dimension → main module."""
CHARTS = {
    "bars": "distributions.js",
    "histogram": "distributions.js",
    "ellipses": "distributions.js",
    "bode": "frequency.js",
    "nyquist": "frequency.js",
}
"""Kind of a view → module of its chart, which only pages with such views contain."""
RUNS = {
    "dynamics": ("live_run.js", "LiveRun"),
    "kinematics": ("live_kinematics.js", "LiveKinematics"),
    "equilibrium": ("live_equilibrium.js", "LiveEquilibrium"),
    "modes": ("live_modes.js", "LiveModes"),
    "frequency": ("live_frequency.js", "LiveFrequency"),
    "structure frequency": ("live_structure_frequency.js", "LiveStructureFrequency"),
    "statics": ("live_structures.js", "LiveStatics"),
    "vibration": ("live_structures.js", "LiveVibration"),
}
"""Kind of an analysis → module and class of its runs."""
KINDS = ("mechanism", "spatial", "structure", "decision")
"""Kinds of payloads."""

IMPORT = re.compile(r'^import (?:\{[^}]*\} from )?"\./([\w/.]+)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=const|let|class|function|async)", re.MULTILINE)
COMMENT = re.compile(
    r"^ */\*\*(?:(?!\*/).)*\*/\n|^ *// [^\n]*\n|/\*\* .*? \*/ ?", re.MULTILINE | re.DOTALL
)


def asset(name: str) -> str:
    """Text of a file of the pages."""
    return (resources.files(__package__) / "assets" / name).read_text(encoding="utf-8")


def page_kind(payload: dict[str, Any]) -> str:
    """Kind of the page of a payload; that of a spatial scene has three dimensions."""
    kind = payload.get("kind", "mechanism")
    live = "live " if "code" in payload.get("live", {}) else ""
    if kind in ("mechanism", "spatial"):
        part = "modes" if "states" in payload else "mechanism"
        return f"{live}spatial {part}" if kind == "spatial" else f"{live}{part}"
    spatial = kind == "structure" and payload["scene"].get("dimension") == 3
    return f"{live}spatial {kind}" if spatial else f"{live}{kind}"


def page_charts(payload: dict[str, Any]) -> tuple[str, ...]:
    """Modules of charts that the views of a payload need besides those of every page."""
    kinds = {view.get("kind") for view in payload.get("views", ())}
    return tuple(sorted({module for kind, module in CHARTS.items() if kind in kinds}))


@cache
def page_script(kind: str, charts: tuple[str, ...] = ()) -> str:
    """Script of a kind of page, with modules of further charts before the page is built."""
    return joined(*charts, PAGES[kind])


@cache
def worker_script(kind: str) -> str:
    """Script of the worker of a live page, by kind of its analysis."""
    module, run = RUNS[kind]
    return f"{joined('live_worker.js', module)}\nserve({run});\n"


def joined(*names: str) -> str:
    """Modules and those that they import, as one scope."""
    scripts: dict[str, str] = {}
    for name in names:
        _collect(name, scripts)
    return "\n".join(scripts.values())


def _collect(name: str, scripts: dict[str, str]) -> None:
    """Add a module after the modules that it imports."""
    text = asset(name)
    if not name.startswith("vendor/"):
        for imported in IMPORT.findall(text):
            if imported not in scripts:
                _collect(imported, scripts)
        for pattern in (IMPORT, EXPORT, COMMENT):
            text = pattern.sub("", text)
    scripts.setdefault(name, text)
