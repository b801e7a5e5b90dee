"""Manifold of positions: displacements, retraction and its inverse.

Displacements δ have the components of speeds. Solvers for positions solve for δ and move to
``y ⊕ δ``, which is ``y + A(y) δ`` to first order; ``y ⊖ y'`` is the displacement back. If all
speeds are rates of coordinates, the operations are + and −.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.coordinates import Coordinates
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import stack


@dataclass(frozen=True, eq=False)
class Manifold:
    """Manifold of the positions in a choice of coordinates.

    Attributes
    ----------
    y, other : SX symbols of two positions (n_y,)
    delta : SX symbols of a displacement (n,)
    moved : SX (n_y,), ``y ⊕ δ``
    flat : whether the operations are + and −
    bounds : SX of y, zero on the manifold only
    between : returns the expression ``other ⊖ y`` when needed
    attitudes : for each rotation in space, its first Euler parameter in y and its first speed
    """

    y: ca.SX
    other: ca.SX
    delta: ca.SX
    moved: ca.SX
    flat: bool
    bounds: ca.SX
    between: Callable[[], ca.SX]
    attitudes: tuple[tuple[int, int], ...] = ()

    @classmethod
    def of(cls, groups: Sequence[Coordinates]) -> Manifold:
        """Product manifold of groups of coordinates, stacked."""
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
            attitudes=_attitudes(groups),
        )

    @classmethod
    def plain(cls, y: ca.SX) -> Manifold:
        """Manifold of coordinates whose rates are the speeds."""
        other, delta = ca.SX.sym("other", y.numel()), ca.SX.sym("delta", y.numel())
        return cls(y, other, delta, y + delta, True, ca.SX(0, 1), lambda: other - y)

    def along(self, basis: ca.SX) -> Manifold:
        """Manifold of the same positions with displacements ``δ'``, ``δ = B δ'``."""
        delta = ca.SX.sym("delta", basis.shape[1])
        moved = ca.substitute(self.moved, self.delta, ca.mtimes(basis, delta))

        def between() -> ca.SX:  # deferred: the inverse of a full basis is a large expression
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
        symbols = ca.vertcat(self.y, self.delta)
        return ca.substitute(self.moved, symbols, ca.densify(ca.vertcat(y, delta)))

    def displacement(self, y: ca.SX, other: ca.SX) -> ca.SX:
        """``other ⊖ y``."""
        if self.flat:
            return other - y
        symbols = ca.vertcat(self.y, self.other)
        return ca.substitute(self.apart, symbols, ca.densify(ca.vertcat(y, other)))

    def settled(self, y: ca.SX) -> ca.SX:
        """The point of the manifold for a position with drift, ``y ⊕ 0``."""
        return y if self.flat else self.retract(y, ca.SX.zeros(self.delta.numel()))

    @cached_property
    def reading(self) -> ca.SX:
        """``∂(other ⊖ y)/∂other`` (n, n_y) at ``other = y``: differences → displacements."""
        if self.flat:
            return ca.SX.eye(self.y.numel())
        return ca.substitute(ca.jacobian(self.apart, self.other), self.other, self.y)

    # numerical evaluation -------------------------------------------------------------------
    def go(self, y: np.ndarray, delta: np.ndarray) -> np.ndarray:
        """``y ⊕ δ`` of a position, or of all columns."""
        return y + delta if self.flat else _evaluated(self.going, self._go, y, delta)

    def lead(self, y: np.ndarray, other: np.ndarray) -> np.ndarray:
        """``other ⊖ y`` of a pair of positions, or of all columns."""
        return other - y if self.flat else _evaluated(self._leading, self._lead, y, other)

    def path_shares(self, delta: np.ndarray, s: float) -> np.ndarray:
        """Displacement per ``s`` at ``y ⊕ s δ``, relative to ``δ``, by components; of columns."""
        shares = np.ones(delta.shape)
        for _, first in self.attitudes:
            turn = slice(first, first + 3)
            shares[turn] = _turning_share(s, (delta[turn] ** 2).sum(axis=0))
        return shares

    def halfway(self, delta: np.ndarray) -> np.ndarray:
        """Displacement (n,) after which rotations are half of those of ``y ⊕ δ``, and other
        coordinates in the middle."""
        half = 0.5 * delta
        if self.attitudes:
            turns = self._turns
            half[turns] *= _half_turn((delta[turns] ** 2).sum(axis=1, keepdims=True))
        return half

    def halfway_formula(self, delta: ca.SX) -> ca.SX:
        """``halfway`` of a formula."""
        half = 0.5 * delta
        for turn in self._turns.tolist():
            half[turn] *= _half_turn(ca.sumsqr(delta[turn]))
        return half

    @cached_property
    def _turns(self) -> np.ndarray:
        """(m, 3) numbers of the speeds of each rotation."""
        first = np.array([speed for _, speed in self.attitudes], dtype=int)
        return first[:, None] + np.arange(3)

    @cached_property
    def path(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Symbol ``s``, ``y ⊕ s δ``, and the displacement per ``s`` there relative to ``δ``."""
        share = ca.SX.sym("s")
        shares = ca.SX.ones(self.delta.numel())
        for _, first in self.attitudes:
            turn = slice(first, first + 3)
            shares[turn] = _turning_share(share, ca.sumsqr(self.delta[turn]))
        return share, self.retract(self.y, share * self.delta), shares

    @cached_property
    def going(self) -> ca.Function:
        """``(y, δ) → y ⊕ δ``."""
        return ca.Function("retract", [self.y, self.delta], [ca.densify(self.moved)])

    @cached_property
    def _leading(self) -> ca.Function:
        """``(y, other) → other ⊖ y``."""
        return ca.Function("displacement", [self.y, self.other], [ca.densify(self.apart)])

    @cached_property
    def _go(self) -> Kernel:
        return Kernel(self.going)

    @cached_property
    def _lead(self) -> Kernel:
        return Kernel(self._leading)


def _turning_share(s: Any, square: Any) -> Any:
    """Rate of a rotation ``e ⊗ (1, s δ/2)``, normalised, relative to ``δ``, with ``|δ|²``."""
    return 1 / (1 + s**2 * square / 4)


def _half_turn(square: Any) -> Any:
    """Ratio to ``δ/2`` of the displacement by half of the rotation by ``δ``, with ``|δ|²``.

    The rotation ``e ⊗ (1, δ/2)``, normalised, has the angle ``2 atan(|δ|/2)``.
    """
    root = (ca.sqrt if isinstance(square, ca.SX) else np.sqrt)(1 + square / 4)
    return 2 / (1 + root)


def _attitudes(groups: Sequence[Coordinates]) -> tuple[tuple[int, int], ...]:
    """Positions of the rotations in space in the stacked coordinates and speeds."""
    places, coordinate, speed = [], 0, 0
    for group in groups:
        if group.attitude is not None:
            places.append((coordinate + group.attitude[0], speed + group.attitude[1]))
        coordinate, speed = coordinate + group.pose.numel(), speed + group.twist.numel()
    return tuple(places)


def _evaluated(
    function: ca.Function, kernel: Kernel, y: np.ndarray, other: np.ndarray
) -> np.ndarray:
    """A function of a single position as a vector, or of several as columns."""
    return function(y, other).full() if y.ndim > 1 else kernel(y, other)[0].ravel()
