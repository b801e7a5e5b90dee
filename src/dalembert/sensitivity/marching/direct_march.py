"""Direct gradients of dynamics: forward march with ``∂x/∂p``."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.step_outputs import alike
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.marching.tangent_march import TangentMarch, side_by_side
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.once import once

OnOutput = Callable[[int, int, np.ndarray], None]
OnStates = Callable[[int, np.ndarray, np.ndarray], None]


class DirectMarch:
    """Gradients of sampled responses of one run with respect to chosen parameters.

    Parameters
    ----------
    samples : samples of the same steps
    columns : numbers of the parameters
    """

    def __init__(self, samples: Sequence[Sample], columns: Sequence[int]):
        self.marched = [MarchedSample(sample) for sample in samples]
        self.columns = tuple(columns)
        self.width = len(self.columns)

    def gradient(self) -> np.ndarray:
        """(responses, columns) derivatives by one march over the steps with all columns."""
        gradient = np.zeros((len(self.marched), self.width))

        def add(row: int, k: int, rates: np.ndarray) -> None:
            gradient[row] += self.marched[row].sample.weights[k] * rates

        def add_instants(first: int, changes: np.ndarray, unit: np.ndarray) -> None:
            for row, sample in enumerate(self.marched):
                for instant in sample.instants:
                    if 0 <= instant.number - first < len(changes):
                        gradient[row] += changes[instant.number - first] @ instant.x
                        gradient[row] += instant.p @ unit

        self._march(add, add_instants)
        return gradient

    def samples(self) -> list[np.ndarray]:
        """(K, columns) derivatives of the samples with nonzero weight, for each response."""
        derivatives = [np.zeros((sample.modes.size, self.width)) for sample in self.marched]

        def store(row: int, k: int, rates: np.ndarray) -> None:
            derivatives[row][k] = rates

        self._march(store)
        return derivatives

    def _march(self, on_output: OnOutput, on_states: OnStates | None = None) -> None:
        """March over the steps with callbacks.

        ``on_output`` is called with row, sample and its derivatives, ``on_states`` with the number
        of a state, the changes (states, columns, n) from it on and the directions.
        """
        if not (self.marched and self.width):
            return
        run = self.marched[0]
        unit = run.model.tangents(run.p, self.columns)

        def evaluate(first: int, changes: np.ndarray) -> None:
            if on_states is not None:
                on_states(first, changes, unit)
            for row, sample in enumerate(self.marched):
                chosen = sample.active_outputs(first, first + len(changes) - 1)
                if chosen.size:
                    tangents = march.at_outputs(sample, chosen, first, changes)
                    for k, rates in self._rates(sample, chosen, tangents, unit):
                        on_output(row, k, rates)

        march = TangentMarch(run, unit, evaluate)
        march.forwards()

    def _rates(
        self, sample: MarchedSample, chosen: np.ndarray, tangents: np.ndarray, unit: np.ndarray
    ) -> Iterator[tuple[int, np.ndarray]]:
        """Outputs and the derivatives (columns,) of the measure at each."""
        states = sample.states_at(chosen)
        for mode, part in alike(sample.modes[chosen], np.arange(chosen.size)):
            size = sample.step_of(mode).state_size
            measured = _measured(sample.measured(sample.kernel.variants[mode]), self.width)
            rates = sample.kernel.over(measured, part.size)(
                sample.motion.time[chosen[part]],
                states[:size, part],
                np.tile(sample.p[:, None], part.size),
                side_by_side(tangents[part][:, :, :size]),
                np.tile(unit, part.size),
            )[0]
            rows = rates.reshape(part.size, -1)
            yield from zip((int(chosen[j]) for j in part), rows, strict=True)


@once
def _measured(function: ImplicitFunction, columns: int) -> ca.Function:
    return function.tangents(columns)
