"""Bode and Nyquist plots with Matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.results.comparison.lines import COLOURS
from dalembert.results.harmonic_measures import part_name
from dalembert.text.wording import unknown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

KINDS = "bode", "nyquist"


def plot_response(response: Any, outputs: Sequence[str], kind: str, **options: Any) -> Figure:
    """Bode plot, amplitude over phase, or Nyquist plot of outputs for all inputs.

    Raises
    ------
    UnsupportedError
        Another kind of plot.
    """
    import matplotlib.pyplot as plt

    if kind not in KINDS:
        raise UnsupportedError(unknown("kind", kind, KINDS))
    curves = []
    for name in outputs:
        table = response.complex_values(name)
        for k, source in enumerate(response.inputs):
            label = name if len(response.inputs) == 1 else f"{name} by {source}"
            curves.append((label, response.unit_by(name, source), table[:, k]))
    if kind == "nyquist":
        figure, axes = plt.subplots(figsize=(5.2, 5), layout="constrained", **options)
        for k, (label, _, values) in enumerate(curves):
            axes.plot(
                values.real, values.imag, lw=1.6, color=COLOURS[k % len(COLOURS)], label=label
            )
        axes.set_aspect("equal", adjustable="datalim")
        axes.axhline(0, color="0.6", lw=0.7)
        axes.axvline(0, color="0.6", lw=0.7)
        axes.set_xlabel(_label("real part", curves))
        axes.set_ylabel(_label("imaginary part", curves))
        panels = [axes]
    else:
        panels = _bode(plt, response.frequencies, curves, options)
        figure = panels[0].figure
    for axes in panels:
        axes.grid(alpha=0.25, which="major")
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_title(response.model.name, loc="left")
    if len(curves) > 1:
        panels[0].legend(frameon=False, fontsize=8.5)
    return figure  # type: ignore[no-any-return]


def plot_densities(vibration: Any, outputs: Sequence[str], **options: Any) -> Figure:
    """Spectral densities of outputs, with their root mean squares."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 3.8), layout="constrained", **options)
    units = set()
    for k, name in enumerate(outputs):
        measure = vibration.expression(part_name(name, "psd"))
        unit = vibration.output(name).unit
        label = f"{name}, σ = {vibration.rms(name):.4g} {unit}".rstrip()
        colour, densities = COLOURS[k % len(COLOURS)], vibration.values(measure)
        axes.plot(vibration.frequencies, densities, lw=1.6, color=colour, label=label)
        units.add(measure.unit)
    _log_scale(axes)
    axes.set_xscale("log")
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel(f"spectral density [{units.pop()}]" if len(units) == 1 else "spectral density")
    axes.set_title(vibration.model.name, loc="left")
    axes.legend(frameon=False, fontsize=8.5)
    axes.grid(alpha=0.25, which="major")
    axes.spines[["top", "right"]].set_visible(False)
    return figure  # type: ignore[no-any-return]


def _bode(plt: Any, frequencies: np.ndarray, curves: Sequence[Any], options: Any) -> list[Any]:
    sizes = {"height_ratios": [2, 1], "sharex": True}
    _, (top, bottom) = plt.subplots(2, 1, figsize=(7, 5), layout="constrained", **sizes, **options)
    for k, (label, _, values) in enumerate(curves):
        colour = COLOURS[k % len(COLOURS)]
        top.plot(frequencies, np.abs(values), lw=1.6, color=colour, label=label)
        bottom.plot(frequencies, np.degrees(np.unwrap(np.angle(values))), lw=1.6, color=colour)
    _log_scale(top)
    if frequencies.size and frequencies[0] > 0:
        top.set_xscale("log")
    top.set_ylabel(_label("amplitude", curves))
    bottom.set_ylabel("phase [°]")
    bottom.yaxis.set_major_locator(plt.MultipleLocator(90))
    bottom.set_xlabel("frequency [Hz]")
    return [top, bottom]


def _log_scale(axes: Any) -> None:
    """A logarithmic axis where a curve has positive values."""
    if any(np.any(np.asarray(line.get_ydata()) > 0) for line in axes.lines):
        axes.set_yscale("log")


def _label(text: str, curves: Sequence[Any]) -> str:
    units = {unit for _, unit, _ in curves}
    return f"{text} [{units.pop()}]" if len(units) == 1 and units != {""} else text
