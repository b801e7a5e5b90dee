"""Direct gradients of dynamics: forward march of ``∂x/∂p`` in chunks, over all directions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property

import numpy as np

from dalembert.analysis.dynamics.step_outputs import columns_by_mode
from dalembert.integrators.marching.march import CHUNK
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.marching.walk import ForwardWalk
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.evaluation.lane_tangents import LaneTangents
from dalembert.symbolic.evaluation.prelude import Prelude

MAX_ENTRIES = 1 << 18
"""Upper limit of the entries of all changes in a chunk of steps."""


class TangentMarch(ForwardWalk[np.ndarray]):
    """March of ``dx`` over the recorded steps, one column per direction.

    Parameters
    ----------
    run : a sample of the run
    unit : (np, c) directions
    on_states : called with the number of a state and the changes (states, c, n) from it on
    """

    def __init__(
        self, run: MarchedSample, unit: np.ndarray, on_states: Callable[[int, np.ndarray], None]
    ):
        self.run, self.unit, self.on_states, self.width = run, unit, on_states, unit.shape[1]
        self._lane_tangents: dict[int, LaneTangents | None] = {}
        self._prelude: tuple[Prelude, np.ndarray, np.ndarray] | None = None

    @property
    def count(self) -> int:
        return self.run.count

    def ahead(self, begin: int) -> int:
        if self.run.moving is not None:
            return begin + 1
        return self.run.ahead(
            begin, int(np.clip(MAX_ENTRIES // (self.run.size * self.width), 1, CHUNK))
        )

    @cached_property
    def assembled(self) -> tuple[np.ndarray, np.ndarray]:
        """Changes of the assembled poses and speeds."""
        run, c = self.run, self.width
        y, t = run.assembled()[0], float(run.steps.t[0])
        tangent, near = run.model.initial_state.tangent.map(c), np.zeros((y.size, c))
        dy, dv = tangent(t, y, run.p, 0, near, self.unit)
        return dy.full(), dv.full()

    def push_start(self) -> np.ndarray:
        """(n, c) changes of the first state."""
        run, c, unit = self.run, self.width, self.unit
        p, t = run.p, float(run.steps.t[0])
        start = run.kernel.start.tangent.map(c)
        dx = start(t, *run.assembled(), p, 0, *self.assembled, unit).full()
        first = run.first_step
        if first.begin is None:
            return dx
        x0 = run.steps.x[: first.state_size, 0]
        more = first.begin.tangent.map(c)(t, x0, p, 0, dx, unit)
        return np.vstack([dx, more.full()])

    def push(self, begin: int, end: int, change: np.ndarray) -> np.ndarray:
        out = self._forward(begin, end, change)
        if self.run.moving is not None:
            out = out + self.run.moving.push(begin, end, self.unit).transpose(1, 2, 0)
        self.on_states(begin, np.concatenate([change.T[None], out[:-1]]))
        return out[-1].T

    def arrive(self, change: np.ndarray) -> None:
        self.on_states(self.count, change.T.reshape(1, self.width, -1))

    def at_outputs(
        self, sample: MarchedSample, chosen: np.ndarray, first: int, changes: np.ndarray
    ) -> np.ndarray:
        """(…, c, n) changes at the chosen outputs from the changes of states from ``first`` on."""
        tangents = changes[sample.number[chosen] - first]
        for mode, part in sample.partial_steps(chosen):
            function = sample.kernel.over(sample.step_of(mode).tangents(self.width), part.size)
            along = side_by_side(tangents[part]), np.tile(self.unit, part.size)
            dx = function(*sample.partial_step_data(chosen[part]), *along)[0]
            tangents[part] = dx.reshape(-1, part.size, self.width).transpose(1, 2, 0)
        if sample.moving is not None:
            rates, slopes = sample.output_shifts(chosen)
            dt = slopes @ self.unit[: slopes.shape[1]]
            tangents = tangents + rates.T[:, None] * dt[..., None]
        return tangents

    def _forward(self, begin: int, end: int, dx: np.ndarray) -> np.ndarray:
        """(steps, c, n) changes after each of the steps between two states."""
        kernel, p, steps = self.run.kernel, self.run.p, self.run.step_data(begin, end)
        count, mode = end - begin, int(self.run.steps.mode[begin])
        step = kernel.fixed.marched(mode)
        if step.at_once:
            forward = step.chunk_tangents(count, self.width)
            return self._by_step(forward(dx, *steps, p, self.unit)[0])
        values, rates = self._prepared(step.prelude)
        if (lanes := self._lanes(mode)) is not None:
            t, h, _, x = steps
            return lanes(dx, (t[None], h[None], x), values, rates)
        columns = kernel.marched(step.tangents(self.width), (5, 6))
        columns.announce(self.count)
        return self._by_step(columns(count, dx, *steps, values, rates)[0])

    def _by_step(self, out: np.ndarray) -> np.ndarray:
        return out.T.reshape(-1, self.width, out.shape[0])

    def _prepared(self, prelude: Prelude) -> tuple[np.ndarray, np.ndarray]:
        """Values of the prelude and their rates along the directions."""
        if self._prelude is None or self._prelude[0] is not prelude:
            p, c = self.run.p, self.width
            rates = prelude.tangent.map(c)(np.tile(p[:, None], c), self.unit).full()
            self._prelude = prelude, prelude.values(p).full().ravel(), rates
        return self._prelude[1:]

    def _lanes(self, mode: int) -> LaneTangents | None:
        """Evaluator of the tangents of a mode in SIMD lanes, None if not available."""
        if mode not in self._lane_tangents:
            kernel, lanes = self.run.kernel, None
            linear = kernel.fixed.marched(mode).linear if kernel.backend.has_lanes else None
            if linear is not None:
                lanes = LaneTangents.of(linear, kernel.backend, self.count, self.width)
            self._lane_tangents[mode] = lanes
        return self._lane_tangents[mode]


def side_by_side(changes: np.ndarray) -> np.ndarray:
    """(n, instants · columns) changes from (instants, columns, n)."""
    return changes.transpose(2, 0, 1).reshape(changes.shape[2], -1)


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
        for mode, part in columns_by_mode(sample.modes[chosen], np.arange(chosen.size)):
            size = sample.step_of(mode).state_size
            measured = sample.measured(sample.kernel.variants[mode]).tangents(self.width)
            rates = sample.kernel.over(measured, part.size)(
                sample.motion.time[chosen[part]],
                states[:size, part],
                np.tile(sample.p[:, None], part.size),
                side_by_side(tangents[part][:, :, :size]),
                np.tile(unit, part.size),
            )[0]
            rows = rates.reshape(part.size, -1)
            yield from zip((int(chosen[j]) for j in part), rows, strict=True)
