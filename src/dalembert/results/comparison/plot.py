"""Pictures of a comparison: what accuracy, small violations and true energy cost in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.comparison.lines import (
    draw_lines,
    explain,
    floor,
    logarithmic,
    looks_of,
    make_room,
    name_colours,
    plain_ticks,
)
from dalembert.results.comparison.table import brief

if TYPE_CHECKING:
    import pandas as pd

    from dalembert.results.comparison.data import ComparisonData

CROWD = 2
"""More line styles than this are hard to tell apart."""
EFFORT = "integration time of the run [ms]"


@dataclass(frozen=True)
class Kind:
    """A picture: what its panels show, and which choices are told by colour, line and marker."""

    panels: tuple[tuple[str, str], ...]
    order: tuple[str, str, str, str]
    title: str


KINDS = {
    "work-precision": Kind(
        (("error_position", "error of {measure}"),),
        ("integrator", "formulation", "stabilization", "coordinates"),
        "accuracy against effort",
    ),
    "violations": Kind(
        (
            ("position_violation", "violation of the constraints [m or rad]"),
            ("velocity_violation", "violation of their rates [m/s or rad/s]"),
        ),
        ("stabilization", "integrator", "formulation", "coordinates"),
        "largest violation against effort",
    ),
    "energy": Kind(
        (("energy_error", "energy error / largest kinetic energy"),),
        ("integrator", "formulation", "stabilization", "coordinates"),
        "energy balance against effort",
    ),
}


def plot_comparison(comparison: ComparisonData, kind: str, ax: Any = None) -> Any:
    """Draw one of ``KINDS``; returns the axes, an array of them where there are several."""
    if kind not in KINDS:
        raise AnalysisError(f"no picture {kind!r}; known: {', '.join(KINDS)}")
    picture = KINDS[kind]
    table = comparison.table()[comparison.finished]
    if not len(table):
        raise AnalysisError("nothing to draw: no run finished")
    looks = looks_of(table, picture.order)
    several = len(looks[1][1]) > CROWD and len(picture.panels) == 1 and ax is None
    draw = _small_multiples if several else _together
    axes = draw(comparison, table, picture, looks, ax)
    return axes[0] if axes.size == 1 else axes


def _together(
    comparison: ComparisonData, table: pd.DataFrame, picture: Kind, looks: Any, ax: Any
) -> np.ndarray:
    """All lines in one pair of axes per quantity."""
    import matplotlib.pyplot as plt

    count, own = len(picture.panels), ax is None
    if own:
        size = (8.2 if count == 1 else 11, 4.9)
        _, ax = plt.subplots(1, count, figsize=size, layout="constrained")
    axes = np.atleast_1d(np.asarray(ax, dtype=object)).ravel()
    for panel, (column, text) in zip(axes, picture.panels, strict=True):
        draw_lines(panel, table, column, looks)
        logarithmic(panel)
        panel.set_xlabel(EFFORT)
        panel.set_ylabel(text.format(measure=_measured(comparison)))
        make_room(panel, table, [looks[0][0]])
        plain_ticks(panel)
        if column == "error_position":
            floor(panel, comparison.uncertainty, named=True)
        name_colours(panel, table, column, looks[0])
    explain(axes[-1], looks[1:])
    if not own:
        axes[0].set_title(picture.title, loc="left")
        return axes
    axes[0].set_title(_title(comparison, picture), loc="left", size=11, weight="bold", pad=20)
    note = axes[0].annotate(
        _shared(comparison),
        (0, 1),
        xycoords="axes fraction",
        xytext=(0, 6),
        textcoords="offset points",
        size=8.5,
        color="0.35",
    )
    note.set_in_layout(False)
    return axes


def _small_multiples(
    comparison: ComparisonData, table: pd.DataFrame, picture: Kind, looks: Any, _: Any
) -> Any:
    """One panel per value of the second choice, the lines of the others in grey behind."""
    import matplotlib.pyplot as plt

    (column, text), (name, values) = picture.panels[0], looks[1]
    across = 3 if len(values) != 4 else 2
    down = -(-len(values) // across)
    figure, axes = plt.subplots(
        down,
        across,
        figsize=(3.7 * across, 2.9 * down + 0.6),
        sharex=True,
        sharey=True,
        layout="constrained",
        squeeze=False,
    )
    shown, spare = axes.ravel()[: len(values)], axes.ravel()[len(values) :]
    inner = [looks[0], (name, dict.fromkeys(values, "-")), *looks[2:]]
    for panel, value in zip(shown, values, strict=True):
        others = table[name] != value
        draw_lines(panel, table[others], column, inner, behind=True)
        draw_lines(panel, table[~others], column, inner)
        logarithmic(panel)
        panel.set_title(value, loc="left", size=10, weight="bold")
        panel.tick_params(labelbottom=True)
    for panel in spare:
        panel.set_visible(False)
    make_room(shown[0], table, [looks[0][0], name])
    for panel, value in zip(shown, values, strict=True):
        plain_ticks(panel)
        if column == "error_position":
            floor(panel, comparison.uncertainty, named=panel is shown[0])
        name_colours(panel, table[table[name] == value], column, looks[0])
    explain(shown[-1], [(name, {}), *looks[2:]])
    figure.supxlabel(EFFORT, size=10)
    figure.supylabel(text.format(measure=_measured(comparison)), size=10)
    title = f"{_title(comparison, picture)}\n{_shared(comparison)}"
    figure.suptitle(title, x=0.01, ha="left", size=10)
    return shown


def _title(comparison: ComparisonData, picture: Kind) -> str:
    a = comparison.data.attrs
    return f"{a['model']}, {a['start']:g}…{a['end']:g} s: {picture.title}"


def _measured(comparison: ComparisonData) -> str:
    a = comparison.data.attrs
    return f"{a['measure']} [{a['measure_unit']}]" if a["measure_unit"] else str(a["measure"])


def _shared(comparison: ComparisonData) -> str:
    """Second line of the title: what all lines share, and what the markers are."""
    data = comparison.data
    names = [
        str(data[name].values[0])
        for name in ("integrator", "formulation", "coordinates", "stabilization")
        if len(set(data[name].values)) == 1
    ]
    steps, tolerances = (np.unique(data[n].dropna("run")) for n in ("step", "tolerance"))
    swept = [f"step ({steps[-1]:g}…{steps[0]:g} s)"] if steps.size > 1 else []
    if tolerances.size > 1:
        swept.append(f"tolerance ({brief(tolerances[-1])}…{brief(tolerances[0])})")
    if swept:
        names.append(f"one marker per {' or '.join(swept)}")
    return ", ".join(names)
