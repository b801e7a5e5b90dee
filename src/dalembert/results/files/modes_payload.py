"""Payload of the report of modes of a mechanism: drawing, eigenvalues, diagnosis and statistics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.results.files.payload import mechanism_diagnosis
from dalembert.results.files.tables import parameter_rows, preferred_units, statistics
from dalembert.results.modes import Modes
from dalembert.results.pictures.mode_scene import mode_scene
from dalembert.results.pictures.scene import is_spatial
from dalembert.results.sources import Column, Series

MOST_NUMBERS = 1_000_000
"""Upper limit of the numbers of a drawing; higher modes are left out of the page."""
UNITS = ("m", "rad", "s", "Hz", "rad/s", "1/s")
"""Units of a page, without loads."""


def modes_payload(modes: Modes, units: Sequence[str] = ()) -> dict[str, Any]:
    """Payload of the page.

    Parameters
    ----------
    modes : Modes
    units : preferred units of the page, one per dimension
    """
    model = modes.model
    columns = 6 * max(1, model.all_equations.coordinate_count)
    shown = modes.at(modes.numbers[: max(1, MOST_NUMBERS // columns)])
    omitted = modes.numbers.size - shown.numbers.size
    return {
        "format": 1,
        "kind": "spatial" if is_spatial(model) else "mechanism",
        "title": model.name,
        "subtitle": f"{modes.analysis.display_name} of small motions",
        **(_states(shown) if shown.numbers.size else {"time": [float(modes.record.time)]}),
        "scene": mode_scene(shown),
        "units": preferred_units(UNITS, units),
        "diagnosis": mechanism_diagnosis(modes, _note(omitted)),
        "statistics": _statistics(modes),
        "parameters": parameter_rows(model.parameters, modes.parameters, units),
    }


def _states(modes: Modes) -> dict[str, Any]:
    """States and series over the modes."""
    states = {
        "kind": "mode",
        "names": modes.state_names,
        "times": [],
        "relative": True,
        "numbers": modes.time,
        "unit": modes.named[modes.main].unit,
        "values": _column(modes, modes.main),
        "damping": _column(modes, "damping_ratio"),
    }
    return {"states": states, "series": [_series(modes, name) for name in modes.named]}


def _series(modes: Modes, name: str) -> Series:
    expression = modes.expression(name)
    values = modes.values(expression)
    return Series(expression.sx, name=name, unit=expression.unit, group="modes", values=values)


def _column(modes: Modes, name: str) -> Column:
    return Column(modes.values(name).tolist(), modes.expression(name).sx)


def _note(omitted: int) -> list[tuple[str, str]]:
    text = f"{omitted} modes are left out of this page; the result file has them all"
    return [("info", text)] if omitted else []


def _statistics(modes: Modes) -> list[dict[str, str]]:
    rows = [("status", modes.status.outcome.value)]
    rows += [("small motions", "stable" if modes.stable else "not stable")]
    if modes.status.residual is not None and np.isfinite(modes.status.residual):
        rows.append(("residual, relative", f"{modes.status.residual:.3g}"))
    return statistics([*rows, *modes.statistics.items()])
