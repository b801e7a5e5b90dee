"""Many copies of a stepper side by side: lanes of the processor, and threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.stepping.input_values import input_array, lane_numbers, positive_count
from dalembert.analysis.stepping.stepped_model import SteppedModel
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.symbolic.evaluation.columns import BoundCall, instructions
from dalembert.symbolic.evaluation.lanes import LaneColumns

WORTH_THREADS = 3e5
"""Operations of a step of all lanes above which threads pay."""
Arrays = Mapping[str, Any]
"""Name → a number, or one for each lane."""


class StepperLanes:
    """Copies of a stepper with their own states, parameters and inputs; from ``Stepper.lanes``.

    A lane whose step is not valid, because a number is not finite or its equations would need
    another variant, is marked in ``failed`` until it is reset; its numbers mean nothing.

    Parameters
    ----------
    plant : SteppedModel of a stepper
    count : number of lanes
    parameters : new values, numbers or arrays of one for each lane
    workers : number of threads, by default one for each core

    Attributes
    ----------
    failed : (count,) bool

    Raises
    ------
    UnsupportedError
        No llvmlite, or blocks whose samples differ between steps.
    """

    def __init__(
        self,
        plant: SteppedModel,
        count: int,
        parameters: Arrays | None = None,
        workers: int | None = None,
    ):
        self.plant, self.count = plant, positive_count("count", count)
        cores = os.cpu_count() or 1
        workers = cores if workers is None else positive_count("workers", workers)
        self._check_samples()
        _, self._mode = self.plant.start
        _check_sizes(parameters, self.count)
        self.parameters = {**plant.parameters, **(parameters or {})}
        self.map = self.plant.map(self._mode, self.plant.due(0, 0.0))
        self._values, function = self.map.split
        columns = LaneColumns(function).side_by_side
        if columns is None:
            raise UnsupportedError("lanes need llvmlite; install dalembert with it, or use Stepper")
        self._columns, self.width = columns, columns.lanes
        self.groups = -(-self.count // self.width)
        sizes = self.map.size + 1, len(self.plant.inputs), self._values.numel_out(0)
        results = self.plant.output_count, 1
        self._z = self._array(sizes[0]), self._array(sizes[0])
        self._u, self._q, self._y, self._share = map(self._array, (*sizes[1:], *results))
        self._side, self._steps = 0, np.zeros(count, dtype=int)
        self._pool: ThreadPoolExecutor | None = None
        workers = min(workers, self.groups)
        self._threaded = self.groups * instructions(function) > WORTH_THREADS
        cuts = [round(k * self.groups / workers) for k in range(workers + 1)]
        self._parts = [slice(a, b) for a, b in pairwise(cuts)]
        self._calls = [[self._bound(part, side) for side in (0, 1)] for part in self._parts]
        if workers > 1:
            self._pool = ThreadPoolExecutor(workers - 1)
        self.failed = np.zeros(self.count, dtype=bool)
        self.reset()

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise UnsupportedError(
            "lanes contain machine code and are not copied; make others by Stepper.lanes and set "
            "their states"
        )

    def _check_samples(self) -> None:
        if self.plant.phases is not None and not self.plant.phases.always:
            raise UnsupportedError(
                "lanes need samples of blocks before every substep, so that lanes may be reset at "
                "different steps; use a step and substeps of the sample time"
            )

    def _array(self, rows: int) -> np.ndarray:
        return np.zeros((self.groups, rows, self.width))

    def _bound(self, part: slice, side: int) -> BoundCall:
        """Steps of some of the groups from one of the two states to the other."""
        arguments = self._z[side], self._u, self._q
        results = self._z[1 - side], self._y, self._share
        flat = ([a[part].reshape(-1) for a in arrays] for arrays in (arguments, results))
        return self._columns.bound(part.stop - part.start, *flat)

    # layout: (groups, rows, width) in memory, (count, rows) outside ---------------------
    def _read(self, array: np.ndarray) -> np.ndarray:
        rows = array.shape[1]
        return array.transpose(0, 2, 1).reshape(-1, rows)[: self.count]

    def _write(self, array: np.ndarray, lanes: np.ndarray, values: np.ndarray) -> None:
        group, lane = np.divmod(lanes, self.width)
        array[group, :, lane] = values

    # starts ----------------------------------------------------------------------------
    def reset(
        self, lanes: Sequence[int] | np.ndarray | None = None, *, parameters: Arrays | None = None
    ) -> np.ndarray:
        """Return some lanes, by default all, to the start; returns the outputs of all.

        Parameters
        ----------
        lanes : their numbers, or a mask
        parameters : new values, numbers or arrays of one for each of these lanes; others are those
            of the lanes

        Raises
        ------
        AnalysisError
            Unknown lanes, or parameters of another number.
        AssemblyError, ModelError
            A start with these parameters is impossible.
        """
        chosen, plant = lane_numbers(self.count, lanes), self.plant
        if not chosen.size:
            return self.outputs
        _check_sizes(parameters, chosen.size)
        own = {
            n: v if np.ndim(v) == 0 else np.asarray(v)[chosen] for n, v in self.parameters.items()
        }
        x, p = plant.begin_many(own | dict(parameters or {}), chosen.size, self._mode)
        z, q = (
            np.column_stack([x, np.zeros(len(x))]),
            self._rows(self._values, p[:, self.map.others]),
        )
        outputs = self._outputs_at(x, p)
        arrays = self._z[self._side], self._u, self._q, self._y
        for array, values in zip(arrays, (z, p[:, plant.inputs], q, outputs), strict=True):
            self._write(array, chosen, values)
        self._steps[chosen], self.failed[chosen] = 0, False
        if lanes is None:  # lanes beyond the count, which fill the last group
            for array in (*self._z, self._u, self._q):
                array[-1] = np.where(
                    np.arange(self.width) < self._last, array[-1], array[-1][:, :1]
                )
        return self.outputs

    def _rows(self, function: ca.Function, *arguments: np.ndarray) -> np.ndarray:
        """Results of a function for rows of arguments."""
        count = len(arguments[0])
        columns = self.plant.kernel.over(function, count)
        return columns(*(argument.T for argument in arguments))[0].T

    def _outputs_at(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Outputs at states."""
        variant, t = self.map.variant, np.zeros((len(x), 1))
        measured = [variant.measured(m).function for m in self.plant.measures]
        state = x[:, : variant.step.state_size]
        parts = [self._rows(function, t, state, p) for function in measured]
        return np.hstack(parts) if parts else np.zeros((len(x), 0))

    @property
    def _last(self) -> int:
        """Number of lanes of the last group."""
        return self.count - (self.groups - 1) * self.width

    # steps -----------------------------------------------------------------------------
    def step(self, inputs: Any = None) -> np.ndarray:
        """Advance all lanes by one step; returns their outputs (count, ny).

        Parameters
        ----------
        inputs : (count, nu), or (nu,) for all lanes; by default the last ones

        Raises
        ------
        AnalysisError
            Inputs of another shape.
        """
        if inputs is not None:
            self._put(self._u, input_array(self.plant.input_names, self.count, inputs, False))
        side = self._side
        self._each(lambda part: self._calls[part][side](), self._threaded)
        self._finish(1)
        return self.outputs

    def rollout(self, inputs: np.ndarray) -> np.ndarray:
        """Outputs (K, count, ny) of K steps with inputs (K, count, nu), or (K, nu) for all lanes.

        The steps of a thread follow one another without waiting for other threads.

        Raises
        ------
        AnalysisError
            Inputs of another shape.
        """
        inputs = input_array(self.plant.input_names, self.count, inputs, True)
        steps, (_, rows, width) = len(inputs), self._y.shape
        outputs, shares = np.empty((steps, self.count, rows)), np.zeros_like(self._share)
        side = self._side

        def run(part: int) -> None:
            groups, calls = self._parts[part], self._calls[part]
            lanes = slice(groups.start * width, min(groups.stop * width, self.count))
            u, y, share = self._u[groups], self._y[groups], self._share[groups]
            worst = shares[groups]
            for k in range(steps):
                self._put(u, inputs[k, lanes])
                now = (side + k) % 2
                calls[now]()
                if self.map.timed:
                    time = (self._steps[lanes] + k + 1) * self.plant.step
                    self._put(self._z[1 - now][groups, -1:], time[:, None])
                own = y.transpose(0, 2, 1).reshape(-1, rows)
                outputs[k, lanes] = own[: lanes.stop - lanes.start]
                np.maximum(worst, share, out=worst)  # NaN where one is

        self._each(run)
        self._share[:], self._side = shares, (side + steps - 1) % 2
        self._finish(steps)
        return outputs

    def _put(self, array: np.ndarray, values: np.ndarray) -> None:
        """Write (lanes, rows) into (groups, rows, width)."""
        groups, rows, width = array.shape
        if len(values) < groups * width:  # the last group is not full
            missing = groups * width - len(values)
            values = np.concatenate([values, np.repeat(values[-1:], missing, axis=0)])
        array[:] = values.reshape(groups, width, rows).transpose(0, 2, 1)

    def _each(self, work: Callable[[int], object], threaded: bool = True) -> None:
        """Do the work for every part, the last one in this thread."""
        last = len(self._parts) - 1
        if self._pool is None or not threaded:
            for part in range(last + 1):
                work(part)
            return
        others = [self._pool.submit(work, part) for part in range(last)]
        work(last)
        for other in others:
            other.result()

    def _finish(self, steps: int) -> None:
        self._side = 1 - self._side
        self._steps += steps
        if self.map.timed:
            self._put(self._z[self._side][:, -1:], self.time[:, None])
        self.failed |= ~(self._read(self._share)[:, 0] <= 1.0)

    @property
    def time(self) -> np.ndarray:
        """(count,) time since the reset of each lane [s]."""
        return self._steps * self.plant.step

    @property
    def outputs(self) -> np.ndarray:
        """(count, ny) outputs of the last step or reset."""
        return self._read(self._y)

    @property
    def states(self) -> np.ndarray:
        """(count, n) states of the integrator, as ``Stepper.state``."""
        return self._read(self._z[self._side])[:, :-1]

    @states.setter
    def states(self, values: np.ndarray) -> None:
        array, shape = np.asarray(values, dtype=float), self.states.shape
        if array.shape != shape:
            raise AnalysisError(f"states have the shape {array.shape}; give {shape}")
        self._put(self._z[self._side][:, :-1], array)
        self.failed[:] = False


def _check_sizes(parameters: Arrays | None, count: int) -> None:
    """Raise unless parameters are numbers, or one for each lane."""
    for name, value in (parameters or {}).items():
        if np.shape(value) not in ((), (count,)):
            raise AnalysisError(
                f"{name} has the shape {np.shape(value)}; give a number, or an array of shape "
                f"({count},), of one for each lane"
            )
