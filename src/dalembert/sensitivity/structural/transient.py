"""Gradients of transients: exact derivatives of the steps that were taken.

The adjoint goes backward through the steps, the direct method forward with all parameters at once;
both with the factors of the run, or of the tangent at each state.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from dalembert.analysis.structural.instant import Instant
from dalembert.analysis.structural.transient_equation import Motions, motion_of
from dalembert.analysis.structural.transient_step import TransientStep
from dalembert.integrators.newmark.rule import Moving
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.marching.walk import BackwardWalk, ForwardWalk
from dalembert.sensitivity.samples import Sample
from dalembert.sensitivity.structural.transient_outputs import Look, Looks, Seen
from dalembert.sensitivity.structural.transient_parameters import ParameterChanges, ParameterWeights

NUMBERS = 30_000_000
"""Entries of element matrices, times responses, that one march keeps."""


class TransientPass:
    """What both directions share.

    Parameters
    ----------
    samples : of the same run
    """

    parameters: ParameterChanges | ParameterWeights

    def __init__(self, samples: Sequence[Sample]):
        self.looks = Looks(samples)
        self.march = self.looks.record.march
        self.steps, self.start = self.march.steps, self.march.start
        self.equation = e = self.march.equation
        self.size, self.rows = e.assembly.size, len(samples)
        self.at = lru_cache(maxsize=1)(self._at)

    @property
    def count(self) -> int:
        """Number of steps."""
        return int(self.steps.count)

    def _at(self, node: int, arrived: bool) -> Instant:
        march, steps = self.march, self.steps
        time = float(steps.t[node]) if node < steps.count else steps.end
        state = march.arrived(node) if arrived else march.node(node)
        return Instant(self.equation, motion_of(state), time, self.parameters)

    def begun(self, node: int) -> Instant:
        """Where steps begin."""
        return self.at(node, False)

    def ended(self, node: int) -> Instant:
        """The same as a step left it, before rotation vectors were replaced."""
        return self.at(node, node in self.march.shortened)

    def arriving(self, node: int) -> TransientStep:
        """The step that ends at a node."""
        return self.march.step(float(self.steps.h[node - 1]))

    def parts(self, node: int) -> list[tuple[TransientStep, Instant, list[Look]]]:
        """Steps from a node to outputs between the ends of steps, and who looks there."""
        found = []
        for length, looks in self.looks.inside.get(node, {}).items():
            step = TransientStep(self.equation, self.march.analysis.integrator, length)
            motion, k = self.looks.motion(looks[0]), looks[0][1]
            states = motion.displacements, motion.velocities, motion.accelerations
            there = Motions(*(x[:, k] for x in states))
            time = float(self.steps.t[node]) + length
            found.append((step, Instant(self.equation, there, time, self.parameters), looks))
        return found

    def seen(self, looks: Sequence[Look]) -> Seen:
        """What the responses weigh at an instant."""
        return self.looks.seen(looks, self.size, self.equation.p.size)


class TransientAdjoint(TransientPass, BackwardWalk[Moving]):
    """Gradients of all responses by one march backward."""

    def gradient(self) -> np.ndarray:
        """(rows, np) derivatives."""
        self.parameters: ParameterWeights = ParameterWeights(self.equation, self.rows)
        self.backwards()
        return self.parameters.total.T

    def depart(self) -> Moving:
        return self._seen_from(self.count, self._none())

    def pull(self, begin: int, end: int, weights: Moving) -> Moving:
        march = self.march
        if end in march.shortened:
            weights = march.charts.pull(march.arrived(end), march.shortened[end], weights)
        weights = self.arriving(end).pull(self.ended(end), weights)
        return self._seen_from(begin, weights)

    def pull_start(self, weights: Moving) -> None:
        self.start.pull(self.begun(0), weights)

    def _none(self) -> Moving:
        return Moving(*np.zeros((4, self.size, self.rows)))

    def _seen_from(self, node: int, weights: Moving) -> Moving:
        """Add what is seen there and inside the step that follows."""
        for step, end, looks in self.parts(node):
            back = step.pull(end, self._seen(end, looks, self._none()))
            weights = Moving(*(a + b for a, b in zip(weights, back, strict=True)))
        looks = self.looks.ends.get(node, [])
        return self._seen(self.begun(node), looks, weights) if looks else weights

    def _seen(self, at: Instant, looks: list[Look], weights: Moving) -> Moving:
        """Add what is seen there; reactions are such of the motion that needs them."""
        seen = self.seen(looks)
        self.parameters.own(seen.p)
        motion = Motions(weights.u + seen.u, weights.v + seen.v, weights.a + seen.a)
        if seen.forces.any():
            more = at.pull_forces(seen.forces)
            motion = Motions(*(a + b for a, b in zip(motion, more, strict=True)))
        return Moving(*motion, weights.s)


class TransientDirect(TransientPass, ForwardWalk[Moving]):
    """Derivatives of the whole motion by some parameters, all at once.

    Parameters
    ----------
    samples : of the same run
    columns : numbers of the parameters
    """

    def __init__(self, samples: Sequence[Sample], columns: Sequence[int]):
        super().__init__(samples)
        self.columns = list(columns)
        directions = np.eye(self.equation.p.size)[:, self.columns]
        self.parameters = ParameterChanges(self.equation, directions)
        self.found = np.zeros((self.rows, len(self.columns)))

    def gradient(self) -> np.ndarray:
        """(rows, columns) derivatives."""
        self.forwards()
        return self.found

    def push_start(self) -> Moving:
        return self.start.push(self.begun(0))

    def push(self, begin: int, end: int, change: Moving) -> Moving:
        self._see_from(begin, change)
        march = self.march
        change = self.arriving(end).push(self.ended(end), change)
        if end in march.shortened:
            change = march.charts.push(march.arrived(end), march.shortened[end], change)
        return change

    def arrive(self, change: Moving) -> None:
        self._see_from(self.count, change)

    def _see_from(self, node: int, change: Moving) -> None:
        """Responses see the changes there and inside the step that follows."""
        if looks := self.looks.ends.get(node, []):
            self._see(self.begun(node), looks, change)
        for step, end, looks in self.parts(node):
            self._see(end, looks, step.push(end, change))

    def _see(self, at: Instant, looks: list[Look], change: Moving) -> None:
        seen = self.seen(looks)
        self.found += seen.p[self.columns].T
        for weight, part in ((seen.u, change.u), (seen.v, change.v), (seen.a, change.a)):
            self.found += weight.T @ part
        if seen.forces.any():
            self.found += seen.forces.T @ at.push_forces(motion_of(change))


class TransientEngine(Engine):
    """Transients of structures, linear or not."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return TransientDirect(self.samples, columns).gradient()

    def adjoint(self) -> np.ndarray:
        blocks = self.samples[0].motion.record.march.equation.assembly.blocks
        size = sum(b.count * b.kind.displacement_count**2 for b in blocks)
        most = max(1, NUMBERS // max(size, 1))
        groups = range(0, len(self.samples), most)
        return np.concatenate(
            [TransientAdjoint(self.samples[k : k + most]).gradient() for k in groups]
        )
