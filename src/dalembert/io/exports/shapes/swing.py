"""Mechanisms in their modes over a period of the oscillation."""

from __future__ import annotations

import numpy as np

from dalembert.io.exports.shapes.scene import positions
from dalembert.results.labelled import LabelledRecording
from dalembert.results.modes import Modes

SHARE, TURN = 0.1, 0.3
"""Largest movement relative to the mechanism, and largest change of a rotation [rad]."""
PHASES = 33
"""Instants of a period, both ends included."""


def swings(modes: Modes) -> list[tuple[str, LabelledRecording]]:
    """Name of each mode, and the mechanism over a period of its oscillation.

    The period has unit length; the oscillation is that of second order, which keeps joints closed.
    """
    model, blocks = modes.model, modes.record.oscillations(modes.positions)
    phase = np.linspace(0.0, 1.0, PHASES)
    lengths = np.array([unit == "m" for unit in model.guesses.units])
    recordings: list[tuple[str, LabelledRecording]] = []
    for k, name in enumerate(modes.state_names):
        rest, real, imag, *squares = (block[:, k] for block in blocks)
        change = np.hypot(real, imag)
        moved = change[lengths].max(initial=0.0) / (SHARE * (model.scales.length or 1.0))
        turned = change[~lengths].max(initial=0.0) / TURN
        amplitude = 1 / max(moved, turned, 1e-300)
        s, c = (amplitude * f(2 * np.pi * phase)[None, :] for f in (np.sin, np.cos))
        first, mixed, second = (square[:, None] for square in squares)
        y = rest[:, None] + s * real[:, None] + c * imag[:, None]
        y = y + s**2 * first + 2 * s * c * mixed + c**2 * second
        recordings.append((name, positions(model, modes.parameters, phase, y)))
    return recordings
