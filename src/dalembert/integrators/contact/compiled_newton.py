"""Semismooth Newton method for frictional contact impulses, in machine code but for the factors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import scipy

from dalembert.integrators.contact.block_ordering import ORDERING
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.machine_code import Loop, machine_code
from dalembert.integrators.contact.newton_arrays import (
    block_inputs,
    block_outputs,
    newton_outputs,
    problem_inputs,
    solution_memory,
    widest_contact,
)
from dalembert.integrators.contact.places import Counts, Inputs, Outputs, Settings, Status
from dalembert.integrators.contact.solution_settings import (
    MANY_PROXIMAL,
    NEWTON_STEPS,
    SOLUTION_COUNTS,
    SOLUTION_FILES,
    SOLUTION_SHARES,
)
from dalembert.integrators.contact.step_calls import Modes
from dalembert.integrators.contact.step_places import Shares
from dalembert.sparse.factorise import SuperLUFactors

FILES = *SOLUTION_FILES, "newton_modes.c"
VECTORS = Inputs.VELOCITY, Inputs.MOBILITY, Inputs.WEIGHTS, Inputs.SHIFT
"""Inputs with all components of the contacts."""
CHANGED = *VECTORS, Inputs.FRICTION, Inputs.MINIMUM
"""Inputs that the whole solution copies, as it changes some of them."""
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
    settings : by ``Settings``
    max_iterations : upper limit of the steps
    proximal : upper limit of the proximal problems of the whole solution, with factors of blocks;
        None for Newton's method alone
    """

    def __init__(
        self,
        problem: FrictionProblem,
        operator: Delassus,
        impulses: np.ndarray,
        settings: Mapping[int, float],
        max_iterations: int = 0,
        proximal: int | None = None,
    ):
        code = machine_code(*FILES)
        assert code is not None
        (count, width), rows = problem.shape, impulses.size
        self.speeds, self.iterations = operator.directions.shape[1], max_iterations
        self.impulses, self.status = np.array(impulses), np.zeros(Status.size())
        self.ordering = operator.ordering(width)
        if self.ordering is not None:
            least = max(settings[Settings.REGULARIZATION], BLOCK_REGULARIZATION)
            settings = {**settings, Settings.REGULARIZATION: least}
        inputs, self._settings = problem_inputs(problem, operator), Settings.numbers(settings)
        inputs[Inputs.SETTINGS] = self._settings
        if proximal is not None:
            inputs.update({place: inputs[place].copy() for place in CHANGED})
            inputs[Inputs.SHARES] = Shares.numbers(SOLUTION_SHARES)
        if self.ordering is None:
            self.pattern = pattern = operator.pattern(width)
            size, entries = pattern.pointers.size - 1, pattern.rows.size
            self.options = {} if size > self.speeds else ORDERING
            places = {
                Outputs.COLUMN_STARTS: pattern.start,
                Outputs.COLUMNS: pattern.column,
                Outputs.LOCAL_COLUMNS: pattern.local,
                Outputs.ENTRY_STARTS: pattern.block,
                Outputs.ENTRIES: pattern.place,
            }
            constant, sizes = pattern.constant, (0, 0)
            widest = int(np.diff(pattern.start).max(initial=0))
        else:
            size, entries, sizes = self.speeds, self.ordering.entries, self.ordering.members.shape
            inputs.update(block_inputs(operator, self.ordering))
            starts = operator.directions.indptr[::width].astype(np.int64)
            widths, constant = np.diff(starts), np.zeros(entries)
            widest = widest_contact(operator.directions, widths)
            places = block_outputs(count, starts[-1], starts[-1], int(widths @ widths))
        outputs = newton_outputs(count, width, self.speeds, entries, size)
        outputs.update(places)
        outputs[Outputs.IMPULSE], outputs[Outputs.STATUS] = self.impulses, self.status
        outputs[Outputs.CONSTANT] = constant
        self.system, self.push = outputs[Outputs.SYSTEM], outputs[Outputs.RIGHT_SIDE]
        self.solution = outputs[Outputs.SOLUTION]
        if proximal is not None:
            outputs.update(solution_memory(count, width))
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
            **SOLUTION_COUNTS,
        }
        work += rows + MEMORY + count + 2 + entries
        arrays = Inputs.arranged(inputs), Outputs.arranged(outputs)
        self._lengths = len(arrays[0]), len(arrays[1])
        self._loop = Loop(code, *arrays, Counts.listed(counts), work)

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
        inputs[list(VECTORS)] = 8 * width * begin
        inputs[Inputs.FRICTION], inputs[Inputs.MINIMUM] = 8 * groups * begin, 8 * begin
        inputs[[Inputs.DIRECTION_ROWS, Inputs.RESPONSE_ROWS]] = 4 * width * begin
        inputs[Inputs.INERTIA_ROWS] = 4 * speeds * number
        outputs[Outputs.IMPULSE] = 8 * width * begin
        self._loop.shift(inputs, outputs)
        counts[Counts.CONTACTS], self._settings[Settings.SCALE] = end - begin, scale
        self.solve()


def compiled_newton(
    problem: FrictionProblem,
    operator: Delassus,
    impulses: np.ndarray,
    settings: Mapping[int, float],
    max_iterations: int,
) -> np.ndarray:
    """Impulses after at most ``max_iterations`` steps."""
    newton = CompiledNewton(problem, operator, impulses, settings, max_iterations)
    newton.iterate(settings[Settings.TOLERANCE])
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
    settings = {
        Settings.REGULARIZATION: BLOCK_REGULARIZATION,
        Settings.OVERSHOOT: OVERSHOOT,
        Settings.RELATIVE_TOLERANCE: share,
        Settings.SCALE: problem.scale,
    }
    proximal = min(MANY_PROXIMAL, max_iterations)
    return CompiledNewton(problem, operator, impulses, settings, NEWTON_STEPS, proximal)
