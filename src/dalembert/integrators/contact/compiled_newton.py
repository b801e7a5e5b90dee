"""Semismooth Newton method for frictional contact impulses, in machine code but for the factors."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import ORDERING, Delassus
from dalembert.integrators.contact.machine_code import (
    Loop,
    index_arrays,
    machine_code,
    problem_arrays,
)
from dalembert.sparse.factorise import SuperLUFactors

MODE, ASSEMBLE, SEARCH = 6, 0, 1
"""Place of the mode of the loop among its counts, and the modes."""


class CompiledNewton:
    """Newton steps on one problem.

    Parameters
    ----------
    problem : with a sparse operator
    operator : Delassus operator of the problem
    impulses : (n, k) initial guess
    settings : tolerance of the residual, regularisation, overshoot beyond a change of piece
    """

    def __init__(
        self,
        problem: FrictionProblem,
        operator: Delassus,
        impulses: np.ndarray,
        settings: tuple[float, float, float],
    ):
        code = machine_code("semismooth_newton.c")
        assert code is not None
        count, width = problem.shape
        self.pattern, rows = operator.pattern(width), count * width
        self.speeds, size = operator.directions.shape[1], self.pattern.pointers.size - 1
        pattern, joined = self.pattern, size > self.speeds
        self.options = {} if joined else ORDERING
        self.impulses, self.status = np.array(impulses), np.zeros(3)
        self.system, self.push = np.zeros(pattern.rows.size), np.zeros(size)
        self.solution = np.zeros(size)
        arrays = [
            *problem_arrays(problem, operator),
            np.array(settings),
            pattern.constant,
            self.solution,
        ]
        indices = [pattern.start, pattern.column, pattern.local, pattern.block, pattern.place]
        outputs = [self.impulses, self.system, self.push, np.zeros(rows), np.zeros(rows * width)]
        outputs += [np.zeros(rows) for _ in range(5)]
        outputs += [np.zeros(self.speeds), self.status]
        widest = int(np.diff(pattern.start).max(initial=0))
        counts = [
            count,
            width,
            len(problem.groups),
            self.speeds,
            pattern.rows.size,
            size,
            ASSEMBLE,
            widest,
        ]
        work = 3 * width * (width + 1) + 2 * width + 2 * width * widest
        inputs = [*arrays, *index_arrays(problem, operator), *indices]
        self._loop = Loop(code, inputs, outputs, counts, work)

    @property
    def residual(self) -> float:
        """Residual of the impulses when the last system was assembled [m/s]."""
        return float(self.status[1])

    def assemble(self) -> bool:
        """The residual and, above the tolerance, the equations; false if they are singular."""
        self._loop.counts[MODE] = ASSEMBLE
        return self._loop()

    def advance(self) -> bool:
        """Solve the equations and search along the step; false without a decrease."""
        entries = self.system, self.pattern.rows, self.pattern.pointers
        matrix = scipy.sparse.csc_array(entries, shape=(self.push.size, self.push.size))
        self.solution[:] = SuperLUFactors(matrix, **self.options).solve(self.push)
        self._loop.counts[MODE] = SEARCH
        return bool(np.isfinite(self.solution).all()) and self._loop() and self.status[2] > 0


def compiled_newton(
    problem: FrictionProblem,
    operator: Delassus,
    impulses: np.ndarray,
    settings: tuple[float, float, float],
    max_iterations: int,
) -> np.ndarray:
    """Impulses after at most ``max_iterations`` steps."""
    newton = CompiledNewton(problem, operator, impulses, settings)
    for _ in range(max_iterations):
        if not newton.assemble() or not newton.residual > settings[0]:
            break
        try:
            if not newton.advance():
                break
        except np.linalg.LinAlgError:
            break
    return newton.impulses
