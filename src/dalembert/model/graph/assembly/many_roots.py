"""Newton's method from many positions at once, with stacked dense Jacobians.

From distant starts, full steps with limited rotations reach more roots than steps that must reduce
the residual; searches for all assemblies of the square system use them. Positions that satisfy all
joints, without fixed coordinates, follow by damped steps (K. Levenberg 1944, D. W. Marquardt 1963)
that change guessed coordinates least. CasADi's virtual machine evaluates the equations, so that
results depend neither on timing nor on the machine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dalembert.model.graph.assembly.assembly import (
    MIN_DAMPING,
    MISSING_WEIGHT,
    PATIENCE,
    PROGRESS,
    ROUNDING,
    Assembler,
)
from dalembert.model.graph.assembly.recipe import Pinned
from dalembert.symbolic.equations.many_newton import ManyEquations, Points, solve_many
from dalembert.symbolic.equations.newton import NewtonSettings
from dalembert.symbolic.evaluation.backends import VirtualMachine
from dalembert.symbolic.evaluation.parallel import in_blocks

TOLERANCE, SLACK = 1e-14, 1e3
"""Threshold for residuals, relative to their terms, and accepted multiple of it."""
STEPS = 60
"""Upper limit of Newton steps of a start."""
FULL_STEPS = NewtonSettings(tolerance=TOLERANCE, max_iterations=STEPS, slack=SLACK, halvings=0)
FAR = 1e4
"""Threshold for divergence: a step in natural lengths."""
ENTRIES = 4_000_000
"""Upper limit of entries of Jacobians in memory."""

Evaluation = tuple[np.ndarray, np.ndarray, np.ndarray]
"""(k, m) residuals relative to their scale, (k, m) their thresholds, (k, m, n) Jacobians by natural
displacements."""


@dataclass(frozen=True, eq=False)
class Ends:
    """Results of searches from many positions.

    Attributes
    ----------
    y : (k, n_y) final positions
    size : (k,) largest residual, relative to its threshold
    open : (k,) largest residual, relative to its natural scale
    """

    y: np.ndarray
    size: np.ndarray
    open: np.ndarray

    @property
    def closed(self) -> np.ndarray:
        """(k,) whether a position is a root."""
        return self.size <= SLACK


class ManyRoots:
    """Roots of the equations of a mechanism at an instant.

    Parameters
    ----------
    assembler : Assembler
    t, p : instant [s] and (np,) parameter values
    pinned : Pinned, the square system of the start; None for all joints and initial conditions
    """

    def __init__(self, assembler: Assembler, t: float, p: np.ndarray, pinned: Pinned | None = None):
        self.assembler, self.t, self.p, self.pinned = assembler, t, p, pinned
        self.displacements = assembler.scales.displacements
        self.longest = assembler.longest / self.displacements
        self.metres = assembler.guesses.metres
        self.angles = np.array(assembler.guesses.angles, dtype=bool)
        machine = VirtualMachine()
        self._position = machine.columns(assembler.position)
        self._going = machine.columns(assembler.manifold.going)
        self._fixed = None if pinned is None else machine.columns(pinned.fixed_at)
        n = self.displacements.size
        self.group = int(np.clip(ENTRIES // (n * n), 8, 1024))
        # scale of steps, in natural displacements
        self._reach = 1 / np.where(assembler.guesses.missing, MISSING_WEIGHT, 1.0)

    # evaluation ------------------------------------------------------------------------------
    def _call(self, columns, *arguments: np.ndarray) -> list[np.ndarray]:
        """Results for rows of arguments, padded to a power of two to limit the number of sizes."""
        count = len(arguments[0])
        padded = 1 << max(0, count - 1).bit_length()
        rows = np.minimum(np.arange(padded), count - 1)
        return [x[:count] for x in in_blocks(columns, 1, *(a[rows] for a in arguments))]

    def displaced(self, y: np.ndarray, steps: np.ndarray) -> np.ndarray:
        """(k, n_y) positions after (k, n) natural displacements."""
        if self.assembler.manifold.flat:
            return y + steps * self.displacements
        return self._call(self._going, y, steps * self.displacements)[0]

    def evaluate(self, y: np.ndarray) -> Evaluation:
        """Residuals and Jacobians at (k, n_y) positions."""
        a, k = self.assembler, len(y)
        t, p = np.full((k, 1), self.t), np.broadcast_to(self.p, (k, self.p.size))
        value, entries, far = self._call(self._position, t, y, p)
        jacobian = np.zeros((k, a.row_count, self.displacements.size))
        jacobian[:, a.entry_rows, a.entry_columns] = entries
        rounding = ROUNDING * np.einsum("kij,kj->ki", np.abs(jacobian), far)
        jacobian *= self.displacements
        scale = np.broadcast_to(a.scales.rows, (k, a.scales.rows.size))
        if a.row_count > scale.shape[1]:
            sizes = np.abs(jacobian[:, scale.shape[1] :]).sum(axis=2)
            scale = np.hstack([scale, np.where(sizes > 0, sizes, 1.0)])
        if self.pinned is not None:
            rows, fixed = self.pinned.rows, self._evaluate_fixed(y, p)
            value = np.hstack([value[:, rows], fixed[0]])
            scale = np.hstack([scale[:, rows], np.broadcast_to(self.pinned.sizes, fixed[0].shape)])
            rounding = np.hstack([rounding[:, rows], fixed[1]])
            jacobian = np.concatenate([jacobian[:, rows], fixed[2]], axis=1)
        return value / scale, TOLERANCE + rounding / scale, jacobian / scale[:, :, None]

    def _evaluate_fixed(self, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, ...]:
        """Fixed coordinates: residuals, their rounding, and Jacobian by natural displacements."""
        assert self.pinned is not None and self._fixed is not None
        away, entries, far = self._call(self._fixed, y, p)
        jacobian = np.zeros((len(y), self.pinned.fixed_count, self.displacements.size))
        jacobian[:, self.pinned.fixed_rows, self.pinned.fixed_columns] = entries
        return away, ROUNDING * far, jacobian * self.displacements

    def apart(self, y: np.ndarray, others: np.ndarray) -> np.ndarray:
        """(k, n) displacements from a position to others, in natural sizes, without whole turns."""
        columns = np.tile(y[:, None], len(others))
        displacement = self.assembler.manifold.lead(columns, others.T).T / self.displacements
        with np.errstate(invalid="ignore"):  # a half turn of a spatial body is infinite
            return np.where(
                self.angles, np.remainder(displacement + np.pi, 2 * np.pi) - np.pi, displacement
            )

    def unwound(self, y: np.ndarray, root: np.ndarray) -> np.ndarray:
        """The root with its angles near those of a position, if that is a root, too."""
        manifold = self.assembler.manifold
        turns = np.where(self.angles, np.round(manifold.lead(y, root) / (2 * np.pi)), 0.0)
        if not turns.any():
            return root
        near = manifold.go(root, -2 * np.pi * turns)
        value, zero, _ = self.evaluate(near[None])
        return near if _largest(value / zero)[0] <= SLACK else root

    # searches --------------------------------------------------------------------------------
    def limited(self, steps: np.ndarray) -> np.ndarray:
        """Natural displacements, shortened to limited rotations."""
        return steps / np.max(np.abs(steps) / self.longest, axis=1, initial=1.0)[:, None]

    def newton(self, y: np.ndarray) -> Ends:
        """Roots of the square system by full steps with limited rotations."""
        return self._grouped(y, self._newton)

    def nearest(self, y: np.ndarray) -> Ends:
        """Roots of all equations near positions by damped steps."""
        return self._grouped(y, self._damped)

    def _grouped(self, y: np.ndarray, search: Callable[[np.ndarray], Ends]) -> Ends:
        with np.errstate(all="ignore"):
            ends = [search(y[k : k + self.group]) for k in range(0, len(y), self.group)]
        return Ends(*(np.concatenate([getattr(e, x) for e in ends]) for x in ("y", "size", "open")))

    def _newton(self, y: np.ndarray) -> Ends:
        ends = solve_many(_FullSteps(self), y, FULL_STEPS).points
        return Ends(ends.x, ends.size, _largest(ends.value))

    def _damped(self, y: np.ndarray) -> Ends:
        y, count = y.copy(), len(y)
        damping = np.full(count, 5e-3)
        value, zero, jacobian = self.evaluate(y)
        before = np.full(count, np.inf)
        for step_count in range(2 * STEPS):
            size, norm = _largest(value / zero), np.linalg.norm(value, axis=1)
            if step_count % PATIENCE == 0:
                damping[norm > PROGRESS * before] = np.inf
                before = norm
            going = np.flatnonzero((size > 1) & np.isfinite(size) & (damping < 1e8))
            if not going.size:
                break
            weighed = jacobian[going] * self._reach
            normal = weighed @ weighed.transpose(0, 2, 1)
            diagonal = np.arange(normal.shape[1])
            level = np.trace(normal, axis1=1, axis2=2) / max(normal.shape[1], 1)
            normal[:, diagonal, diagonal] += (
                level * np.maximum(damping[going] * norm[going], MIN_DAMPING)
            )[:, None]
            force = _solve(normal, value[going])
            step = self.limited(-np.einsum("kij,ki->kj", weighed, force) * self._reach)
            there = self.displaced(y[going], step)
            v, z, j = self.evaluate(there)
            nearer = np.linalg.norm(v, axis=1) < norm[going]
            at = going[nearer]
            y[at], value[at], zero[at], jacobian[at] = (
                there[nearer],
                v[nearer],
                z[nearer],
                j[nearer],
            )
            damping[going] *= np.where(nearer, 0.2, 4.0)
            near = ~nearer & (size[going] <= SLACK)
            damping[going[near]] = np.inf  # limited by round-off
        return Ends(y, _largest(value / zero), _largest(value))


@dataclass(eq=False)
class _Linearised(Points):
    """Positions with Newton's steps as natural displacements."""

    step: np.ndarray


class _FullSteps(ManyEquations[_Linearised]):
    """Square systems with Newton's steps, whose rotations are limited."""

    def __init__(self, roots: ManyRoots):
        self.roots = roots

    def points(self, x: np.ndarray, designs: np.ndarray) -> _Linearised:
        value, zero, jacobian = self.roots.evaluate(x)
        return _Linearised(x, value, zero, self.roots.limited(-_solve(jacobian, value)))

    def steps(self, here: _Linearised, designs: np.ndarray) -> np.ndarray:
        far = np.max(np.abs(here.step) * self.roots.metres, axis=1, initial=0.0) >= FAR
        return np.where(far[:, None], np.nan, here.step)

    def after(self, here: _Linearised, steps: np.ndarray, designs: np.ndarray) -> _Linearised:
        return self.points(self.roots.displaced(here.x, steps), designs)


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """(k, n) solutions of (k, n, n) systems; NaN for singular ones."""
    try:
        return np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        solutions = np.full(right.shape, np.nan)
        for k, (a, b) in enumerate(zip(matrix, right, strict=True)):
            try:
                solutions[k] = np.linalg.solve(a, b)
            except np.linalg.LinAlgError:
                continue
        return solutions


def _largest(value: np.ndarray) -> np.ndarray:
    """(k,) largest magnitude; infinite if an entry is NaN."""
    return np.nan_to_num(np.max(np.abs(value), axis=1, initial=0.0), nan=np.inf)
