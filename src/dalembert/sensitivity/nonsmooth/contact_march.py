"""Direct and adjoint gradients of nonsmooth time stepping, step by step."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.marching.walk import BackwardWalk, ForwardWalk
from dalembert.sensitivity.nonsmooth.contact_steps import contact_steps
from dalembert.sensitivity.nonsmooth.moving_impacts import step_tangent
from dalembert.sensitivity.samples import Sample
from dalembert.sparse.single_thread import single_thread

StateWeights = tuple[np.ndarray, np.ndarray]
"""Weights (n, r) of a state, and (np, r) of the parameters."""


class ContactPass:
    """Common base of the direct and the adjoint march.

    Parameters
    ----------
    samples : samples of the same run
    """

    def __init__(self, samples: Sequence[Sample]):
        self.samples = list(samples)
        self.steps = contact_steps(samples[0].motion)
        self.p, self.rows = self.steps.p, len(self.samples)
        self.weights: dict[int, StateWeights] = {}
        for row, sample in enumerate(self.samples):
            self._add_sample(row, sample)

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.steps.count

    def _add_sample(self, row: int, sample: Sample) -> None:
        """Distribute the weights of a response to the ends of steps."""
        t, slopes = self.steps.record.t, _slopes(sample)
        slack = 1e-12 * max(abs(t[0]), abs(t[-1]))
        for k in np.flatnonzero(sample.weights):
            time = sample.motion.time[k]
            n = int(np.clip(np.searchsorted(t, time - slack), 0, t.size - 1))
            share = 1.0 if n == 0 else (time - t[n - 1]) / (t[n] - t[n - 1])
            ends = [(n, 1.0)] if abs(t[n] - time) <= slack else [(n, share), (n - 1, 1 - share)]
            if len(ends) > 1 and not self.steps.maps.e.manifold.flat:
                raise UnsupportedError(
                    "gradients between the ends of steps are not available for rotations in "
                    "space; choose outputs that are multiples of the step"
                )
            trajectory = sample.motion.trajectory
            state = time, trajectory.y[:, k], trajectory.v[:, k], self.p
            by_x, by_p = (sample.weights[k] * s.full().ravel() for s in slopes(*state))
            for number, part in ends:
                x_bar, p_bar = self._weights_at(number)
                x_bar[:, row] += part * by_x
                p_bar[:, row] += part * by_p

    def _weights_at(self, number: int) -> StateWeights:
        size = self.steps.x.shape[0]
        empty = np.zeros((size, self.rows)), np.zeros((self.p.size, self.rows))
        return self.weights.setdefault(number, empty)

    def start(self) -> tuple[float, np.ndarray]:
        """Instant and positions of the start."""
        return float(self.steps.record.t[0]), self.steps.split(0)[0]


class ContactAdjoint(ContactPass, BackwardWalk[np.ndarray]):
    """Gradients of all responses by one march backwards."""

    @single_thread()
    def gradient(self) -> np.ndarray:
        """(rows, np) gradients."""
        self.p_bar = np.zeros((self.p.size, self.rows))
        self.backwards()
        return self.p_bar.T

    def depart(self) -> np.ndarray:
        return self._add_parameters(self.count)

    def _add_parameters(self, number: int) -> np.ndarray:
        """Weights of a state, with those of the parameters added to ``p_bar``."""
        x_bar, p_bar = self._weights_at(number)
        self.p_bar += p_bar
        return x_bar

    def pull(self, begin: int, end: int, weights: np.ndarray) -> np.ndarray:
        weights, p_bar = step_tangent(self.steps, begin).pull(weights)
        self.p_bar += p_bar
        self.steps.observe_growth(weights)
        return weights + self._add_parameters(begin)

    def pull_start(self, weights: np.ndarray) -> None:
        (t, y), size = self.start(), self.steps.size
        adjoint = self.samples[0].motion.model.initial_state.adjoint
        for row, column in enumerate(weights.T):
            parts = adjoint(t, y, self.p, column[:size], column[size:])
            self.p_bar[:, row] += parts[2].full().ravel()


class ContactDirect(ContactPass, ForwardWalk[np.ndarray]):
    """Derivatives of the motion by several parameters together.

    Parameters
    ----------
    samples : samples of the same run
    columns : numbers of the parameters
    """

    def __init__(self, samples: Sequence[Sample], columns: Sequence[int]):
        super().__init__(samples)
        self.directions = samples[0].motion.model.tangents(self.p, columns)
        self.derivatives = np.zeros((self.rows, len(columns)))

    @single_thread()
    def gradient(self) -> np.ndarray:
        """(rows, columns) derivatives."""
        self.forwards()
        return self.derivatives

    def push_start(self) -> np.ndarray:
        (t, y), c = self.start(), self.directions.shape[1]
        tangent = self.samples[0].motion.model.initial_state.tangent.map(c)
        parts = tangent(t, y, self.p, 0, np.zeros((y.size, c)), self.directions)
        return np.vstack([part.full() for part in parts])

    def push(self, begin: int, end: int, change: np.ndarray) -> np.ndarray:
        self._evaluate(begin, change)
        change = step_tangent(self.steps, begin).push(change, self.directions)
        self.steps.observe_growth(change)
        return change

    def arrive(self, change: np.ndarray) -> None:
        self._evaluate(self.count, change)

    def _evaluate(self, number: int, change: np.ndarray) -> None:
        if number in self.weights:
            x_bar, p_bar = self.weights[number]
            self.derivatives += x_bar.T @ change + p_bar.T @ self.directions


class ContactEngine(Engine):
    """Gradient engine of ``solve_nonsmooth``.

    Raises
    ------
    UnsupportedError
        Bodies may have slept in the run.
    """

    def __init__(self, samples: Sequence[Sample]):
        super().__init__(samples)
        if samples[0].motion.analysis.sleep_after is not None:
            raise UnsupportedError(
                "the run has sleep_after: bodies that sleep do not follow their equations of "
                "motion, so that there are no gradients; leave it out"
            )

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return ContactDirect(self.samples, columns).gradient()

    def adjoint(self) -> np.ndarray:
        return self.parameter_gradients(list(ContactAdjoint(self.samples).gradient()))


def _slopes(sample: Sample) -> ca.Function:
    """``(t, y, v, p) → ∂m/∂(y, v), ∂m/∂p``.

    Raises
    ------
    UnsupportedError
        The measure needs accelerations or reactions.
    """
    model = sample.motion.model
    e, measure = model.all_equations, model.at_ground(sample.measure.sx)
    arguments = ca.vertcat(e.t, e.y, e.v, e.p)
    allowed = {symbol.element_hash() for symbol in ca.vertsplit(arguments)}
    if any(symbol.element_hash() not in allowed for symbol in ca.symvar(measure)):
        raise UnsupportedError(
            f"{sample.measure.name or 'the measure'} depends on accelerations, reactions or "
            "energies taken over time, which are means over steps with contacts: no gradient; use "
            "a measure of positions and speeds"
        )
    slopes = [ca.jacobian(measure, by) for by in (ca.vertcat(e.y, e.v), e.p)]
    return ca.Function("slopes", [e.t, e.y, e.v, e.p], [ca.densify(s) for s in slopes])
