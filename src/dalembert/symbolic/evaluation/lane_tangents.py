"""Changes of a state through many steps, along several directions side by side.

The tangent of a step is linear in the directions. Its entries depend on the step only: they are
computed once for all directions, of several steps side by side, for all states are known. What is
left is one substitution for each direction, and directions go side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.backends import Backend
from dalembert.symbolic.evaluation.columns import LONG, instructions
from dalembert.symbolic.evaluation.lanes import LaneColumns, SideBySide
from dalembert.symbolic.once import once

ROOM = 1 << 17
"""Numbers of entries that are computed at once, so that they stay near the processor."""


@dataclass(frozen=True, eq=False)
class LinearStep:
    """The tangent of a step as what is computed once, and what is done with each direction.

    Attributes
    ----------
    entries : ``(t, h, x, q) → e``
    along : SX function ``(dx, e, dq) → dx⁺``, linear in dx and dq
    asked : operations of the virtual machine that were asked for so far
    """

    entries: ca.Function
    along: ca.Function
    asked: list[float] = field(default_factory=lambda: [0.0])

    @cached_property
    def compiled_entries(self) -> ca.Function:
        """The entries in the form that is fastest in lanes."""
        return self.entries.expand() if instructions(self.entries) <= LONG else self.entries


class LaneTangents:
    """Pushes directions through steps.

    Parameters
    ----------
    entries, along : functions of a ``LinearStep`` in lanes
    """

    def __init__(self, entries: SideBySide, along: SideBySide):
        self._entries, self._along, self.lanes = entries, along, along.lanes
        self._size = entries.shapes[0][0]

    @classmethod
    def of(cls, step: LinearStep, backend: Backend, count: int, width: int) -> LaneTangents | None:
        """For so many steps and directions more; None without lanes, or where they do not pay yet.

        Marches of an optimisation are many short ones, so that all of them count.
        """
        each = instructions(step.entries) + width * instructions(step.along) / 2
        step.asked[0] += count * each  # a product and a sum are one operation of a substitution
        compiled = step.compiled_entries, step.along
        return _made(step) if backend.repays_lanes(step.asked[0], compiled) else None

    def __call__(
        self, changes: np.ndarray, given: Sequence[np.ndarray], q: np.ndarray, rates: np.ndarray
    ) -> np.ndarray:
        """Changes after each step.

        Parameters
        ----------
        changes, rates : (n, c) and (m, c), what goes in along each direction
        given : instants (1, K), lengths (1, K), and states (n, K) of the steps
        q : what they take of the parameters

        Returns
        -------
        (K, c, n)
        """
        lanes, size, count, (n, width) = self.lanes, self._size, given[0].shape[1], changes.shape
        wide = max(1, min(ROOM // (size * lanes), -(-count // lanes)))
        filled = np.empty((wide, lanes, self._along.filled(size)))
        made, carried = np.empty((wide, size, lanes)), np.empty((wide * lanes + 1, n, lanes))
        found, last = np.empty((count, width, n)), changes
        same = np.repeat(q, lanes)
        for begin in range(0, count, wide * lanes):
            end = min(begin + wide * lanes, count)
            columns = -(-(end - begin) // lanes)
            every = np.minimum(np.arange(begin, begin + columns * lanes), count - 1)
            laid = [
                np.ascontiguousarray(g[:, every].reshape(-1, columns, lanes).transpose(1, 0, 2))
                for g in given
            ]
            self._entries.fill(columns, [*laid, same], [made])
            filled[:columns, :, :size] = made[:columns].transpose(0, 2, 1)
            for group in range(0, width, lanes):
                here = np.minimum(np.arange(group, group + lanes), width - 1)
                carried[0] = last[:, here]
                along = np.ascontiguousarray(rates[:, here])
                self._along.fill(end - begin, [carried, filled, along], [carried[1:]])
                part = carried[1 : end - begin + 1, :, : width - group]
                found[begin:end, group : group + lanes] = part.transpose(0, 2, 1)
            last = found[end - 1].T
        return found


@once
def _made(step: LinearStep) -> LaneTangents | None:
    entries = LaneColumns(step.compiled_entries, False, (3,)).side_by_side
    along = LaneColumns(step.along, True, (2,), (1,)).side_by_side
    return None if entries is None or along is None else LaneTangents(entries, along)
