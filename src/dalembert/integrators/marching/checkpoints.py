"""Checkpoints of long marches, between which states are recomputed on request.

Every ``EVERY``-th state is stored, and a segment between two of them is recomputed by the steps
that were taken, with their lengths, variants and corrections; so the recomputed states are
identical (to rounding after an adaptive march). Traversing all states once, in either direction,
costs one more march.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

EVERY = 500
"""Number of steps between two checkpoints."""
RECENT = 2
"""Number of recomputed segments that are cached."""

Repeat = Callable[[int, int, np.ndarray], np.ndarray]
"""``(begin, end, x)`` → states (n, end − begin) after these steps, from the state before them."""


class Checkpoints:
    """Virtual array (n, steps + 1) of all states, indexed like an array.

    Parameters
    ----------
    number : numbers of the stored states, ascending, including the first and the last state
    stored : (n, len(number)) these states
    repeat : recomputes states between them
    """

    def __init__(self, number: np.ndarray, stored: np.ndarray, repeat: Repeat):
        self.number, self.stored, self._repeat = number, stored, repeat
        self._recent: dict[int, np.ndarray] = {}

    @property
    def shape(self) -> tuple[int, int]:
        return self.stored.shape[0], int(self.number[-1]) + 1

    def __getitem__(self, key) -> np.ndarray:
        rows, columns = key if isinstance(key, tuple) else (key, slice(None))
        numbers = np.arange(self.shape[1])[columns]
        return self._states(np.atleast_1d(numbers))[rows].reshape(-1, *numbers.shape)

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        return self[:, :].astype(dtype or float)

    def cut(self, count: int) -> Checkpoints:
        """Up to state ``count``."""
        return self.with_last(count, self[:, count])

    def with_last(self, count: int, x: np.ndarray) -> Checkpoints:
        """The states before ``count``, then this one."""
        before = self.number < count
        stored = np.column_stack([self.stored[:, before], x])
        return Checkpoints(np.append(self.number[before], count), stored, self._repeat)

    def _states(self, numbers: np.ndarray) -> np.ndarray:
        states = np.empty((self.stored.shape[0], numbers.size))
        before = np.searchsorted(self.number, numbers, side="right") - 1
        here = self.number[before] == numbers
        states[:, here] = self.stored[:, before[here]]
        for segment in np.unique(before[~here]):
            part = np.flatnonzero((before == segment) & ~here)
            columns = numbers[part] - self.number[segment] - 1
            states[:, part] = self._segment(int(segment))[:, columns]
        return states

    def _segment(self, k: int) -> np.ndarray:
        """States after the ``k``-th checkpoint, up to the next one."""
        if k not in self._recent:
            if len(self._recent) >= RECENT:
                del self._recent[next(iter(self._recent))]
            begin, end = self.number[k : k + 2]
            self._recent[k] = self._repeat(int(begin), int(end), self.stored[:, k])
        return self._recent[k]


States = np.ndarray | Checkpoints


def cut_states(x: States, count: int) -> States:
    """The states up to number ``count``."""
    return x.cut(count) if isinstance(x, Checkpoints) else x[:, : count + 1]


def ended_states(x: States, count: int, last: np.ndarray) -> States:
    """The states before number ``count``, then this one."""
    if isinstance(x, Checkpoints):
        return x.with_last(count, last.ravel())
    return np.column_stack([x[:, :count], last])


def joined_states(x: States, more: States, repeat: Repeat) -> States:
    """The states of two marches, of which the second begins where the first ends."""
    if isinstance(x, np.ndarray) and isinstance(more, np.ndarray):
        return np.hstack([x, more[:, 1:]])
    (number, stored), (further, then) = _stored_states(x), _stored_states(more)
    number = np.append(number, number[-1] + further[1:])
    return Checkpoints(number, np.hstack([stored, then[:, 1:]]), repeat)


def _stored_states(x: States) -> tuple[np.ndarray, np.ndarray]:
    if isinstance(x, Checkpoints):
        return x.number, x.stored
    return np.arange(x.shape[1]), x


class Recorder:
    """Recorder of the states of a march, thinned to checkpoints beyond the memory limit.

    Parameters
    ----------
    x0 : (n,) first state
    memory : upper limit of stored states before they are thinned [bytes]
    outputs : (K,) times around which states are stored in any case [s]
    steps : expected number of steps, 0 if unknown; memory is then allocated once
    """

    def __init__(
        self,
        x0: np.ndarray,
        memory: float = np.inf,
        outputs: np.ndarray | None = None,
        steps: int = 0,
    ):
        self.memory = memory
        self.outputs = np.zeros(0) if outputs is None else outputs
        self.count, self.last = 0, x0.ravel()
        self.thin = self._too_many(steps)
        capacity = steps + 1 if steps and not self.thin else 0
        self._array = np.empty((self.last.size, capacity), order="F")
        self._array[:, :1] = x0.reshape(-1, 1)
        self._numbers = [np.zeros(1, dtype=int)]
        self._columns = [x0.reshape(-1, 1)]
        self._needed: list[np.ndarray] = []

    def _too_many(self, steps: int) -> bool:
        return 8 * self.last.size * (steps + 1) > self.memory

    def add(self, ends: np.ndarray, columns: np.ndarray) -> None:
        """Add states at the ends of steps; ``ends`` begins with the time of the last state."""
        if not columns.shape[1]:
            return
        number = self.count + 1 + np.arange(columns.shape[1])
        if self._array.size:
            if self._array.shape[1] <= number[-1]:  # steps were halved
                extra = max(columns.shape[1], self._array.shape[1] // 4)
                more = np.empty((self.last.size, extra))
                self._array = np.asfortranarray(np.hstack([self._array, more]))
            self._array[:, number] = columns
            self.count, self.last = int(number[-1]), columns[:, -1].copy()
            return
        self._needed.append(self._around_outputs(ends) + self.count)
        self.count, self.last = int(number[-1]), columns[:, -1].copy()
        if self.thin:
            number, columns = self._select(number, columns, self._needed[-1])
        self._numbers.append(number)
        self._columns.append(columns)
        if not self.thin and self._too_many(self.count):
            needed = np.concatenate(self._needed)
            pairs = [
                self._select(n, c, needed)
                for n, c in zip(self._numbers, self._columns, strict=True)
            ]
            self._numbers, self._columns = [n for n, _ in pairs], [c for _, c in pairs]
            self.thin = True

    def _around_outputs(self, ends: np.ndarray) -> np.ndarray:
        """Numbers, counted from the last state, of the states around each output."""
        inside = self.outputs[(self.outputs >= ends[0]) & (self.outputs <= ends[-1])]
        before = np.searchsorted(ends, inside, side="right") - 1
        return np.unique(np.concatenate([before, before + 1]))

    @staticmethod
    def _select(number: np.ndarray, columns: np.ndarray, needed: np.ndarray):
        stored = (number % EVERY == 0) | np.isin(number, needed)
        return number[stored], columns[:, stored].copy()

    def states(self, repeat: Repeat | None) -> States:
        """All states, as an array or as checkpoints."""
        if self._array.size:
            return self._array[:, : self.count + 1]
        number, stored = np.concatenate(self._numbers), np.hstack(self._columns)
        if not self.thin or repeat is None:
            return stored
        if number[-1] != self.count:
            number, stored = np.append(number, self.count), np.column_stack([stored, self.last])
        return Checkpoints(number, stored, repeat)


def recorder_like(x: States, t: np.ndarray, x0: np.ndarray) -> Recorder:
    """Recorder that stores the same states as another march over the steps from ``t``."""
    if not isinstance(x, Checkpoints):
        return Recorder(x0)
    chosen = x.number[(x.number % EVERY != 0) & (x.number < t.size)]
    return Recorder(x0, 0.0, t[chosen])
