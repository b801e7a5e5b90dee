"""Direct gradients of dynamics: ``∂x/∂p`` is carried along, and measures see it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.step_outputs import columns_by_mode
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.marching.tangent_march import TangentMarch, beside
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.once import once

Take = Callable[[int, int, np.ndarray], None]
Pass = Callable[[int, np.ndarray, np.ndarray], None]


class DirectMarch:
    """Gradients of sampled responses of one run with respect to chosen parameters.

    Parameters
    ----------
    samples : of the same steps
    columns : numbers of the parameters
    """

    def __init__(self, samples: Sequence[Sample], columns: Sequence[int]):
        self.seen = [MarchedSample(sample) for sample in samples]
        self.columns = tuple(columns)
        self.width = len(self.columns)

    def gradient(self) -> np.ndarray:
        """(responses, columns) by one march over the steps with all columns."""
        gradient = np.zeros((len(self.seen), self.width))

        def add(row: int, k: int, rates: np.ndarray) -> None:
            gradient[row] += self.seen[row].sample.weights[k] * rates

        def add_instants(first: int, changes: np.ndarray, unit: np.ndarray) -> None:
            for row, sample in enumerate(self.seen):
                for instant in sample.instants:
                    if 0 <= instant.number - first < len(changes):
                        gradient[row] += changes[instant.number - first] @ instant.x
                        gradient[row] += instant.p @ unit

        self._march(add, add_instants)
        return gradient

    def samples(self) -> list[np.ndarray]:
        """(K, columns) derivatives of the samples that have a weight, for each response."""
        found = [np.zeros((sample.modes.size, self.width)) for sample in self.seen]

        def keep(row: int, k: int, rates: np.ndarray) -> None:
            found[row][k] = rates

        self._march(keep)
        return found

    def _march(self, take: Take, pass_states: Pass | None = None) -> None:
        """One march over the steps.

        ``take`` is called with row, sample and its derivatives, ``pass_states`` with the number of
        a state, the changes (states, columns, n) from it on and the directions.
        """
        if not (self.seen and self.width):
            return
        run = self.seen[0]
        unit = run.model.tangents(run.p, self.columns)

        def look(first: int, changes: np.ndarray) -> None:
            if pass_states is not None:
                pass_states(first, changes, unit)
            for row, sample in enumerate(self.seen):
                chosen = sample.seen(first, first + len(changes) - 1)
                if chosen.size:
                    moved = march.at_outputs(sample, chosen, first, changes)
                    for k, rates in self._rates(sample, chosen, moved, unit):
                        take(row, k, rates)

        march = TangentMarch(run, unit, look)
        march.forwards()

    def _rates(
        self, sample: MarchedSample, chosen: np.ndarray, moved: np.ndarray, unit: np.ndarray
    ) -> Iterator[tuple[int, np.ndarray]]:
        """Outputs, and the derivatives (columns,) of the measure there."""
        states = sample.states_at(chosen)
        for mode, part in columns_by_mode(sample.modes[chosen], np.arange(chosen.size)):
            size = sample.step_of(mode).state_size
            measured = _measured(sample.measured(sample.kernel.variants[mode]), self.width)
            rates = sample.kernel.over(measured, part.size)(
                sample.motion.time[chosen[part]],
                states[:size, part],
                np.tile(sample.p[:, None], part.size),
                beside(moved[part][:, :, :size]),
                np.tile(unit, part.size),
            )[0]
            rows = rates.reshape(part.size, -1)
            yield from zip((int(chosen[j]) for j in part), rows, strict=True)


@once
def _measured(function: ImplicitFunction, columns: int) -> ca.Function:
    return function.tangents(columns)
