"""Labelled arrays, tables and summaries of harmonic responses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.results.files.contents import Contents

if TYPE_CHECKING:
    import pandas as pd


def harmonic_contents(response: Any) -> Contents:
    """Amplitude, phase and parts of the outputs by inputs over the frequency."""
    along, h = ("frequency", "output", "input"), response.table
    units = ", ".join(dict.fromkeys(m.unit or "1" for m in response.outputs.values()))
    variables = {
        "amplitude": (along, np.abs(h), {"units": units, "long_name": "amplitude"}),
        "phase": (along, np.angle(h), {"units": "rad", "long_name": "phase"}),
        "real": (along, h.real, {"units": units, "long_name": "real part"}),
        "imag": (along, h.imag, {"units": units, "long_name": "imaginary part"}),
    }
    coordinates = {
        "frequency": (("frequency",), response.frequencies, {"units": "Hz"}),
        "output": list(response.outputs),
        "input": list(response.inputs),
    }
    return Contents.from_arrays(variables, coordinates, response.attributes)


def harmonic_frame(response: Any) -> pd.DataFrame:
    """Amplitude and phase of each output for each input; units are attributes."""
    import pandas as pd

    columns: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    for o, (name, measure) in enumerate(response.outputs.items()):
        for i, source in enumerate(response.inputs):
            label = name if len(response.inputs) == 1 else f"{name}.{source}"
            columns[f"{label}.amplitude"] = np.abs(response.table[:, o, i])
            columns[f"{label}.phase"] = np.angle(response.table[:, o, i])
            units |= {f"{label}.amplitude": measure.unit, f"{label}.phase": "rad"}
    frame = pd.DataFrame(columns, pd.Index(response.frequencies, name="frequency [Hz]"))
    frame.attrs["units"] = units
    return frame


def harmonic_summary(response: Any) -> dict[str, Any]:
    """Status, and the highest peak of each output by each input."""
    sources = [""] if len(response.inputs) == 1 else list(response.inputs)
    rows: list[dict[str, Any]] = []
    for name, measure in response.outputs.items():
        for source in sources:
            top = max(response.peaks(name, source), key=lambda peak: peak[1], default=None)
            if top is not None:
                row: dict[str, Any] = {"output": name, "input": source or response.inputs[0]}
                row |= {"highest peak": top[1], "unit": measure.unit, "frequency [Hz]": top[0]}
                rows.append(row)
    return {
        "status": str(response.status),
        "residual": response.status.residual,
        "statistics": response.statistics,
        "warnings": list(response.warnings),
        "states": rows,
    }
