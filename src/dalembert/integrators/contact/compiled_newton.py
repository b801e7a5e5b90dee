"""Semismooth Newton method for frictional contact impulses, in machine code but for the factors."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.integrators.contact.block_ordering import ORDERING, BlockOrdering
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.machine_code import (
    Loop,
    index_arrays,
    machine_code,
    problem_arrays,
)
from dalembert.integrators.contact.places import Counts, Inputs, Settings, Status
from dalembert.integrators.contact.solution_settings import (
    FEW_PROXIMAL,
    INTERIOR_POINTS,
    MANY_PROXIMAL,
    NEWTON_STEPS,
    POLISHING,
    SHORT_STEPS,
    SOLUTION_FILES,
    SOLUTION_SHARES,
)
from dalembert.integrators.contact.step_calls import Modes
from dalembert.integrators.contact.step_places import Shares
from dalembert.sparse.factorise import SuperLUFactors

FILES = *SOLUTION_FILES, "newton_modes.c"
ORIGINAL = 34
"""Place of the memory of the solution among the outputs."""
VECTORS, FRICTION, MINIMUM, ROWS, INERTIA = [2, 5, 6, 7], 3, 4, [9, 11], 15
"""Places among the inputs of the arrays with all components of contacts, of the coefficients of
friction and the lower limits of impulses, and of the starts of the rows of directions and of the
inertia."""
OVERSHOOT = 1e-9
"""Relative overshoot of a step beyond a change of piece [-]."""
BLOCK_REGULARIZATION = 1e-7
"""Regularisation of steps with factors without pivots, so that these are accurate, relative to the
mobility: it reduces a residual to this share of it, at best [-]."""
MEMORY, JUMPS = 5, 3
"""Number of last merits, the largest of which a step has to reduce (Grippo, Lampariello & Lucidi
1986), and upper limit of whole steps without a share that does; with factors of blocks."""


class CompiledNewton:
    """Newton steps on one problem, with factors of blocks in machine code where bodies are free.

    Parameters
    ----------
    problem : with a sparse operator
    operator : Delassus operator of the problem
    impulses : (n, k) initial guess
    settings : tolerance of the residual, regularisation, overshoot beyond a change of piece; of
        the whole solution also its relative tolerance and the lower limit of the reference speed
    max_iterations : upper limit of the steps
    proximal : upper limit of the proximal problems of the whole solution, with factors of blocks;
        None for Newton's method alone
    """

    def __init__(
        self,
        problem: FrictionProblem,
        operator: Delassus,
        impulses: np.ndarray,
        settings: tuple[float, ...],
        max_iterations: int = 0,
        proximal: int | None = None,
    ):
        code = machine_code(*FILES)
        assert code is not None
        (count, width), rows = problem.shape, impulses.size
        self.speeds, self.iterations = operator.directions.shape[1], max_iterations
        self.impulses, self.status = np.array(impulses), np.zeros(4)
        self.ordering = operator.ordering(width)
        if self.ordering is not None:
            settings = settings[0], max(settings[1], BLOCK_REGULARIZATION), *settings[2:]
        inputs = [*problem_arrays(problem, operator), np.array(settings)]
        if proximal is not None:  # which changes speeds, mobilities and additions to the diagonal
            inputs = [*inputs[:2], *(array.copy() for array in inputs[2:])]
        inputs += index_arrays(problem, operator)
        if self.ordering is None:
            self.pattern = pattern = operator.pattern(width)
            size, entries = pattern.pointers.size - 1, pattern.rows.size
            self.options = {} if size > self.speeds else ORDERING
            indices = [pattern.start, pattern.column, pattern.local, pattern.block, pattern.place]
            constant, sizes = pattern.constant, (0, 0)
            widest = int(np.diff(pattern.start).max(initial=0))
        else:
            size, entries, sizes = self.speeds, self.ordering.entries, self.ordering.members.shape
            inputs += _block_arrays(operator, self.ordering)
            starts = operator.directions.indptr[::width].astype(np.int64)
            widths, constant = np.diff(starts), np.zeros(entries)
            widest = int(widths.max(initial=0))
            lengths = count + 1, starts[-1], starts[-1], count, int(widths @ widths)
            indices = [np.zeros(length, dtype=np.int32) for length in lengths]
        self.system, self.push, self.solution = np.zeros(entries), np.zeros(size), np.zeros(size)
        outputs = [self.impulses, self.system, self.push, np.zeros(rows), np.zeros(rows * width)]
        outputs += [np.zeros(rows) for _ in range(5)]
        outputs += [np.zeros(self.speeds), self.status, constant, self.solution, *indices]
        if proximal is not None:
            none = np.zeros(1)
            inputs += [none] * (Inputs.SHARES - len(inputs)) + [Shares.numbers(SOLUTION_SHARES)]
            memory = [4 * rows, *[rows] * 8, count, rows * width]
            outputs += [none] * (ORIGINAL - len(outputs)) + [np.zeros(size) for size in memory]
        work = 12 * width**2 + 3 * width * (width + 1) + 2 * width
        work += 2 * width * widest + widest**2
        work = max(work, sizes[0] * sizes[1] + sizes[1] ** 2)
        counts = {
            Counts.CONTACTS: count,
            Counts.COMPONENTS: width,
            Counts.GROUPS: len(problem.groups),
            Counts.SPEEDS: self.speeds,
            Counts.ENTRIES: entries,
            Counts.UNKNOWNS: size,
            Counts.CONTACT_SPEEDS: widest,
            Counts.BLOCKS: sizes[0],
            Counts.BLOCK_SIZE: sizes[1],
            Counts.MAX_ITERATIONS: max_iterations,
            Counts.MERITS: MEMORY,
            Counts.MAX_JUMPS: JUMPS,
            Counts.WORK: work,
            Counts.MAX_PROXIMAL: proximal or 0,
            Counts.MAX_INTERIOR: INTERIOR_POINTS,
            Counts.MAX_POLISHING: POLISHING,
            Counts.MAX_SHORT_STEPS: SHORT_STEPS,
            Counts.FEW_PROXIMAL: FEW_PROXIMAL,
        }
        work += rows + MEMORY + count + 2 + entries
        self._settings, self._lengths = inputs[8], (len(inputs), len(outputs))
        self._loop = Loop(code, inputs, outputs, Counts.listed(counts), work)

    @property
    def residual(self) -> float:
        """Residual of the impulses when the last system was assembled [m/s]."""
        return float(self.status[Status.RESIDUAL])

    def assemble(self) -> bool:
        """The residual and, above the tolerance, the equations; false if they are singular."""
        self._loop.counts[Counts.MODE] = Modes.ASSEMBLE
        return self._loop()

    def advance(self) -> bool:
        """Solve the equations and search along the step; false without a decrease."""
        entries = self.system, self.pattern.rows, self.pattern.pointers
        matrix = scipy.sparse.csc_array(entries, shape=(self.push.size, self.push.size))
        self.solution[:] = SuperLUFactors(matrix, **self.options).solve(self.push)
        self._loop.counts[Counts.MODE] = Modes.SEARCH
        return (
            bool(np.isfinite(self.solution).all())
            and self._loop()
            and self.status[Status.DESCENDS] > 0
        )

    def iterate(self, tolerance: float) -> None:
        """Steps until the residual is within the tolerance, or none reduces the merit."""
        if self.ordering is not None:
            self._loop.counts[Counts.MODE] = Modes.ITERATE
            self._loop()
            return
        for _ in range(self.iterations):
            if not self.assemble() or not self.residual > tolerance:
                break
            try:
                if not self.advance():
                    break
            except np.linalg.LinAlgError:
                break

    def solve(self) -> int:
        """The whole solution; the number of proximal problems."""
        self._loop.counts[Counts.MODE] = Modes.SOLVE
        return int(self.status[Status.ROUNDS]) if self._loop() else 0

    def solve_part(self, begin: int, end: int, number: int, scale: float) -> None:
        """The whole solution of some contacts that do not act on the others.

        Parameters
        ----------
        begin, end : first contact, and that after the last one
        number : of their bodies' block of the inertia, which has as many columns as one body's
            block has rows
        scale : lower limit of the reference speed
        """
        counts, speeds = self._loop.counts, self.speeds
        width, groups = int(counts[Counts.COMPONENTS]), int(counts[Counts.GROUPS])
        inputs, outputs = (np.zeros(length, dtype=np.uint64) for length in self._lengths)
        inputs[VECTORS] = 8 * width * begin
        inputs[FRICTION], inputs[MINIMUM] = 8 * groups * begin, 8 * begin
        inputs[ROWS], inputs[INERTIA] = 4 * width * begin, 4 * speeds * number
        outputs[0] = 8 * width * begin
        self._loop.shift(inputs, outputs)
        counts[Counts.CONTACTS], self._settings[Settings.SCALE] = end - begin, scale
        self.solve()


def compiled_newton(
    problem: FrictionProblem,
    operator: Delassus,
    impulses: np.ndarray,
    settings: tuple[float, float, float],
    max_iterations: int,
) -> np.ndarray:
    """Impulses after at most ``max_iterations`` steps."""
    newton = CompiledNewton(problem, operator, impulses, settings, max_iterations)
    newton.iterate(settings[0])
    return newton.impulses


def compiled_solution(
    problem: FrictionProblem, impulses: np.ndarray, share: float, max_iterations: int
) -> tuple[np.ndarray, int] | None:
    """Impulses of free bodies by Newton's method, interior points and proximal problems, and the
    number of the latter; None without machine code, and for compliant contacts.

    Parameters
    ----------
    impulses : (n, k) initial guess
    share : tolerance relative to the largest speed of a contact [-]
    max_iterations : upper limit of the proximal problems
    """
    newton = _solution(problem, impulses, share, max_iterations)
    return None if newton is None else (newton.impulses, newton.solve())


def separate_solutions(
    problem: FrictionProblem,
    parts: list[tuple[int, int, int, float]],
    impulses: np.ndarray,
    share: float,
    max_iterations: int,
) -> np.ndarray | None:
    """Impulses of several problems of the same free bodies, one after the other; None without
    machine code, for compliant contacts, and for few contacts.

    Parameters
    ----------
    problem : contacts of all problems, with directions by the speeds of the bodies in each, and an
        inertia of as many columns
    parts : arguments of ``CompiledNewton.solve_part`` of each
    impulses, share, max_iterations : as in ``compiled_solution``
    """
    assert isinstance(problem.matrix, Delassus)
    newton = (
        _solution(problem, impulses, share, max_iterations) if problem.matrix.by_blocks else None
    )
    if newton is None:
        return None
    for part in parts:
        newton.solve_part(*part)
    return newton.impulses


def _solution(
    problem: FrictionProblem, impulses: np.ndarray, share: float, max_iterations: int
) -> CompiledNewton | None:
    """The whole solution, arguments as in ``compiled_solution``."""
    operator = problem.matrix
    assert isinstance(operator, Delassus)
    compliant = operator.shift.any() or np.any(problem.minimum) or np.any(problem.compliance)
    if compliant or machine_code(*FILES) is None:
        return None
    settings = 0.0, BLOCK_REGULARIZATION, OVERSHOOT, share, problem.scale
    proximal = min(MANY_PROXIMAL, max_iterations)
    return CompiledNewton(problem, operator, impulses, settings, NEWTON_STEPS, proximal)


def _block_arrays(operator: Delassus, order: BlockOrdering) -> list[np.ndarray]:
    """Arrays of the inertia, compressed by rows, and of the order of elimination."""
    inertia = operator.inertia
    if not scipy.sparse.issparse(inertia) or inertia.format != "csr":
        inertia = scipy.sparse.csr_array(inertia)
    parts = [inertia.indptr, inertia.indices, order.owner, order.position]
    parts += [order.first, order.row, order.members]
    indices = [np.ascontiguousarray(part, dtype=np.int32) for part in parts]
    return [np.ascontiguousarray(inertia.data, dtype=float), *indices]
