"""States of long marches: few are kept, the others are repeated when they are asked for.

One in ``EVERY`` states is kept, and a segment between two of them computed again by the steps that
were taken, with their lengths, variants and corrections; so the repeated states are the same ones
(to rounding where an adaptive march made them). Going through all states once, in either
direction, costs one more march.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

EVERY = 500
"""Steps between two states that are kept, where not all are."""
RECENT = 2
"""Segments that stay at hand after they were repeated."""

Repeat = Callable[[int, int, np.ndarray], np.ndarray]
"""``(begin, end, x)`` → states (n, end − begin) after these steps, from the state before them."""


class Checkpoints:
    """Stands for the array (n, steps + 1) of all states; is indexed like it.

    Parameters
    ----------
    number : numbers of the states that are kept, rising; the first and the last state among them
    kept : (n, len(number)) these states
    repeat : computes others
    """

    def __init__(self, number: np.ndarray, kept: np.ndarray, repeat: Repeat):
        self.number, self.kept, self._repeat = number, kept, repeat
        self._recent: dict[int, np.ndarray] = {}

    @property
    def shape(self) -> tuple[int, int]:
        return self.kept.shape[0], int(self.number[-1]) + 1

    def __getitem__(self, key) -> np.ndarray:
        rows, columns = key if isinstance(key, tuple) else (key, slice(None))
        wanted = np.arange(self.shape[1])[columns]
        return self._states(np.atleast_1d(wanted))[rows].reshape(-1, *wanted.shape)

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        return self[:, :].astype(dtype or float)

    def cut(self, count: int) -> Checkpoints:
        """Up to state ``count``."""
        return self.ended(count, self[:, count])

    def ended(self, count: int, x: np.ndarray) -> Checkpoints:
        """The states before ``count``, then this one."""
        before = self.number < count
        kept = np.column_stack([self.kept[:, before], x])
        return Checkpoints(np.append(self.number[before], count), kept, self._repeat)

    def _states(self, wanted: np.ndarray) -> np.ndarray:
        found = np.empty((self.kept.shape[0], wanted.size))
        before = np.searchsorted(self.number, wanted, side="right") - 1
        here = self.number[before] == wanted
        found[:, here] = self.kept[:, before[here]]
        for segment in np.unique(before[~here]):
            part = np.flatnonzero((before == segment) & ~here)
            found[:, part] = self._segment(int(segment))[:, wanted[part] - self.number[segment] - 1]
        return found

    def _segment(self, k: int) -> np.ndarray:
        """States after the ``k``-th that is kept, up to the next one."""
        if k not in self._recent:
            if len(self._recent) >= RECENT:
                del self._recent[next(iter(self._recent))]
            begin, end = self.number[k : k + 2]
            self._recent[k] = self._repeat(int(begin), int(end), self.kept[:, k])
        return self._recent[k]


States = np.ndarray | Checkpoints


def cut_states(x: States, count: int) -> States:
    """The states up to number ``count``."""
    return x.cut(count) if isinstance(x, Checkpoints) else x[:, : count + 1]


def ended_states(x: States, count: int, last: np.ndarray) -> States:
    """The states before number ``count``, then this one."""
    if isinstance(x, Checkpoints):
        return x.ended(count, last.ravel())
    return np.column_stack([x[:, :count], last])


def joined_states(x: States, more: States, repeat: Repeat) -> States:
    """The states of two marches, of which the second begins where the first ends."""
    if isinstance(x, np.ndarray) and isinstance(more, np.ndarray):
        return np.hstack([x, more[:, 1:]])
    (number, kept), (further, then) = _kept(x), _kept(more)
    number = np.append(number, number[-1] + further[1:])
    return Checkpoints(number, np.hstack([kept, then[:, 1:]]), repeat)


def _kept(x: States) -> tuple[np.ndarray, np.ndarray]:
    if isinstance(x, Checkpoints):
        return x.number, x.kept
    return np.arange(x.shape[1]), x


class Recorder:
    """Takes the states of a march as they come; keeps all, or few when they grow too many.

    Parameters
    ----------
    x0 : (n,) first state
    memory : bytes of states to be kept at most before few of them are
    outputs : (K,) times around which states are kept in any case [s]
    steps : how many there are going to be, where that is known: memory is taken once
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
        room = steps + 1 if steps and not self.thin else 0
        self._whole = np.empty((self.last.size, room), order="F")
        self._whole[:, :1] = x0.reshape(-1, 1)
        self._numbers = [np.zeros(1, dtype=int)]
        self._columns = [x0.reshape(-1, 1)]
        self._needed: list[np.ndarray] = []

    def _too_many(self, steps: int) -> bool:
        return 8 * self.last.size * (steps + 1) > self.memory

    def add(self, ends: np.ndarray, columns: np.ndarray) -> None:
        """States at the ends of further steps; ``ends`` has the time of the last state first."""
        if not columns.shape[1]:
            return
        number = self.count + 1 + np.arange(columns.shape[1])
        if self._whole.size:
            if self._whole.shape[1] <= number[-1]:  # steps were halved
                room = max(columns.shape[1], self._whole.shape[1] // 4)
                more = np.empty((self.last.size, room))
                self._whole = np.asfortranarray(np.hstack([self._whole, more]))
            self._whole[:, number] = columns
            self.count, self.last = int(number[-1]), columns[:, -1].copy()
            return
        self._needed.append(self._around_outputs(ends) + self.count)
        self.count, self.last = int(number[-1]), columns[:, -1].copy()
        if self.thin:
            number, columns = self._thinned(number, columns, self._needed[-1])
        self._numbers.append(number)
        self._columns.append(columns)
        if not self.thin and self._too_many(self.count):
            needed = np.concatenate(self._needed)
            pairs = [
                self._thinned(n, c, needed)
                for n, c in zip(self._numbers, self._columns, strict=True)
            ]
            self._numbers, self._columns = [n for n, _ in pairs], [c for _, c in pairs]
            self.thin = True

    def _around_outputs(self, ends: np.ndarray) -> np.ndarray:
        """Numbers, from the last state on, of the states about each output."""
        inside = self.outputs[(self.outputs >= ends[0]) & (self.outputs <= ends[-1])]
        before = np.searchsorted(ends, inside, side="right") - 1
        return np.unique(np.concatenate([before, before + 1]))

    @staticmethod
    def _thinned(number: np.ndarray, columns: np.ndarray, needed: np.ndarray):
        kept = (number % EVERY == 0) | np.isin(number, needed)
        return number[kept], columns[:, kept].copy()

    def states(self, repeat: Repeat | None) -> States:
        """All states, or what stands for them."""
        if self._whole.size:
            return self._whole[:, : self.count + 1]
        number, kept = np.concatenate(self._numbers), np.hstack(self._columns)
        if not self.thin or repeat is None:
            return kept
        if number[-1] != self.count:
            number, kept = np.append(number, self.count), np.column_stack([kept, self.last])
        return Checkpoints(number, kept, repeat)


def recorder_like(x: States, t: np.ndarray, x0: np.ndarray) -> Recorder:
    """Keeps what was kept of another march over the steps that begin at ``t``."""
    if not isinstance(x, Checkpoints):
        return Recorder(x0)
    chosen = x.number[(x.number % EVERY != 0) & (x.number < t.size)]
    return Recorder(x0, 0.0, t[chosen])
