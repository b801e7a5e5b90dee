"""Loops over contacts in machine code."""

from __future__ import annotations

from functools import lru_cache
from importlib import resources

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.symbolic.evaluation.switching import best_toolchain
from dalembert.symbolic.native.code_cache import compiled_loop
from dalembert.symbolic.native.toolchain import ENTRY, FIRST, LOOP, Call

COMMON = "contacts.c"
"""File of the functions that all loops use."""


class Loop:
    """A loop with its arrays, which stay in place from call to call.

    Parameters
    ----------
    code : machine code
    inputs, outputs : contiguous arrays
    counts : (c,) integers
    work : memory of the loop
    """

    def __init__(
        self,
        code: Call,
        inputs: list[np.ndarray],
        outputs: list[np.ndarray],
        counts: list[int],
        work: int,
    ):
        self._code, self._sizes = code, (1, len(inputs), len(outputs))
        self.counts = np.array(counts, dtype=np.int64)
        source, target = (
            np.array([array.ctypes.data for array in part], dtype=np.uint64)
            for part in (inputs, outputs)
        )
        steps = np.zeros(len(inputs) + len(outputs), dtype=np.int64)
        pointers = np.empty((2, steps.size), dtype=np.uint64)
        memory = source, steps, target, steps, *pointers, self.counts, np.empty(max(work, 1))
        self._memory = *memory, *inputs, *outputs
        self._addresses = tuple(array.ctypes.data for array in memory)

    def __call__(self) -> bool:
        """Run the loop once; false if it failed."""
        return self._code(*self._sizes, *self._addresses) == 1


@lru_cache
def machine_code(*names: str, constants: tuple[tuple[int, int], ...] = ()) -> Call | None:
    """Machine code of files of this package after the common one; None without a toolchain.

    Parameters
    ----------
    names : of the files
    constants : places among the counts, and their values, with which the compiler unrolls loops
    """
    toolchain = best_toolchain()
    if toolchain is None:
        return None
    files = (resources.files(__package__) / part for part in (COMMON, *names))
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    for place, value in constants:
        text = text.replace(f"iw[{place}]", str(value))
    try:
        return compiled_loop(text + LOOP.format(entry=ENTRY, function=FIRST), toolchain.for_loops())
    except UnsupportedError:  # an optional acceleration
        return None


def problem_arrays(problem: FrictionProblem, operator: Delassus) -> list[np.ndarray]:
    """Contiguous arrays of numbers of a friction problem and its operator."""
    minimum = np.broadcast_to(problem.minimum, problem.shape[:1])
    arrays = [operator.directions.data, operator.responses.data, problem.velocity]
    arrays += [problem.friction, minimum, problem.mobility, problem.weights, operator.shift]
    return [np.ascontiguousarray(array, dtype=float) for array in arrays]


def index_arrays(problem: FrictionProblem, operator: Delassus) -> list[np.ndarray]:
    """Contiguous arrays of rows, columns and groups of a friction problem and its operator."""
    w, x = operator.directions, operator.responses
    arrays = [w.indptr, w.indices, x.indptr, x.indices, problem.starts]
    return [array.astype(np.int32, copy=False) for array in arrays]
