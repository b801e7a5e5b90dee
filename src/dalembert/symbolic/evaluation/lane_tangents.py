"""Tangents of many steps, along several directions side by side.

The tangent of a step is linear in the directions. Its entries depend on the step only: they are
computed once for all directions, and, as all states are known, for several steps side by side. One
substitution per direction remains, with several directions side by side.
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
from dalembert.symbolic.once import CacheOwner, once

BLOCK = 1 << 17
"""Block size: number of entries computed at once; chosen to fit the cache."""


@dataclass(frozen=True, eq=False)
class LinearStep(CacheOwner):
    """The tangent of a step: entries computed once, and a substitution for each direction.

    Attributes
    ----------
    entries : ``(t, h, x, q) → e``
    along : SX function ``(dx, e, dq) → dx⁺``, linear in dx and dq
    requested : operations of the virtual machine requested so far
    """

    entries: ca.Function
    along: ca.Function
    requested: list[float] = field(default_factory=lambda: [0.0])

    @cached_property
    def compiled_entries(self) -> ca.Function:
        """The entries in the form that runs fastest in lanes."""
        return self.entries.expand() if instructions(self.entries) <= LONG else self.entries


class LaneTangents:
    """Tangents of steps along several directions, in lanes.

    Parameters
    ----------
    entries, along : functions of a ``LinearStep`` in lanes
    """

    def __init__(self, entries: SideBySide, along: SideBySide):
        self._entries, self._along, self.lanes = entries, along, along.lanes
        self._size = entries.shapes[0][0]

    @classmethod
    def of(cls, step: LinearStep, backend: Backend, count: int, width: int) -> LaneTangents | None:
        """For ``count`` more steps and ``width`` directions; None if lanes do not pay or exist.

        The work of all marches is summed, as an optimisation has many short ones.
        """
        # a product and a sum are one operation of a substitution
        per_step = instructions(step.entries) + width * instructions(step.along) / 2
        step.requested[0] += count * per_step
        compiled = step.compiled_entries, step.along
        return _compiled(step) if backend.repays_lanes(step.requested[0], compiled) else None

    def __call__(
        self, changes: np.ndarray, steps: Sequence[np.ndarray], q: np.ndarray, rates: np.ndarray
    ) -> np.ndarray:
        """Changes after each step.

        Parameters
        ----------
        changes, rates : (n, c) and (m, c), initial changes and rates of q along each direction
        steps : instants (1, K), lengths (1, K), and states (n, K) of the steps
        q : inputs of the steps that depend on the parameters

        Returns
        -------
        (K, c, n)
        """
        lanes, size, count, (n, width) = self.lanes, self._size, steps[0].shape[1], changes.shape
        wide = max(1, min(BLOCK // (size * lanes), -(-count // lanes)))
        padded = np.empty((wide, lanes, self._along.padded(size)))
        entries, carried = np.empty((wide, size, lanes)), np.empty((wide * lanes + 1, n, lanes))
        results, last = np.empty((count, width, n)), changes
        repeated_q = np.repeat(q, lanes)
        for begin in range(0, count, wide * lanes):
            end = min(begin + wide * lanes, count)
            columns = -(-(end - begin) // lanes)
            indices = np.minimum(np.arange(begin, begin + columns * lanes), count - 1)
            arguments = [
                np.ascontiguousarray(g[:, indices].reshape(-1, columns, lanes).transpose(1, 0, 2))
                for g in steps
            ]
            self._entries.fill(columns, [*arguments, repeated_q], [entries])
            padded[:columns, :, :size] = entries[:columns].transpose(0, 2, 1)
            for group in range(0, width, lanes):
                here = np.minimum(np.arange(group, group + lanes), width - 1)
                carried[0] = last[:, here]
                along = np.ascontiguousarray(rates[:, here])
                self._along.fill(end - begin, [carried, padded, along], [carried[1:]])
                part = carried[1 : end - begin + 1, :, : width - group]
                results[begin:end, group : group + lanes] = part.transpose(0, 2, 1)
            last = results[end - 1].T
        return results


@once
def _compiled(step: LinearStep) -> LaneTangents | None:
    entries = LaneColumns(step.compiled_entries, False, (3,)).side_by_side
    along = LaneColumns(step.along, True, (2,), (1,)).side_by_side
    return None if entries is None or along is None else LaneTangents(entries, along)
