"""Payload of the report of a harmonic response: curves, and deflection shapes at frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.model.assembled.model import StructuralModel
from dalembert.results.files.payload import mechanism_diagnosis
from dalembert.results.files.tables import parameter_rows, preferred_units, statistics
from dalembert.results.harmonic_measures import part_name
from dalembert.results.pictures.mode_scene import oscillating_scene
from dalembert.results.pictures.scene import is_spatial
from dalembert.results.sources import Column
from dalembert.results.structural.deflection import deflection_shapes
from dalembert.results.structural.payload import structural_payload

UNITS = {"m", "rad", "s", "Hz"}
MOST_SHAPES = 61
"""Upper limit of the frequencies with a drawing."""
MOST_CURVES = 6
"""Upper limit of the curves of a chart."""


def frequency_payload(response: Any, units: Sequence[str] = ()) -> dict[str, Any]:
    """Payload of the page.

    Parameters
    ----------
    response : harmonic response
    units : preferred units of the page, one per dimension
    """
    response = _with_peaks(response)
    states = _states(response)
    views = _views(response, states)
    model = response.model
    if isinstance(model, StructuralModel):
        shown = deflection_shapes(response, states)
        payload = structural_payload(shown, units)
        payload["subtitle"] = response.analysis.display_name
        labels = ("names", "times", "relative", "numbers")
        named = {key: payload["states"][key] for key in labels}
        payload["states"] = {"kind": "frequency"} | named
        return payload | {"views": views, "statistics": _statistics(response)}
    shapes = response.record.oscillations(response.motions[states, :, 0])
    frequencies = response.frequencies[states]
    return {
        "format": 1,
        "kind": "spatial" if is_spatial(model) else "mechanism",
        "title": model.name,
        "subtitle": f"{response.analysis.display_name}, deflection shapes",
        "states": {
            "kind": "frequency",
            "names": [f"{f:.5g} Hz" for f in frequencies],
            "times": [],
            "relative": True,
            "numbers": np.arange(1.0, frequencies.size + 1),
            "unit": "Hz",
            "values": frequencies.tolist(),
        },
        "series": [],
        "scene": oscillating_scene(response, shapes),
        "units": preferred_units(UNITS, units),
        "diagnosis": mechanism_diagnosis(response, []),
        "statistics": _statistics(response),
        "parameters": parameter_rows(model.parameters, response.parameters, units),
        "views": views,
    }


def _with_peaks(response: Any) -> Any:
    """The response with frequencies at the peaks of the outputs."""
    sources = [""] if len(response.inputs) == 1 else response.inputs
    pairs = [pair for name in response.outputs for s in sources for pair in response.peaks(name, s)]
    peaks = [f for f, height in pairs if np.isfinite(height)]
    missing = np.setdiff1d(peaks, response.frequencies)
    if not missing.size:
        return response
    return response.at(np.union1d(response.frequencies, missing))


def _states(response: Any) -> np.ndarray:
    """Numbers of the drawn frequencies: the peaks, and others evenly among the frequencies."""
    f = response.frequencies
    sources = [""] if len(response.inputs) == 1 else response.inputs
    peaks = [p for name in response.outputs for s in sources for p, _ in response.peaks(name, s)]
    places = np.searchsorted(f, np.unique(peaks))[:MOST_SHAPES]
    even = np.linspace(0, f.size - 1, max(2, MOST_SHAPES - places.size)).round().astype(int)
    return np.union1d(places[places < f.size], even[: f.size])


def _curves(response: Any) -> list[dict[str, Any]]:
    """Logarithms of amplitudes, and phases, of outputs by inputs; pages round equal steps."""
    lines = []
    for name in response.outputs:
        table = response.complex_values(name)
        for k, source in enumerate(response.inputs):
            single = len(response.inputs) == 1
            label = name if single else f"{name} by {source}"
            columns = {"level": levels(np.abs(table[:, k])), "phase": np.angle(table[:, k])}
            parts = {
                key: Column(columns[key], _formula(response, name, "" if single else source, key))
                for key in columns
            }
            lines.append({"name": label, "unit": response.unit_by(name, source), **parts})
    return lines[:MOST_CURVES]


def _formula(response: Any, output: str, source: str, part: str) -> ca.SX:
    """Formula of the level or the phase of an output."""
    if part == "phase":
        return ca.SX(response.expression(part_name(output, "phase", source)).sx)
    return ca.log10(response.expression(part_name(output, "amplitude", source)).sx)


def levels(values: np.ndarray) -> np.ndarray:
    """Decimal logarithms; NaN of values that are not positive."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(values > 0, np.log10(values), np.nan)  # type: ignore[no-any-return]


def _views(response: Any, states: np.ndarray) -> list[dict[str, Any]]:
    """Charts over the frequency."""
    lines = _curves(response)
    heights = np.nan_to_num(np.array(lines[0]["level"])[states], nan=-np.inf)
    first = int(np.argmax(heights))
    positive = bool(np.all(response.frequencies > 0))
    x = levels(response.frequencies) if positive else response.frequencies
    common = {"x": x, "log": positive, "states": states, "place": "board", "first": first}
    bode = {"kind": "bode", "title": "Bode plot", "y": _label("amplitude", lines), "lines": lines}
    alike = [line for line in lines if line["unit"] == lines[0]["unit"]]
    nyquist = {"kind": "nyquist", "title": "Nyquist plot", "y": "", "lines": alike}
    views = [common | bode, common | nyquist]
    if densities := [
        {"name": curve["name"], "unit": curve["unit"], "level": levels(curve["values"])}
        for curve in response.density_curves[:MOST_CURVES]
    ]:
        label = _label("spectral density", densities)
        chart = {"kind": "bode", "title": "Spectral densities", "y": label, "lines": densities}
        views.insert(0, common | chart)
    return views


def _label(text: str, lines: Sequence[dict[str, Any]]) -> str:
    units = {line["unit"] for line in lines}
    return f"{text} [{units.pop()}]" if len(units) == 1 and units != {""} else text


def _statistics(response: Any) -> list[dict[str, str]]:
    rows: list[tuple[str, Any]] = [("status", response.status.outcome.value)]
    rows += [("frequencies", response.frequencies.size), ("inputs", ", ".join(response.inputs))]
    for row in response.summary()["states"]:
        unit = f" {row['unit']}".rstrip()
        if "root mean square" in row:
            rows.append((f"RMS of {row['output']}", f"{row['root mean square']:.6g}{unit}"))
        else:
            value = f"{row['highest peak']:.6g}{unit} at {row['frequency [Hz]']:.6g} Hz"
            rows.append((f"highest peak of {row['output']} by {row['input']}", value))
    return statistics([*rows, *response.statistics.items()])
