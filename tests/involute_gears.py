"""Polygons of involute gears."""

from __future__ import annotations

import math

import numpy as np


def involute(angle: float) -> float:
    return math.tan(angle) - angle


def gear_corners(
    teeth: int, chords: int, module: float, pressure: float, clearance: float
) -> list[tuple[float, float]]:
    """Anticlockwise; a tooth is on the x axis.

    Parameters
    ----------
    chords : on a flank
    module, clearance : of the pitch circle, and of the flanks [m]
    pressure : pressure angle [rad]
    """
    radius = module * teeth / 2
    base, root = radius * math.cos(pressure), radius - 1.25 * module
    half = math.pi / (2 * teeth) - clearance / (4 * radius) + involute(pressure)
    radii = np.linspace(base * 1.000001, radius + module, chords + 1)
    flank = [(r, half - involute(math.acos(base / r))) for r in radii]
    flank = [(root, flank[0][1]), *flank]
    polar = []
    for k in range(teeth):
        middle = 2 * math.pi * k / teeth
        polar += [(r, middle - a) for r, a in flank] + [(r, middle + a) for r, a in flank[::-1]]
    return [(r * math.cos(a), r * math.sin(a)) for r, a in polar]
