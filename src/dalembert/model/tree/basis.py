"""Motion of a tree of bodies as a recursion: the operators D and E of (6.1) and (7.8).

    v_i = X_i v_parent + S_i (u_i + N_i v_parent) (+ E_i ż_i)

where ``u + N v_parent`` takes a body's own angular velocity in the place of the relative one. In
space the recursion goes by angular velocities in inertial axes, and ``T_i v_i`` are the speeds.
Products with D, Dᵀ and Eᵀ pass once along the tree; the matrices are never formed.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True, eq=False)
class Branch:
    """One body as its joint moves it.

    Attributes
    ----------
    parent : index of the branch it is carried by; None on the ground, or free
    rows, columns, opened : its part of ``v``, ``u`` and ``z``
    carried, moved, turned, forced : SX ``X``, ``S``, ``N`` and ``E``
    seen : SX ``T``, orthogonal
    """

    parent: int | None
    rows: slice
    columns: slice
    opened: slice
    carried: ca.SX
    moved: ca.SX
    turned: ca.SX
    forced: ca.SX
    seen: ca.SX

    @property
    def across(self) -> ca.SX:
        """``∂v_i/∂v_parent = X + S N``."""
        return self.carried + ca.mtimes(self.moved, self.turned)


class TreeBasis:
    """``D`` (n, k) and ``E`` (n, m_I) as operators.

    Parameters
    ----------
    branches : parents before the bodies they carry; rows, columns and opened in this order
    speed_count : n, rows of ``v`` by body and not by branch
    """

    def __init__(self, branches: list[Branch], speed_count: int):
        self.branches, self.speed_count = branches, speed_count

    def times(self, x: ca.SX, drift: list[ca.SX] | None = None) -> ca.SX:
        """``D x``, or with a drift of each body relative to its parent ``D x + γ``."""
        found: list[ca.SX] = []
        result = ca.SX(self.speed_count, x.shape[1])
        for k, b in enumerate(self.branches):
            own, twist = x[b.columns, :], ca.SX(b.moved.shape[0], x.shape[1])
            if b.parent is not None:
                twist = ca.mtimes(b.carried, found[b.parent])
                own += ca.mtimes(b.turned, found[b.parent])
            twist += ca.mtimes(b.moved, own)
            if drift is not None:
                twist += drift[k]
            found.append(twist)
            result[b.rows, :] = ca.mtimes(b.seen, twist)
        return result

    def wrenches(self, w: ca.SX) -> list[ca.SX]:
        """What each branch carries of ``w``: its own part and that of all bodies behind it."""
        carried = [ca.mtimes(b.seen.T, w[b.rows, :]) for b in self.branches]
        for k, b in reversed(list(enumerate(self.branches))):
            if b.parent is not None:
                along = ca.mtimes(b.moved.T, carried[k])
                carried[b.parent] += ca.mtimes(b.carried.T, carried[k])
                carried[b.parent] += ca.mtimes(b.turned.T, along)
        return carried

    def transposed(self, w: ca.SX) -> ca.SX:
        """``Dᵀ w``."""
        pairs = zip(self.branches, self.wrenches(w), strict=True)
        return ca.vertcat(*(ca.mtimes(b.moved.T, part) for b, part in pairs))

    def opened_transposed(self, w: ca.SX) -> ca.SX:
        """``Eᵀ w``."""
        pairs = zip(self.branches, self.wrenches(w), strict=True)
        return ca.vertcat(*(ca.mtimes(b.forced.T, part) for b, part in pairs))

    def opened_times(self, z: ca.SX) -> ca.SX:
        """``E z``."""
        drift = [ca.mtimes(b.forced, z[b.opened, :]) for b in self.branches]
        columns = self.branches[-1].columns.stop if self.branches else 0
        return self.times(ca.SX(columns, z.shape[1]), drift)

    def substitute(self, symbols: ca.SX, values: ca.SX) -> TreeBasis:
        """The same at other values of some symbols."""
        made = []
        for b in self.branches:
            parts = [b.carried, b.moved, b.turned, b.forced, b.seen]
            parts = ca.substitute(parts, [symbols], [values])
            made.append(Branch(b.parent, b.rows, b.columns, b.opened, *parts))
        return TreeBasis(made, self.speed_count)
