"""Motion of a tree of bodies: operators D and E of (6.1), (7.8), poses ``g(q)``, ``D u`` and ``γ``.

    v_i = X_i v_parent + S_i (u_i + N_i v_parent) (+ E_i ż_i)

where ``u + N v_parent`` is for absolute instead of relative angular velocities. In space the
recursion uses angular velocities in inertial axes, and ``T_i v_i`` are the speeds. Products with D,
Dᵀ and Eᵀ pass once along the tree; the matrices are never formed. Each body adds its own joint to
the motion of its carrier, so that everything grows linearly with the number of bodies (6.17).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import casadi as ca

from dalembert.elements.coordinates import Coordinates
from dalembert.model.graph.tree.link import Link, Step
from dalembert.symbolic.formulas.expression import stack


@dataclass(frozen=True, eq=False)
class Branch:
    """Operators of a body and its joint in the recursion.

    Attributes
    ----------
    parent : index of the carrier's branch; None on the ground, or for a free body
    rows, columns, open_columns : its part of ``v``, ``u`` and ``z``
    transport, subspace, coupling, opening : SX ``X``, ``S``, ``N`` and ``E``
    projection : SX ``T``, orthogonal
    """

    parent: int | None
    rows: slice
    columns: slice
    open_columns: slice
    transport: ca.SX
    subspace: ca.SX
    coupling: ca.SX
    opening: ca.SX
    projection: ca.SX

    @property
    def propagation(self) -> ca.SX:
        """``∂v_i/∂v_parent = X + S N``."""
        return self.transport + ca.mtimes(self.subspace, self.coupling)


class TreeBasis:
    """``D`` (n, k) and ``E`` (n, m_I) as operators.

    Parameters
    ----------
    branches : parents before the bodies they carry; columns and open columns in this order
    speed_count : n, rows of ``v`` by body and not by branch
    """

    def __init__(self, branches: list[Branch], speed_count: int):
        self.branches, self.speed_count = branches, speed_count

    def times(self, x: ca.SX, drift: list[ca.SX] | None = None) -> ca.SX:
        """``D x``, or with a drift of each body relative to its parent ``D x + γ``."""
        twists: list[ca.SX] = []
        result = ca.SX(self.speed_count, x.shape[1])
        for k, b in enumerate(self.branches):
            own, twist = x[b.columns, :], ca.SX(b.subspace.shape[0], x.shape[1])
            if b.parent is not None:
                twist = ca.mtimes(b.transport, twists[b.parent])
                own += ca.mtimes(b.coupling, twists[b.parent])
            twist += ca.mtimes(b.subspace, own)
            if drift is not None:
                twist += drift[k]
            twists.append(twist)
            result[b.rows, :] = ca.mtimes(b.projection, twist)
        return result

    def wrenches(self, w: ca.SX) -> list[ca.SX]:
        """Wrench on each branch: the part of ``w`` of its body and of all bodies it carries."""
        total = [ca.mtimes(b.projection.T, w[b.rows, :]) for b in self.branches]
        for k, b in reversed(list(enumerate(self.branches))):
            if b.parent is not None:
                along = ca.mtimes(b.subspace.T, total[k])
                total[b.parent] += ca.mtimes(b.transport.T, total[k])
                total[b.parent] += ca.mtimes(b.coupling.T, along)
        return total

    def transposed(self, w: ca.SX) -> ca.SX:
        """``Dᵀ w``."""
        pairs = zip(self.branches, self.wrenches(w), strict=True)
        return ca.vertcat(*(ca.mtimes(b.subspace.T, part) for b, part in pairs))

    def opened_transposed(self, w: ca.SX) -> ca.SX:
        """``Eᵀ w``."""
        pairs = zip(self.branches, self.wrenches(w), strict=True)
        return ca.vertcat(*(ca.mtimes(b.opening.T, part) for b, part in pairs))

    def opened_times(self, z: ca.SX) -> ca.SX:
        """``E z``."""
        drift = [ca.mtimes(b.opening, z[b.open_columns, :]) for b in self.branches]
        columns = self.branches[-1].columns.stop if self.branches else 0
        return self.times(ca.SX(columns, z.shape[1]), drift)

    def relative(self, chosen: list[bool]) -> TreeBasis:
        """The same operators; those of chosen branches by ``X + S N``, without N."""
        if not any(chosen):
            return self
        branches = [
            replace(b, transport=b.propagation, coupling=ca.SX(*b.coupling.shape)) if k else b
            for b, k in zip(self.branches, chosen, strict=True)
        ]
        return TreeBasis(branches, self.speed_count)

    def substitute(self, symbols: ca.SX, values: ca.SX) -> TreeBasis:
        """The operators with some symbols replaced."""
        branches = []
        for b in self.branches:
            parts = [b.transport, b.subspace, b.coupling, b.opening, b.projection]
            parts = ca.substitute(parts, [symbols], [values])
            branches.append(Branch(b.parent, b.rows, b.columns, b.open_columns, *parts))
        return TreeBasis(branches, self.speed_count)


class TreeMotion:
    """Motion of all groups of coordinates in joint coordinates.

    Parameters
    ----------
    links : carriers before the bodies they carry
    groups : groups of coordinates in the order of y and v

    Attributes
    ----------
    q, u, a : SX symbols: joint coordinates (k_q,), their speeds (k,) and ``u̇``
    rate : SX (k_q,), ``q̇``
    columns : of u, for each link
    pose : SX, ``g(q)``
    basis : TreeBasis, ``D`` and ``E``
    speed, gamma, acceleration : SX (n,), ``D u``, ``γ`` and ``D u̇ + γ``
    """

    def __init__(self, links: list[Link], groups: list[Coordinates]):
        self.links = links
        self.q = stack(link.space.pose for link in links)
        self.u = stack(link.space.twist for link in links)
        self.a = stack(link.space.acceleration_symbols for link in links)
        self.rate = stack(link.space.pose_rate for link in links)
        row_spans = _spans(group.twist.numel() for group in groups)
        rows_of = {group.name: rows for group, rows in zip(groups, row_spans, strict=True)}
        self.columns = columns = _spans(link.space.twist.numel() for link in links)
        open_columns = _spans(link.equation_count for link in links)
        index = {link.group.name: k for k, link in enumerate(links)}
        steps: list[Step] = []
        branches: list[Branch] = []
        for k, link in enumerate(links):
            parent = None if link.carrier is None else index.get(link.carrier.name)
            step = link.step(None if parent is None else steps[parent])
            spans = rows_of[link.group.name], columns[k], open_columns[k]
            operators = step.transport, step.subspace, step.coupling, step.opening, step.projection
            branches.append(Branch(parent, *spans, *operators))
            steps.append(step)
        by_group = {link.group.name: step for link, step in zip(links, steps, strict=True)}
        drifts = [step.drift for step in steps]
        self.pose = ca.densify(stack(by_group[group.name].pose for group in groups))
        self.speed = ca.densify(stack(by_group[group.name].twist for group in groups))
        self.basis = TreeBasis(branches, self.speed.numel())
        self.gamma = ca.densify(self.basis.times(ca.SX.zeros(self.u.numel()), drifts))
        self.acceleration = ca.densify(self.basis.times(self.a, drifts))


def _spans(sizes: Iterable[int]) -> list[slice]:
    """Consecutive slices of these sizes."""
    spans, begin = [], 0
    for size in sizes:
        spans.append(slice(begin, begin + size))
        begin += size
    return spans
