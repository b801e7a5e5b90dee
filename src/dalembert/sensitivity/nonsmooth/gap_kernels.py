"""Functions of the gaps of one kind and their derivatives by the arguments that vary."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind
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
    """

    width: int
    arguments: tuple[int, ...]
    velocities: tuple[int, ...]

    @classmethod
    def of(cls, kind: GapKind, width: int, varying: np.ndarray, moving: np.ndarray) -> GapVariables:
        """Variables of some gaps, by masks of the entries of the geometry and of the velocities."""
        own = varying[np.hstack(kind.arguments)], moving[kind.velocities]
        arguments, velocities = (np.flatnonzero(mask.any(axis=0)).tolist() for mask in own)
        return cls(width, tuple(arguments), tuple(velocities))


class GapKernels:
    """Functions of the gaps of one source, with their memory."""

    def __init__(self) -> None:
        self._slopes: dict[tuple[ca.Function, GapVariables], list[BlockedKernel]] = {}
        self._values: dict[tuple[ca.Function, GapVariables], BlockedKernel] = {}

    def slopes(self, function: ca.Function, variables: GapVariables) -> list[BlockedKernel]:
        """``(arguments, τ) → g, B τ, B`` and derivatives of ``g`` and ``B τ``; and
        ``(arguments, τ, P) → B τ, f, B`` and derivatives of ``B τ`` and ``f``."""
        key = function, variables
        if key not in self._slopes:
            self._slopes[key] = [BlockedKernel(own) for own in _slopes(*key)]
        return self._slopes[key]

    def values(self, function: ca.Function, variables: GapVariables) -> BlockedKernel:
        """``arguments → g, B``."""
        key = function, variables
        if key not in self._values:
            self._values[key] = BlockedKernel(_values(*key))
        return self._values[key]


class _Formulas:
    """Formulas of one kind of gaps.

    Attributes
    ----------
    arguments : symbols
    distance, blocks : ``g``, and all columns of ``B``
    """

    def __init__(self, function: ca.Function, variables: GapVariables):
        self.arguments = [ca.SX.sym("s", function.numel_in(k)) for k in range(function.n_in())]
        self.distance, blocks, *_ = function.call(self.arguments)
        rows = min(variables.width, blocks.shape[0])
        zeros = ca.SX.zeros(variables.width - rows, blocks.shape[1])
        self.blocks = ca.vertcat(blocks[:rows, :], zeros)


@lru_cache(CACHED)
def _values(function: ca.Function, variables: GapVariables) -> ca.Function:
    own = _Formulas(function, variables)
    results = [own.distance, own.blocks[:, list(variables.velocities)]]
    return _function("gap_values", own.arguments, results)


@lru_cache(CACHED)
def _slopes(function: ca.Function, variables: GapVariables) -> tuple[ca.Function, ca.Function]:
    own, moving = _Formulas(function, variables), list(variables.velocities)
    blocks = own.blocks[:, moving]
    twist, impulse = ca.SX.sym("twist", len(moving)), ca.SX.sym("P", variables.width)
    speeds, wrench = ca.mtimes(blocks, twist), ca.mtimes(blocks.T, impulse)
    geometry, varying = ca.vertcat(*own.arguments), list(variables.arguments)
    by_distance, by_speeds, by_wrench = (
        ca.jacobian(value, geometry)[:, varying] for value in (own.distance, speeds, wrench)
    )
    start = [*own.arguments, twist], [own.distance, speeds, blocks, by_distance, by_speeds]
    middle = [*own.arguments, twist, impulse], [speeds, wrench, blocks, by_speeds, by_wrench]
    return _function("gap_slopes", *start), _function("gap_slopes", *middle)


def _function(name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> ca.Function:
    return ca.Function(name, inputs, [ca.densify(part) for part in outputs], {"cse": True})
