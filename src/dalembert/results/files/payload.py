"""What the report shows, as plain data: drawing, series, diagnosis, statistics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.files.headings import checked_units, chosen_units
from dalembert.results.files.page_parts import diagnosis, parameter_rows, statistics
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.scene import is_spatial, motion_scene
from dalembert.results.series import measured_series
from dalembert.units.unit import shown_in

MAX_FRAMES = 20_000
MAX_NUMBERS = 6_000_000
"""Of all series of a page together; of a large mechanism fewer instants are shown."""
LEAST_FRAMES = 2000
ROUNDED = 1e-14
"""Part of the largest value of a unit that is round-off."""


def report_payload(
    motion: LabelledRecording,
    plots: Sequence[Sequence[str]] | None,
    trace: Sequence[str] | None,
    units: Sequence[str] = (),
) -> dict[str, Any]:
    """Everything the page needs, thinned to at most ``MAX_FRAMES`` instants, fewer where many move.

    Parameters
    ----------
    plots : groups of series names, one plot each; a sensible choice if None
    trace : names of points, or of bodies for their origins, whose paths are drawn from the start
    units : that plots show, each for what has its dimension
    """
    count = motion.time.size
    keep = np.unique(np.linspace(0, count - 1, min(count, _frames(motion))).round().astype(int))
    series = measured_series(motion, keep)
    names = {s["name"] for s in series}
    for name in dict.fromkeys(n for group in plots or () for n in group if n not in names):
        series.append(_asked(motion, name, keep))
        names.add(name)
    _without_rounding(series)
    for one in series if units else ():
        factor, one["unit"] = shown_in(str(one["unit"]), checked_units(units))
        one["values"] = one["values"] / factor
    wanted = [list(group) for group in plots] if plots else None
    payload = {
        "format": 1,
        "kind": "spatial" if is_spatial(motion.model) else "mechanism",
        "title": motion.model.name,
        "subtitle": _subtitle(motion),
        "time": motion.time[keep].tolist() if count else [],
        "scene": motion_scene(motion, keep),
        "series": series,
        "default_plots": [g for g in wanted if g] if wanted else _default_plots(motion, names),
        "events": [event.row for event in motion.events],
        "diagnosis": _diagnosis(motion),
        "statistics": _statistics(motion),
        "parameters": parameter_rows(motion.model.parameters, motion.parameters, units),
        "units": chosen_units({"m", "rad", "N", "N m"}, units),
    }
    if trace is not None:
        _add_origins(payload["scene"], motion.model, trace)
        payload["trace"] = list(trace)
        payload["scene"]["points"].sort(key=lambda point: point["name"] not in trace)
    return payload


def _without_rounding(series: list[dict[str, Any]]) -> None:
    """Values that are round-off beside the largest one of their unit are zero; errors are kept."""
    largest: dict[str, float] = {}
    errors = ("violation", "_error")
    shown = [one for one in series if not one["name"].endswith(errors)]
    for one in shown:
        size = np.abs(one["values"][np.isfinite(one["values"])]).max(initial=0.0)
        largest[one["unit"]] = max(largest.get(one["unit"], 0.0), float(size))
    for one in shown:
        small = np.abs(one["values"]) < ROUNDED * largest[one["unit"]]
        one["values"] = np.where(small, 0.0, one["values"])


def _add_origins(scene: dict[str, Any], model: Any, trace: Sequence[str]) -> None:
    """Points of bodies that a trace names by the body alone: their origins."""
    known = {point["name"] for point in scene["points"]}
    dimension = 3 if is_spatial(model) else 2
    for body in model.bodies:
        if body.name in trace and body.name not in known:
            place = {"body": body.name, "point": [0.0] * dimension}
            scene["points"].append({"name": body.name, **place})


def _frames(motion: LabelledRecording) -> int:
    """How many instants a page shows at most."""
    numbers = sum(values.size for _, values, _ in motion.contents.variables.values())
    columns = numbers / max(1, motion.time.size)
    return int(np.clip(MAX_NUMBERS / max(1.0, columns), LEAST_FRAMES, MAX_FRAMES))


def _subtitle(motion: LabelledRecording) -> str:
    choices = ("integrator", "formulation", "stabilization", "coordinates")
    used = [str(motion.statistics[k]) for k in choices if k in motion.statistics]
    told = " + ".join(u for u in used if u != "AbsoluteCoordinates")
    return ", ".join([motion.analysis.spoken, told]).rstrip(", ")


def _asked(motion: LabelledRecording, name: str, keep: np.ndarray) -> dict[str, Any]:
    """A measure or formula that is not among the usual series.

    Raises
    ------
    AnalysisError
        It is a vector.
    """
    measure = motion[name]
    if measure.ndim != 1:
        raise AnalysisError(
            f"plot {name!r}: the measure has {measure.shape[1]} components; take one"
        )
    return {
        "name": name,
        "unit": str(measure.attrs.get("units", "")),
        "group": "formulas",
        "values": measure.values[keep],
    }


def _default_plots(motion: LabelledRecording, names: set[str]) -> list[list[str]]:
    diagnosis = motion.model.diagnosis
    angles = [f"{b.name}.angle" for b in motion.model.bodies]
    turning = [f"{b}.angular_velocity.{axis}" for b in diagnosis.bodies[:1] for axis in "xyz"]
    places = [f"{b}.{c}" for b in diagnosis.bodies[:2] for c in "xyz"]
    choices = ([n for n in some if n in names][:4] for some in (angles, turning, places))
    angles = next((some for some in choices if some), [])
    plots = [angles]
    efforts = [f"{d}.effort" for d in diagnosis.drivers if f"{d}.effort" in names]
    reactions = [f"{j}.force_norm" for j in diagnosis.joints[:4] if f"{j}.force_norm" in names]
    if efforts:
        plots.append(efforts[:2])
    if reactions:
        plots.append(reactions)
    if motion.analysis.integrates:
        plots.append([e for e in ("kinetic_energy", "potential_energy", "energy") if e in names])
    return plots


def _diagnosis(motion: LabelledRecording) -> dict[str, Any]:
    d = motion.model.diagnosis
    items = [
        ("degrees of freedom", d.degrees_of_freedom),
        ("Grübler's count", d.gruebler),
        ("bodies", len(d.bodies)),
        ("joints", len(d.joints)),
        ("drivers", len(d.drivers)),
        ("joint equations", d.joint_equations),
        ("redundant equations", len(d.redundancies)),
        ("loops", "; ".join("–".join(loop) for loop in d.topology.loops) or "none"),
    ]
    doubts = [("warning", text) for text in motion.warnings]
    return diagnosis(d.summary, items, [*doubts, *d.messages], motion.status)


def _statistics(motion: LabelledRecording) -> list[dict[str, str]]:
    rows = [("status", motion.status.outcome.value), *motion.statistics.items()]
    data = motion.contents
    for name, label in (
        ("position_violation", "largest position violation"),
        ("velocity_violation", "largest velocity violation"),
    ):
        if data[name].size:
            rows.append((label, f"{float(data[name].max()):.3g}"))
    if (estimate := motion.error_estimate) is not None:
        rows.append((f"estimated error, in {estimate.name}", f"{estimate.share:.2g}"))
    error = np.abs(data["balance_error"])
    if error.size and np.isfinite(error).all():
        rows.append(("largest energy balance error [J]", f"{error.max():.3g}"))
    return statistics(rows)
