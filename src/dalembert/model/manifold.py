"""Positions as points of a manifold: reached by displacements, never added.

A displacement δ is counted like a speed, so there are as many of them as ways to move. What solves
for positions solves for δ and goes to ``y ⊕ δ``, which is ``y + A(y) δ`` in first order; ``y ⊖ y'``
is the displacement that leads back. Where all speeds are rates of coordinates these are + and −.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.elements.coordinates import Coordinates
from dalembert.symbolic.formulas.expression import stack


@dataclass(frozen=True, eq=False)
class Manifold:
    """Positions of one choice of coordinates.

    Attributes
    ----------
    y, other : SX symbols of two positions (n_y,)
    delta : SX symbols of a displacement (n,)
    moved : SX (n_y,), ``y ⊕ δ``
    flat : the operations are + and −
    bounds : SX of y, zero on the manifold only
    between : states ``other ⊖ y`` when it is asked for
    """

    y: ca.SX
    other: ca.SX
    delta: ca.SX
    moved: ca.SX
    flat: bool
    bounds: ca.SX
    between: Callable[[], ca.SX]

    @classmethod
    def of(cls, groups: Sequence[Coordinates]) -> Manifold:
        """Of all coordinates of some groups, one above the other."""
        parts = [(group, ca.SX.sym("other", group.pose.numel())) for group in groups]
        steps = [ca.SX.sym("delta", group.twist.numel()) for group in groups]
        apart = stack(group.displacement(group.pose, other) for group, other in parts)
        return cls(
            y=stack(group.pose for group in groups),
            other=stack(other for _, other in parts),
            delta=stack(steps),
            moved=stack(g.retract(g.pose, s) for g, s in zip(groups, steps, strict=True)),
            flat=all(group.flat for group in groups),
            bounds=stack(group.bounds(group.pose) for group in groups),
            between=lambda: apart,
        )

    @classmethod
    def plain(cls, y: ca.SX) -> Manifold:
        """Of coordinates whose rates are the speeds."""
        other, delta = ca.SX.sym("other", y.numel()), ca.SX.sym("delta", y.numel())
        return cls(y, other, delta, y + delta, True, ca.SX(0, 1), lambda: other - y)

    def along(self, basis: ca.SX) -> Manifold:
        """Of the same positions, with other displacements: ``δ = B δ'``."""
        delta = ca.SX.sym("delta", basis.shape[1])
        moved = ca.substitute(self.moved, self.delta, ca.mtimes(basis, delta))

        def between() -> ca.SX:  # the inverse of a full basis is long
            return ca.mtimes(ca.pinv(basis), self.apart)

        return Manifold(self.y, self.other, delta, moved, False, self.bounds, between)

    @cached_property
    def apart(self) -> ca.SX:
        """(n,) ``other ⊖ y``."""
        return self.between()

    def retract(self, y: ca.SX, delta: ca.SX) -> ca.SX:
        """``y ⊕ δ``."""
        if self.flat:
            return y + delta
        known = ca.vertcat(self.y, self.delta)
        return ca.substitute(self.moved, known, ca.densify(ca.vertcat(y, delta)))

    def displacement(self, y: ca.SX, other: ca.SX) -> ca.SX:
        """``other ⊖ y``."""
        if self.flat:
            return other - y
        known = ca.vertcat(self.y, self.other)
        return ca.substitute(self.apart, known, ca.densify(ca.vertcat(y, other)))

    def settled(self, y: ca.SX) -> ca.SX:
        """The point of the manifold at a position that has drifted off it, ``y ⊕ 0``."""
        return y if self.flat else self.retract(y, ca.SX.zeros(self.delta.numel()))

    @cached_property
    def reading(self) -> ca.SX:
        """``∂(other ⊖ y)/∂other`` (n, n_y) at ``other = y``: a displacement off a difference."""
        if self.flat:
            return ca.SX.eye(self.y.numel())
        return ca.substitute(ca.jacobian(self.apart, self.other), self.other, self.y)

    # the same for numbers -------------------------------------------------------------------
    def go(self, y: np.ndarray, delta: np.ndarray) -> np.ndarray:
        """``y ⊕ δ`` of one position, or of as many as there are columns."""
        return y + delta if self.flat else _shaped(self.going(y, delta), y)

    def lead(self, y: np.ndarray, other: np.ndarray) -> np.ndarray:
        """``other ⊖ y`` of one pair of positions, or of as many as there are columns."""
        return other - y if self.flat else _shaped(self._apart(y, other), y)

    @cached_property
    def going(self) -> ca.Function:
        """``(y, δ) → y ⊕ δ``."""
        return ca.Function("retract", [self.y, self.delta], [self.moved])

    @cached_property
    def _apart(self) -> ca.Function:
        return ca.Function("displacement", [self.y, self.other], [self.apart])


def _shaped(found: ca.DM, like: np.ndarray) -> np.ndarray:
    """One position as a vector, several as columns."""
    return found.full() if like.ndim > 1 else found.full().ravel()
