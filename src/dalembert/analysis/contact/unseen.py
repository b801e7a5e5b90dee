"""Rigid contacts in analyses that look at joints and forces alone."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gap_sources import collision_gaps
from dalembert.errors import UnsupportedError
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory

INSIDE, CLOSED = 1e-9, 1e-6
"""In natural lengths: threshold for a warning about an overlap, and for a closed gap."""


def ignored_contacts(model: Model, s: Trajectory, p: np.ndarray, forces: bool = False) -> list[str]:
    """Warnings about negative gaps in results of analyses that ignore rigid contacts.

    Parameters
    ----------
    model, s, p : model, states of the result and parameters
    forces : the result depends on forces, so closed gaps count as well
    """
    if not s.t.size:
        return []
    length, warnings = model.scales.length, []
    limit = CLOSED * length if forces else -INSIDE * length
    for name, k, gap, analysis in [*_single_gaps(model, s, p), *_collisions(model, s, p)]:
        if gap < limit:
            size = f"{gap:.3g}" if gap < -INSIDE * length else "closed"
            warnings.append(
                f"the gap of {name} is {size} at t = {s.t[k]:.6g} s: this analysis ignores "
                f"rigid contacts; use {analysis}"
            )
    return warnings


def refuse_collisions(model: Model) -> None:
    """Refuse elements with gaps among many balls.

    Raises
    ------
    UnsupportedError
        The model has such elements.
    """
    if many := [element.name for source in collision_gaps(model) for element in source.elements]:
        text = f"{', '.join(many)}: gaps among many balls are for solve_nonsmooth; use that"
        raise UnsupportedError(text)


Smallest = tuple[str, int, float, str]
"""Element, number of the instant, smallest gap, and the analysis that includes it."""


def _single_gaps(model: Model, s: Trajectory, p: np.ndarray) -> Iterator[Smallest]:
    """Smallest gaps of elements with one gap each."""
    e = model.all_equations
    if not e.contacts:
        return
    gaps = ca.densify(ca.vertcat(*(gap.distance for gap in e.contacts)))
    function = ca.Function("gaps", [e.t, e.y, e.p], [gaps]).map(s.t.size)
    values = function(s.t, s.y, np.tile(p[:, None], s.t.size)).full()
    for gap, row in zip(e.contacts, values, strict=True):
        k = int(np.argmin(row))
        yield gap.name, k, float(row[k]), "solve_dynamics"


def _collisions(model: Model, s: Trajectory, p: np.ndarray) -> Iterator[Smallest]:
    """Smallest gaps among many balls that are closed or nearly closed."""
    travels = CLOSED * model.equations.scales.displacements[:, None]
    for source in collision_gaps(model):
        smallest = np.full(s.t.size, np.inf)
        for k, t in enumerate(s.t):
            gaps = source.near(float(t), s.y[:, k], p, travels, source.width)
            smallest[k] = gaps.distance.min(initial=np.inf)
        k = int(np.argmin(smallest))
        yield source.elements[0].name, k, float(smallest[k]), "solve_nonsmooth"
