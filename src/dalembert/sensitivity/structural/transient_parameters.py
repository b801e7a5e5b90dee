"""Tangent and adjoint of the equations of motion of a structure by the parameters.

``g = M a + C v + ∂W/∂u(u)`` with ``C = α M + β K``; loads and support motions depend on time too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from dalembert.analysis.transient.equation import EquationOfMotion, Motions
from dalembert.analysis.transient.instant import Instant
from dalembert.model.assembled.evaluation.block import ElementKind
from dalembert.model.assembled.evaluation.columns import Products, Pulls, Pushes
from dalembert.model.assembled.evaluation.inertia import from_rest

MAX_ENTRIES = 4_000_000
"""Upper limit of gathered element entries, times states and responses."""


class Timed(Protocol):
    """Array that depends on parameters and time."""

    depends_on_time: bool

    def push(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """Change along a direction of the parameters."""

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """Weights of the parameters."""


class TimedPull:
    """Weights of the parameters from weights of an array at many times.

    Parameters
    ----------
    source : the array
    p : (np,) parameters
    """

    def __init__(self, source: Timed, p: np.ndarray):
        self.source, self.p = source, p
        self._sum: np.ndarray | None = None
        self._total: np.ndarray | float = 0.0

    def add(self, weights: np.ndarray, time: float) -> None:
        """Add weights (n, rows) at a time."""
        if not weights.any():
            return
        if self.source.depends_on_time:
            self._total = self._total + self._pull(weights, time)
        else:
            self._sum = weights.copy() if self._sum is None else self._sum + weights

    @property
    def total(self) -> np.ndarray | float:
        """(np, rows) weights of the parameters."""
        return self._total if self._sum is None else self._pull(self._sum, 0.0)

    def _pull(self, weights: np.ndarray, time: float) -> np.ndarray:
        columns = [self.source.pull(self.p, w, time) for w in weights.T]
        return np.stack(columns, axis=1)


@dataclass
class InstantWeights:
    """Weights (n, rows) of the equations and of the applied forces at one instant."""

    motion: Motions
    time: float
    equations: np.ndarray
    loads: np.ndarray


class ParameterWeights:
    """Weights of the parameters from multipliers of the equations of motion along a run.

    Parameters
    ----------
    equation : EquationOfMotion
    rows : number of responses
    """

    def __init__(self, equation: EquationOfMotion, rows: int):
        e = self.equation = equation
        self._linear = e.model.linearized.assembly
        self._exact, self._small = Pulls(e.assembly, e.p, rows), Pulls(self._linear, e.p, rows)
        self._steady, self._turning = Pulls(e.steady, e.p, rows), Pulls(e.turning, e.p, rows)
        self._inertia, self._springs = Products(e.steady, rows), Products(self._linear, rows)
        self._at_rest = np.zeros((e.assembly.size, rows))
        self._loads = TimedPull(e.load_case, e.p)
        self._expansion = TimedPull(e.expansion, e.p)
        self._heated = Pulls(e.heated, e.p, rows)
        self._supports = [TimedPull(array, e.p) for array in e.supports]
        self._damping = np.zeros((2, rows))
        self._own = np.zeros((e.p.size, rows))
        self._pending: list[InstantWeights] = []
        largest = max((b.degrees.size for b in e.assembly.blocks), default=1)
        self._capacity = max(1, MAX_ENTRIES // (largest * rows))

    def own(self, weights: np.ndarray) -> None:
        """Add weights (np, rows) of the parameters themselves."""
        self._own += weights

    def pull(self, source: Timed, weights: np.ndarray) -> None:
        """Add weights (n, rows) of an array that depends on parameters."""
        self.own(np.stack([source.pull(self.equation.p, w) for w in weights.T], axis=1))

    def equations(self, at: Instant, weights: np.ndarray) -> None:
        """Add ``ηᵀ ∂r/∂p`` of the equations at an instant with weights (n, rows)."""
        accumulated = self._accumulated(at)
        accumulated.equations += weights
        accumulated.loads -= weights

    def loads(self, at: Instant, weights: np.ndarray) -> None:
        """Add weights (n, rows) of the applied forces alone."""
        self._accumulated(at).loads += weights

    def _accumulated(self, at: Instant) -> InstantWeights:
        """Accumulated weights of an instant, pulled to the parameters together."""
        if not self._pending or self._pending[-1].motion is not at.motion:
            if len(self._pending) >= self._capacity:
                self._flush()
            self._pending.append(
                InstantWeights(at.motion, at.time, *np.zeros((2, *self._at_rest.shape)))
            )
        return self._pending[-1]

    def supports(self, weights: Motions, time: float) -> None:
        """Add weights (held, rows) of prescribed displacements, velocities, accelerations."""
        for pull, weight in zip(self._supports, weights, strict=True):
            pull.add(weight, time)

    @property
    def total(self) -> np.ndarray:
        """(np, rows) weights of the parameters."""
        self._flush()
        e, lumped = self.equation, self.equation.lumped
        self._steady.products(
            self._inertia, lambda k, x, d, w: k.pull_inertia(from_rest(x), d, w, lumped)
        )
        self._small.products(self._springs, _pull_stiffness)
        if e.linear:
            zero = np.zeros((e.assembly.size, 1))
            self._small.forces(zero, self._at_rest[:, None, :])
        pulls = self._exact, self._small, self._steady, self._turning, self._heated
        timed = self._loads, self._expansion, *self._supports
        total = self._own + sum(pull.total for pull in pulls) + sum(pull.total for pull in timed)
        damping = [e.damping.pull(e.p, w) for w in self._damping.T]
        return total + np.stack(damping, axis=1)

    def _flush(self) -> None:
        if not self._pending:
            return
        e = self.equation
        for w in self._pending:
            self._loads.add(w.loads, w.time)
            self._expansion.add(-w.equations, w.time)
        motions = zip(*(w.motion for w in self._pending), strict=True)
        u, v, a = (np.stack(columns, axis=1) for columns in motions)
        eta = np.stack([w.equations for w in self._pending], axis=1)
        self._pending = []
        driven = a + e.alpha * v
        self._inertia.add(driven, eta)
        self._turning.inertia((u, v, driven), eta, e.lumped)
        if e.linear:
            self._springs.add(u + e.beta * v, eta)
            self._at_rest += eta.sum(axis=1)
        else:
            self._exact.forces(u, eta)
            self._heated.forces(u, eta)
            if e.beta:
                self._springs.add(e.beta * v, eta)
        for k, damped in enumerate((e.momentum(u, v), e.stiffness @ v)):
            self._damping[k] += np.einsum("ns,nsr->r", damped, eta)


class ParameterChanges:
    """Changes of the equations of motion along several directions of the parameters.

    Parameters
    ----------
    equation : EquationOfMotion
    directions : (np, c) changes of the parameters
    """

    def __init__(self, equation: EquationOfMotion, directions: np.ndarray):
        e = self.equation = equation
        self.directions = directions
        self._exact = Pushes(e.assembly, e.p, directions)
        self._heated = Pushes(e.heated, e.p, directions)
        small = Pushes(e.model.linearized.assembly, e.p, directions)
        steady, self._turning = (Pushes(part, e.p, directions) for part in (e.steady, e.turning))
        self._mass = steady.matrices(
            lambda k, x, d, dd: k.push_inertia(from_rest(x), d, dd, e.lumped)
        )
        self._stiffness = small.matrices(_push_stiffness)
        self._at_rest = small.forces(np.zeros(e.assembly.size))
        self._damping = self.each(e.damping)
        self._constant: dict[int, np.ndarray] = {}

    def each(self, source: Timed, time: float = 0.0) -> np.ndarray:
        """(n, c) changes of an array that depends on parameters and time."""
        e = self.equation
        return np.stack([source.push(e.p, dp, time) for dp in self.directions.T], axis=1)

    def equations(self, m: Motions) -> np.ndarray:
        """(n, c) changes of ``g`` at a motion (n,)."""
        e, count = self.equation, self.directions.shape[1]
        driven = m.a + e.alpha * m.v
        change = (self._mass @ driven).reshape(count, -1).T
        if e.turns:
            change = change + self._turning.inertia((m.u, m.v, driven), e.lumped)
        strained = m.u + e.beta * m.v if e.linear else e.beta * m.v
        if e.linear or e.beta:
            change = change + (self._stiffness @ strained).reshape(count, -1).T
        if e.linear:
            change = change + self._at_rest
        else:
            change = change + self._exact.forces(m.u) + self._heated.forces(m.u)
        if self._damping.any():
            change = change + np.outer(e.momentum(m.u, m.v), self._damping[0])
            change = change + np.outer(e.stiffness @ m.v, self._damping[1])
        return change

    def loads(self, time: float) -> np.ndarray:
        """(n, c) changes of the applied forces."""
        return self._timed(self.equation.load_case, time)

    def expansion(self, time: float) -> np.ndarray:
        """(n, c) changes of the forces of restrained thermal expansion."""
        return self._timed(self.equation.expansion, time)

    def supports(self, time: float) -> Motions:
        """(held, c) changes of prescribed displacements, velocities and accelerations."""
        return Motions(*(self._timed(array, time) for array in self.equation.supports))

    def _timed(self, source: Timed, time: float) -> np.ndarray:
        if source.depends_on_time:
            return self.each(source, time)
        if id(source) not in self._constant:
            self._constant[id(source)] = self.each(source)
        return self._constant[id(source)]


def _pull_stiffness(kind: ElementKind, x, data, weights) -> np.ndarray:
    """Weights of the data in ``wᵀ K x``, the forces of small displacements minus those at rest."""
    return kind.pull(x, data, weights) - kind.pull(np.zeros_like(x), data, weights)


def _push_stiffness(kind: ElementKind, x, data, change) -> np.ndarray:
    """Change of ``K x`` along a change of the data."""
    return kind.push(x, data, change) - kind.push(np.zeros_like(x), data, change)
