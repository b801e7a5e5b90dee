"""Choice of the coordinates and speeds that are the states of model exchange.

The constraint equations determine the other ones, ``Φ(y, t) = 0`` and ``Ψ(y, v, t) = 0``, so that
an importer, whose integrator does not know them, cannot violate them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.model.graph.coordinates import CoordinateView
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.manifold import Manifold
from dalembert.text.wording import similar

CLEARLY = (0.2, 0.05, 1e-3)
"""Thresholds for the independence of a coordinate, in successive rounds of the choice [-]."""
RANK = 1e-8
"""Threshold of a singular value of the constraint equations, in natural units [-]."""


@dataclass(frozen=True)
class IndependentCoordinates:
    """Indices of the states of model exchange.

    Attributes
    ----------
    positions : entries of y that are states; all entries of a rotation of which one is independent
    pinned : displacements fixed by these states, as many as degrees of freedom
    speeds : independent entries of v
    first_order : entries of y that are states of first order
    """

    positions: tuple[int, ...]
    pinned: tuple[int, ...]
    speeds: tuple[int, ...]
    first_order: tuple[int, ...]

    @property
    def count(self) -> int:
        return len(self.positions) + len(self.speeds) + len(self.first_order)


def independent_coordinates(
    view: CoordinateView,
    e: Equations,
    y: np.ndarray,
    p: np.ndarray,
    t: float = 0.0,
    names: Sequence[str] | None = None,
) -> IndependentCoordinates:
    """States of a model at a position.

    Angles are chosen before lengths, as a crank passes the dead centres of its piston; then in
    their order, joints of the ground first. One is left out if it hardly moves relative to others.

    Parameters
    ----------
    view, e : the model in its coordinates, and its equations
    y, p, t : position, parameters and time of the choice
    names : names of the independent coordinates, chosen by the user

    Raises
    ------
    UnsupportedError
        Unknown names, a wrong number of them, or names that do not determine the position.
    """
    groups = _groups(e.manifold)
    outputs = [ca.densify(e.position_jacobian), ca.densify(e.jacobian)]
    function = ca.Function("C", [e.t, e.y, e.p], outputs)
    holonomic, everything = (c.full() * e.scales.displacements for c in function(t, y, p))
    scaled = holonomic[list(e.holds)] / e.scales.rows[list(e.holds), None]
    wanted = None if names is None else _named(view, groups, names)
    pinned = _chosen(view, scaled, wanted)
    speeds = pinned
    if e.slips:
        speeds = _chosen(view, everything / e.scales.rows[:, None], None)
    positions = [k for entries, own in groups if own & {*pinned} for k in entries]
    return IndependentCoordinates(tuple(sorted(positions)), pinned, speeds, e.states)


def _groups(manifold: Manifold) -> list[tuple[list[int], set[int]]]:
    """Coordinates that move together, and their displacements."""
    if manifold.flat:
        return [([k], {k}) for k in range(manifold.y.numel())]
    rows, columns = ca.jacobian_sparsity(manifold.moved, manifold.delta).get_triplet()
    by_row: dict[int, set[int]] = {}
    for row, column in zip(rows, columns, strict=True):
        by_row.setdefault(row, set()).add(column)
    groups: list[tuple[list[int], set[int]]] = []
    for row, own in sorted(by_row.items()):
        joined = [group for group in groups if group[1] & own]
        groups = [group for group in groups if not group[1] & own]
        entries = sorted([row, *(k for group in joined for k in group[0])])
        groups.append((entries, own.union(*(group[1] for group in joined))))
    return groups


def _chosen(
    view: CoordinateView, jacobian: np.ndarray, wanted: list[int] | None
) -> tuple[int, ...]:
    """Displacements that determine the others, by the null space of scaled constraints."""
    count = jacobian.shape[1]
    if not count:
        return ()
    _, sizes, right = np.linalg.svd(jacobian, full_matrices=True)
    rank = int(np.sum(sizes > RANK * max(1.0, sizes.max(initial=0.0))))
    basis = right[rank:].T
    freedom = basis.shape[1]
    if wanted is None:
        return _greedy(basis, _priority(view))
    chosen = _greedy(basis, wanted)
    if len(wanted) != freedom or len(chosen) != freedom:
        free = ", ".join(view.speed_names[k] for k in _greedy(basis, _priority(view)))
        raise UnsupportedError(
            f"states {[view.speed_names[k] for k in wanted]} do not determine the position of "
            f"{view.model.name!r}, which has {freedom} independent coordinates; give e.g. {free}"
        )
    return chosen


def _priority(view: CoordinateView) -> list[int]:
    """Displacements in the order of choice."""
    return sorted(range(len(view.speed_units)), key=lambda k: view.speed_units[k] != "rad")


def _greedy(basis: np.ndarray, order: Sequence[int]) -> tuple[int, ...]:
    """Rows of the basis that are clearly independent of those chosen before."""
    freedom = basis.shape[1]
    frame, chosen = np.zeros((0, freedom)), list[int]()
    for threshold in CLEARLY:
        for k in order:
            if k in chosen or len(chosen) == freedom:
                continue
            rest = basis[k] - frame.T @ (frame @ basis[k])
            rest -= frame.T @ (frame @ rest)
            if (size := np.linalg.norm(rest)) > threshold:
                frame = np.vstack([frame, rest / size])
                chosen.append(k)
    return tuple(sorted(chosen))


def _named(
    view: CoordinateView, groups: list[tuple[list[int], set[int]]], names: Sequence[str]
) -> list[int]:
    """Displacements of named coordinates."""
    by_name = {view.names[e[0]]: next(iter(d)) for e, d in groups if len(e) == len(d) == 1}
    for name in names:
        if name not in by_name:
            close = similar(name, list(by_name)) or list(by_name)
            raise UnsupportedError(f"states: no coordinate {name!r}; nearest: {', '.join(close)}")
    return [by_name[name] for name in names]
