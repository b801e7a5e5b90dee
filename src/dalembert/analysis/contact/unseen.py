"""Rigid contacts in analyses that look at joints and forces alone."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.collision_gaps import collision_gaps
from dalembert.errors import UnsupportedError
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory

INSIDE, TOUCHING = 1e-9, 1e-6
"""In natural lengths: a negative gap that is told, and one that counts as closed."""


def unseen_contacts(model: Model, s: Trajectory, p: np.ndarray, forces: bool = False) -> list[str]:
    """Which gaps a result leaves negative, for nothing kept them from it.

    Parameters
    ----------
    model, s, p : states of the result and the parameters
    forces : the result is of forces, or of what they change, so that closed gaps count as well
    """
    if not s.t.size:
        return []
    length, found = model.scales.length, []
    limit = TOUCHING * length if forces else -INSIDE * length
    for name, k, gap, seeing in [*_stated(model, s, p), *_collisions(model, s, p)]:
        if gap < limit:
            size = f"{gap:.3g}" if gap < -INSIDE * length else "closed"
            found.append(
                f"the gap of {name} is {size} at t = {s.t[k]:.6g} s: this analysis does not see "
                f"rigid contacts; {seeing} does"
            )
    return found


def refuse_collisions(model: Model) -> None:
    """Many gaps are nothing for an analysis that follows each of them.

    Raises
    ------
    UnsupportedError
        There are some.
    """
    if many := [element.name for source in collision_gaps(model) for element in source.elements]:
        text = f"{', '.join(many)}: gaps among many balls are for solve_nonsmooth; use that"
        raise UnsupportedError(text)


Smallest = tuple[str, int, float, str]
"""Element, number of the instant, its smallest gap then, and the analysis that sees it."""


def _stated(model: Model, s: Trajectory, p: np.ndarray) -> Iterator[Smallest]:
    """Of gaps that are stated one by one."""
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
    """Of gaps among many balls, as far as any is closed."""
    travels = TOUCHING * model.equations.scales.displacements[:, None]
    for source in collision_gaps(model):
        smallest = np.full(s.t.size, np.inf)
        for k, t in enumerate(s.t):
            found = source.near(float(t), s.y[:, k], p, travels, source.width)
            smallest[k] = found.distance.min(initial=np.inf)
        k = int(np.argmin(smallest))
        yield source.elements[0].name, k, float(smallest[k]), "solve_nonsmooth"
