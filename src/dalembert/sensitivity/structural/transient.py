"""Gradients of structural transients: exact derivatives of the steps taken.

The adjoint method marches backward through the steps, the direct method forward with all parameters
together; both use the factors of the run, or of the tangent at each state.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dalembert.analysis.transient.equation import Motions, motion_of
from dalembert.analysis.transient.instant import Instant
from dalembert.analysis.transient.step import TransientStep
from dalembert.integrators.newmark.rule import Moving
from dalembert.results.structural.measured_states import Formula
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.marching.walk import BackwardWalk, ForwardWalk
from dalembert.sensitivity.samples import Sample, SampledOutputs
from dalembert.sensitivity.structural.transient_parameters import ParameterChanges, ParameterWeights

Output = tuple[int, int]
"""Number of a response and of one of its outputs."""


class StateWeights(NamedTuple):
    """Weights of the state at one instant; columns by response.

    Attributes
    ----------
    u, v, a, forces : (n, rows)
    p : (np, rows)
    """

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    forces: np.ndarray
    p: np.ndarray


class WeighedOutputs:
    """Outputs with nonzero weights in sampled responses of one run.

    Parameters
    ----------
    samples : samples of the same run

    Attributes
    ----------
    ends : number of steps → outputs at the end of the last one
    inside : number of steps → length of the partial step after them → outputs at its end
    """

    def __init__(self, samples: Sequence[Sample]):
        self.samples = list(samples)
        self.record = self.samples[0].motion.record
        self._formulas = [Formula(s.motion, s.measure.sx) for s in self.samples]  # type: ignore[arg-type]
        self.ends: dict[int, list[Output]] = {}
        self.inside: dict[int, dict[float, list[Output]]] = {}
        for r, sample in enumerate(self.samples):
            self._add_sample(r, sample)

    def _add_sample(self, r: int, sample: Sample) -> None:
        outputs = SampledOutputs(sample)
        for k in (int(k) for k in outputs.active):
            node = int(outputs.number[k])
            if outputs.within[k]:
                length = float(outputs.places.length[k])
                self.inside.setdefault(node, {}).setdefault(length, []).append((r, k))
            else:
                self.ends.setdefault(node, []).append((r, k))

    def motion(self, output: Output):
        """The motion of an output."""
        return self.samples[output[0]].motion

    def weights(self, outputs: Sequence[Output], size: int, parameters: int) -> StateWeights:
        """Sum of the weights of these outputs, which are at the same instant."""
        rows = len(self.samples)
        u, v, a, forces = (np.zeros((size, rows)) for _ in range(4))
        p = np.zeros((parameters, rows))
        for r, k in outputs:
            w = self._formulas[r].weights(k, float(self.samples[r].weights[k]))
            parts = (w.u, w.v, w.a, w.forces, w.p)  # type: ignore[attr-defined]
            for column, weight in zip((u, v, a, forces, p), parts, strict=True):
                column[:, r] += weight
        return StateWeights(u, v, a, forces, p)


MAX_ENTRIES = 30_000_000
"""Upper limit of stored entries of element matrices, times responses, in one march."""


class TransientPass:
    """Common base of the direct and the adjoint march.

    Parameters
    ----------
    samples : samples of the same run
    """

    parameters: ParameterChanges | ParameterWeights

    def __init__(self, samples: Sequence[Sample]):
        self.outputs = WeighedOutputs(samples)
        self.march = self.outputs.record.march
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

    def state_before_step(self, node: int) -> Instant:
        """State at the start of the step from a node."""
        return self.at(node, False)

    def state_after_step(self, node: int) -> Instant:
        """State at the end of the step to a node, before replacement of rotation vectors."""
        return self.at(node, node in self.march.shortened)

    def step_to(self, node: int) -> TransientStep:
        """The step that ends at a node."""
        return self.march.step(float(self.steps.h[node - 1]))

    def parts(self, node: int) -> list[tuple[TransientStep, Instant, list[Output]]]:
        """Partial steps from a node to outputs inside the next step, and the outputs there."""
        parts = []
        for length, outputs in self.outputs.inside.get(node, {}).items():
            step = TransientStep(self.equation, self.march.analysis.integrator, length)
            motion, k = self.outputs.motion(outputs[0]), outputs[0][1]
            states = motion.displacements, motion.velocities, motion.accelerations
            state = Motions(*(x[:, k] for x in states))
            time = float(self.steps.t[node]) + length
            parts.append((step, Instant(self.equation, state, time, self.parameters), outputs))
        return parts

    def weights(self, outputs: Sequence[Output]) -> StateWeights:
        """Weights of the state at an instant in the responses."""
        return self.outputs.weights(outputs, self.size, self.equation.p.size)


class TransientAdjoint(TransientPass, BackwardWalk[Moving]):
    """Gradients of all responses by one backward march."""

    def gradient(self) -> np.ndarray:
        """(rows, np) derivatives."""
        self.parameters: ParameterWeights = ParameterWeights(self.equation, self.rows)
        self.backwards()
        return self.parameters.total.T

    def depart(self) -> Moving:
        return self._add_outputs_from(self.count, self._zero())

    def pull(self, begin: int, end: int, weights: Moving) -> Moving:
        march = self.march
        if end in march.shortened:
            weights = march.charts.pull(march.arrived(end), march.shortened[end], weights)
        weights = self.step_to(end).pull(self.state_after_step(end), weights)
        return self._add_outputs_from(begin, weights)

    def pull_start(self, weights: Moving) -> None:
        self.start.pull(self.state_before_step(0), weights)

    def _zero(self) -> Moving:
        return Moving(*np.zeros((4, self.size, self.rows)))

    def _add_outputs_from(self, node: int, weights: Moving) -> Moving:
        """Add the weights of the outputs at a node and inside the next step."""
        for step, end, outputs in self.parts(node):
            back = step.pull(end, self._add_outputs(end, outputs, self._zero()))
            weights = Moving(*(a + b for a, b in zip(weights, back, strict=True)))
        outputs = self.outputs.ends.get(node, [])
        return (
            self._add_outputs(self.state_before_step(node), outputs, weights)
            if outputs
            else weights
        )

    def _add_outputs(self, at: Instant, outputs: list[Output], weights: Moving) -> Moving:
        """Add the weights of outputs; weights of reactions become weights of the motion."""
        more = self.weights(outputs)
        self.parameters.own(more.p)
        motion = Motions(weights.u + more.u, weights.v + more.v, weights.a + more.a)
        if more.forces.any():
            of_forces = at.pull_forces(more.forces)
            motion = Motions(*(a + b for a, b in zip(motion, of_forces, strict=True)))
        return Moving(*motion, weights.s)


class TransientDirect(TransientPass, ForwardWalk[Moving]):
    """Derivatives of the motion by several parameters together.

    Parameters
    ----------
    samples : samples of the same run
    columns : numbers of the parameters
    """

    def __init__(self, samples: Sequence[Sample], columns: Sequence[int]):
        super().__init__(samples)
        self.columns = list(columns)
        directions = np.eye(self.equation.p.size)[:, self.columns]
        self.parameters = ParameterChanges(self.equation, directions)
        self.derivatives = np.zeros((self.rows, len(self.columns)))

    def gradient(self) -> np.ndarray:
        """(rows, columns) derivatives."""
        self.forwards()
        return self.derivatives

    def push_start(self) -> Moving:
        return self.start.push(self.state_before_step(0))

    def push(self, begin: int, end: int, change: Moving) -> Moving:
        self._evaluate_from(begin, change)
        march = self.march
        change = self.step_to(end).push(self.state_after_step(end), change)
        if end in march.shortened:
            change = march.charts.push(march.arrived(end), march.shortened[end], change)
        return change

    def arrive(self, change: Moving) -> None:
        self._evaluate_from(self.count, change)

    def _evaluate_from(self, node: int, change: Moving) -> None:
        """Evaluate the responses at a node and inside the next step."""
        if outputs := self.outputs.ends.get(node, []):
            self._evaluate(self.state_before_step(node), outputs, change)
        for step, end, outputs in self.parts(node):
            self._evaluate(end, outputs, step.push(end, change))

    def _evaluate(self, at: Instant, outputs: list[Output], change: Moving) -> None:
        weights = self.weights(outputs)
        self.derivatives += weights.p[self.columns].T
        pairs = (weights.u, change.u), (weights.v, change.v), (weights.a, change.a)
        for weight, part in pairs:
            self.derivatives += weight.T @ part
        if weights.forces.any():
            self.derivatives += weights.forces.T @ at.push_forces(motion_of(change))


class TransientEngine(Engine):
    """Gradient engine of linear and nonlinear structural transients."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return TransientDirect(self.samples, columns).gradient()

    def adjoint(self) -> np.ndarray:
        blocks = self.samples[0].motion.record.march.equation.assembly.blocks
        size = sum(b.count * b.kind.displacement_count**2 for b in blocks)
        width = max(1, MAX_ENTRIES // max(size, 1))
        groups = range(0, len(self.samples), width)
        return np.concatenate(
            [TransientAdjoint(self.samples[k : k + width]).gradient() for k in groups]
        )
