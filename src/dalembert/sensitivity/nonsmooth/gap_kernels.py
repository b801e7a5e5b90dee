"""Functions of the gaps of one kind and their derivatives by the arguments that vary."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind, GapSource
from dalembert.analysis.nonsmooth.gaps.shape_velocities import TWIST
from dalembert.analysis.nonsmooth.gaps.tangents import tangent_rotation
from dalembert.sensitivity.nonsmooth.blocked_kernel import BlockedKernel

CACHED = 64
"""Upper limit of the number of functions whose derivatives are cached."""


@dataclass(frozen=True)
class GapVariables:
    """Variables of the gaps of one kind; plane gaps lack half of those in space.

    Attributes
    ----------
    width : components of gap velocities
    arguments, velocities : numbers of the arguments and of the velocities that are not constant
    follows : whether the tangents are those of a normal that has turned, as of contacts in space
    """

    width: int
    arguments: tuple[int, ...]
    velocities: tuple[int, ...]
    follows: bool

    @classmethod
    def of(
        cls, kind: GapKind, source: GapSource, width: int, varying: np.ndarray, moving: np.ndarray
    ) -> GapVariables:
        """Variables of some gaps of a source, by masks of the entries of the geometry and of the
        velocities."""
        own = varying[np.hstack(kind.arguments)], moving[kind.velocities]
        arguments, velocities = (np.flatnonzero(mask.any(axis=0)).tolist() for mask in own)
        follows = source.groups[:1] == (2,) and kind.velocities.shape[1] == 2 * TWIST
        return cls(width, tuple(arguments), tuple(velocities), follows)


class GapKernels:
    """Functions of the gaps of one source, with their memory."""

    def __init__(self) -> None:
        self._slopes: dict[tuple[ca.Function, GapVariables], list[BlockedKernel]] = {}
        self._values: dict[tuple[ca.Function, GapVariables], list[BlockedKernel]] = {}

    def slopes(self, function: ca.Function, variables: GapVariables) -> list[BlockedKernel]:
        """``(arguments, τ) → g, B τ, B, n`` and derivatives of ``g``, ``B τ`` and ``n``; and
        ``(arguments, n₀, τ, P) → B τ, f, B`` with the tangents of ``n₀``, and derivatives of
        ``B τ`` and ``f`` by the arguments and by ``n₀``."""
        key = function, variables
        if key not in self._slopes:
            self._slopes[key] = [BlockedKernel(own) for own in _slopes(*key)]
        return self._slopes[key]

    def values(self, function: ca.Function, variables: GapVariables) -> list[BlockedKernel]:
        """``arguments → g, B, n``, and ``(arguments, n₀) → B`` with the tangents of ``n₀``."""
        key = function, variables
        if key not in self._values:
            self._values[key] = [BlockedKernel(own) for own in _values(*key)]
        return self._values[key]


class _Formulas:
    """Formulas of one kind of gaps.

    Attributes
    ----------
    arguments : symbols
    first : symbol of ``n₀``
    distance, normal : ``g``, and ``n``, zero if tangents do not follow it
    blocks, turned : ``B``, and the same with the tangents of ``n₀``
    """

    def __init__(self, function: ca.Function, variables: GapVariables):
        self.arguments = [ca.SX.sym("s", function.numel_in(k)) for k in range(function.n_in())]
        self.distance, blocks, *_ = function.call(self.arguments)
        rows = min(variables.width, blocks.shape[0])
        zeros = ca.SX.zeros(variables.width - rows, blocks.shape[1])
        blocks = ca.vertcat(blocks[:rows, :], zeros)
        self.first, self.normal, turned = ca.SX.sym("n", 3), ca.SX(3, 1), blocks
        if variables.follows:
            self.normal = blocks[0, TWIST : TWIST + 3].T  # its speed is that of the second shape
            turned = _turned(blocks, tangent_rotation(self.first, self.normal))
        moving = list(variables.velocities)
        self.blocks, self.turned = blocks[:, moving], turned[:, moving]


def _turned(blocks: ca.SX, rotation: ca.SX) -> ca.SX:
    """Rows along both tangents turned, those of the slip and of the rotations about tangents."""
    rows = ca.SX(blocks)
    for first in range(1, min(blocks.shape[0] - 1, 5), 2):
        rows[first : first + 2, :] = ca.mtimes(rotation, blocks[first : first + 2, :])
    return rows


@lru_cache(CACHED)
def _values(function: ca.Function, variables: GapVariables) -> tuple[ca.Function, ca.Function]:
    own = _Formulas(function, variables)
    start = own.arguments, [own.distance, own.blocks, own.normal]
    middle = [*own.arguments, own.first], [own.turned]
    return _function("gap_values", *start), _function("gap_values", *middle)


@lru_cache(CACHED)
def _slopes(function: ca.Function, variables: GapVariables) -> tuple[ca.Function, ca.Function]:
    own = _Formulas(function, variables)
    twist, impulse = ca.SX.sym("twist", own.blocks.shape[1]), ca.SX.sym("P", variables.width)
    geometry, varying = ca.vertcat(*own.arguments), list(variables.arguments)

    def by(value: ca.SX) -> ca.SX:
        return ca.jacobian(value, geometry)[:, varying]

    before = ca.mtimes(own.blocks, twist)
    normal = by(own.normal) if variables.follows else ca.SX(3, 0)
    values = own.distance, before, own.blocks, own.normal
    start = [*own.arguments, twist], [*values, by(own.distance), by(before), normal]
    both, wrench = ca.mtimes(own.turned, twist), ca.mtimes(own.turned.T, impulse)
    by_first = [ca.jacobian(value, own.first) for value in (both, wrench)]
    inputs = [*own.arguments, own.first, twist, impulse]
    middle = inputs, [both, wrench, own.turned, by(both), by(wrench), *by_first]
    return _function("gap_slopes", *start), _function("gap_slopes", *middle)


def _function(name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> ca.Function:
    return ca.Function(name, inputs, [ca.densify(part) for part in outputs], {"cse": True})
