"""Payload of the report of a motion: drawing, series, diagnosis and statistics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.elements.stateful import Stateful
from dalembert.errors import AnalysisError
from dalembert.model.graph.parts import element_measures
from dalembert.results.files.tables import (
    checked_units,
    diagnosis,
    parameter_rows,
    preferred_units,
    statistics,
)
from dalembert.results.labelled import DATA_ONLY, LabelledRecording, measured_series
from dalembert.results.pictures.scene import is_spatial, motion_scene
from dalembert.results.result import Result
from dalembert.results.sources import Series
from dalembert.results.status import Warnings
from dalembert.units.unit import shown_in

MAX_FRAMES = 20_000
MAX_NUMBERS = 6_000_000
"""Upper limit of numbers in all series of a page; large mechanisms show fewer instants."""
MIN_FRAMES = 2000
ROUND_OFF = 1e-14
"""Threshold for round-off, relative to the largest value of the unit."""


def report_payload(
    motion: LabelledRecording,
    plots: Sequence[Sequence[str]] | None,
    trace: Sequence[str] | None,
    units: Sequence[str] = (),
) -> dict[str, Any]:
    """Payload of the page, with at most ``MAX_FRAMES`` instants, fewer for large mechanisms.

    Parameters
    ----------
    plots : groups of series names, one plot each; a sensible choice if None
    trace : names of points, or of bodies for their origins, whose paths are drawn initially
    units : preferred units of plots, one per dimension
    """
    count = motion.time.size
    keep = np.unique(np.linspace(0, count - 1, min(count, _frames(motion))).round().astype(int))
    series = measured_series(motion, keep)
    names = {s["name"] for s in series}
    signals = _signals(motion) if motion.analysis.at_rest else []
    series += [_extra_series(motion, name, keep, "signals") for name in signals]
    names.update(signals)
    for name in dict.fromkeys(n for group in plots or () for n in group if n not in names):
        series.append(_extra_series(motion, name, keep))
        names.add(name)
    _without_rounding(series)
    for entry in series if units else ():
        factor, entry["unit"] = shown_in(str(entry["unit"]), checked_units(units))
        entry["values"] = entry["values"] / factor
        entry.source = None if entry.source is None else entry.source / factor
    groups = [list(group) for group in plots] if plots else None
    payload = {
        "format": 1,
        "kind": "spatial" if is_spatial(motion.model) else "mechanism",
        "title": motion.model.name,
        "subtitle": _subtitle(motion),
        "time": motion.time[keep].tolist() if count else [],
        "scene": motion_scene(motion, keep),
        "series": series,
        "default_plots": [g for g in groups if g] if groups else _default_plots(motion, names),
        "events": [event.row for event in motion.events],
        "diagnosis": mechanism_diagnosis(motion),
        "statistics": _statistics(motion),
        "parameters": parameter_rows(motion.model.parameters, motion.parameters, units),
        "units": preferred_units({"m", "rad", "N", "N m"}, units),
    }
    if trace is not None:
        _add_origins(payload["scene"], motion.model, trace)
        payload["trace"] = list(trace)
        payload["scene"]["points"].sort(key=lambda point: point["name"] not in trace)
    return payload


def _without_rounding(series: Sequence[dict[str, Any]]) -> None:
    """Set values at round-off level to zero, except errors and violations."""
    largest: dict[str, float] = {}
    errors = ("violation", "_error")
    physical = [entry for entry in series if not entry["name"].endswith(errors)]
    for entry in physical:
        size = np.abs(entry["values"][np.isfinite(entry["values"])]).max(initial=0.0)
        largest[entry["unit"]] = max(largest.get(entry["unit"], 0.0), float(size))
    for entry in physical:
        small = np.abs(entry["values"]) < ROUND_OFF * largest[entry["unit"]]
        entry["values"] = np.where(small, 0.0, entry["values"])


def _add_origins(scene: dict[str, Any], model: Any, trace: Sequence[str]) -> None:
    """Add the origins of bodies that a trace names."""
    names = {point["name"] for point in scene["points"]}
    dimension = 3 if is_spatial(model) else 2
    for body in model.bodies:
        if body.name in trace and body.name not in names:
            position = {"body": body.name, "point": [0.0] * dimension}
            scene["points"].append({"name": body.name, **position})


def _frames(motion: LabelledRecording) -> int:
    """Upper limit of instants of a page."""
    numbers = sum(values.size for _, values, _ in motion.contents.variables.values())
    columns = numbers / max(1, motion.time.size)
    return int(np.clip(MAX_NUMBERS / max(1.0, columns), MIN_FRAMES, MAX_FRAMES))


def _subtitle(motion: LabelledRecording) -> str:
    choices = ("integrator", "formulation", "stabilization", "coordinates")
    strategies = [str(motion.statistics[k]) for k in choices if k in motion.statistics]
    listed = " + ".join(u for u in strategies if u != "AbsoluteCoordinates")
    return ", ".join([motion.analysis.display_name, listed]).rstrip(", ")


def _signals(motion: LabelledRecording) -> list[str]:
    """Names of the states of first order and of the outputs of blocks."""
    elements = motion.model.parts.elements.values()
    stateful = (element for element in elements if isinstance(element, Stateful))
    return [
        f"{element.name}.{name}"
        for element in stateful
        for name, (sx, _) in element_measures(element, motion.model).items()
        if sx.numel() == 1
    ]


def _extra_series(
    motion: LabelledRecording, name: str, keep: np.ndarray, group: str = "formulas"
) -> Series:
    """Series of a measure or formula that is not among the default ones.

    Raises
    ------
    AnalysisError
        It is a vector.
    """
    if name in DATA_ONLY:
        _, values, attributes = motion.contents.variables[name]
        source, unit = motion.source(name), str(attributes.get("units", ""))
    else:
        expression = motion.expression(name)
        source, values, unit = expression.sx, motion.values(expression), expression.unit
    if values.ndim != 1:
        raise AnalysisError(
            f"plot {name!r}: the measure has {values.shape[1]} components; take one"
        )
    return Series(source, name=name, unit=unit, group=group, values=values[keep])


def _default_plots(motion: LabelledRecording, names: set[str]) -> list[list[str]]:
    diagnosis = motion.model.diagnosis
    angles = [f"{b.name}.angle" for b in motion.model.bodies]
    angular_velocities = [
        f"{b}.angular_velocity.{axis}" for b in diagnosis.bodies[:1] for axis in "xyz"
    ]
    coordinates = [f"{b}.{c}" for b in diagnosis.bodies[:2] for c in "xyz"]
    choices = (
        [n for n in candidates if n in names][:4]
        for candidates in (angles, angular_velocities, coordinates)
    )
    angles = next((candidates for candidates in choices if candidates), [])
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


def mechanism_diagnosis(result: Result, notes: Sequence[tuple[str, str]] = ()) -> dict[str, Any]:
    """Diagnosis of the model of a result, with its warnings, further notes and status."""
    model_diagnosis = result.model.diagnosis
    items = [
        ("degrees of freedom", model_diagnosis.degrees_of_freedom),
        ("Grübler's count", model_diagnosis.gruebler),
        ("bodies", len(model_diagnosis.bodies)),
        ("joints", len(model_diagnosis.joints)),
        ("drivers", len(model_diagnosis.drivers)),
        ("joint equations", model_diagnosis.joint_equations),
        ("redundant equations", len(model_diagnosis.redundancies)),
        ("loops", "; ".join("–".join(loop) for loop in model_diagnosis.topology.loops) or "none"),
    ]
    messages = [*(("warning", text) for text in result.warnings), *notes]
    messages += model_diagnosis.messages
    return diagnosis(model_diagnosis.summary, items, messages, result.status)


def _statistics(motion: LabelledRecording) -> list[dict[str, str]]:
    rows = [("status", motion.status.outcome.value), *motion.statistics.items()]
    data = motion.contents
    for name, label in (
        ("position_violation", "largest position violation"),
        ("velocity_violation", "largest velocity violation"),
    ):
        if data[name].size:
            rows.append((label, f"{float(data[name].max()):.3g}"))
    postponed = isinstance(motion.warnings, Warnings) and motion.warnings.is_postponed
    if not postponed and (estimate := motion.error_estimate) is not None:  # up to two more runs
        of = f", in {estimate.name}" if estimate.name else ""
        rows.append((f"estimated error{of}", f"{estimate.share:.2g}" if of else estimate.text))
    error = np.abs(data["balance_error"])
    if error.size and np.isfinite(error).all():
        rows.append(("largest energy balance error [J]", f"{error.max():.3g}"))
    return statistics(rows)
