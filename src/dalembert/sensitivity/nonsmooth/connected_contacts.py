"""State of contacts before and after an impact."""

from __future__ import annotations

import numpy as np

from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges

RESTING = 1e-8
"""Threshold of the speed of a closed contact after an impact, relative to that before [-]."""


def remain_closed(values: GapChanges, fastest: float | np.ndarray) -> np.ndarray:
    """Mask of the contacts that remain closed after a step: at rest, or without restitution.

    Parameters
    ----------
    values : of their gaps
    fastest : largest speed of the step, of each contact if they act in different ones
    """
    limit = RESTING * np.maximum(np.abs(values.before[:, 0]), fastest)
    closed: np.ndarray = (np.abs(values.after[:, 0]) <= limit) | (values.laws[:, 0] == 0)
    return closed


def closing_times(values: GapChanges) -> np.ndarray:
    """(n,) times until gaps close, extrapolated with their speeds."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(-values.distance / values.before[:, 0])
