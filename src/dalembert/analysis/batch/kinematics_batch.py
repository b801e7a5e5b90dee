"""Batches of kinematics at common instants, assembled at once and moved in lanes."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.batch_residuals import residual_shares
from dalembert.analysis.batch.individual_runs import completed_batch
from dalembert.analysis.batch.starts import Starts, backend_of
from dalembert.analysis.batch.states import States, check_memory
from dalembert.analysis.kinematics.kernel import KinematicsKernel
from dalembert.analysis.kinematics.run import (
    COARSE_STEPS,
    LARGEST_TURN,
    REGULAR,
    SMALL_TURN,
    STEP_DISPLACEMENT,
    TOLERANCE,
    KinematicsRun,
)
from dalembert.model.graph.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import reached
from dalembert.symbolic.evaluation.parallel import LaneMarch, in_groups
from dalembert.symbolic.once import once


class KinematicsBatch:
    """Execution of a batch of kinematics; designs that fail the checks run individually.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Kinematics``
    model, designs : model and parameters of the runs
    workers : upper limit of threads
    """

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.count = workers, len(designs)
        self.run = KinematicsRun(analysis, model, None)
        self.kernel: KinematicsKernel = self.run.kernel
        self.backend = backend_of(model)
        e = model.equations
        self.size = e.coordinate_count + 2 * e.speed_count
        if analysis.efforts:
            self.size += e.constraint_count
        check_memory(self.count, self.run.requested.size, self.size)

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether the equations determine every position."""
        return not (model.closure.lost or model.diagnosis.free)

    def execute(self, report: Callable[[float], None]) -> Batch:
        """Batch of all designs; after an interruption with the finished ones."""
        begin = clock.perf_counter()
        starts = Starts(
            self.model,
            self.designs,
            self.backend,
            self.workers,
            (self.run.start, self.run.end),
            False,
            _first(self.kernel),
        )
        statuses = starts.statuses
        states, trusted, residuals, interrupted = self._move(starts, report)
        passed = trusted
        if trusted.size:
            passed = trusted[residual_shares(states, trusted, self.analysis.efforts) <= 1]
        end = float(self.run.requested[-1])
        for k in passed:
            statuses[int(k)] = reached(end, float(residuals[k]))
        task = self.analysis, self.model, self.designs, self.workers
        statistics = {"backend": self.marching.report, "steps per design": self.longest}
        return completed_batch(task, states, statuses, interrupted, statistics, begin)

    def _move(
        self, starts: Starts, report: Callable[[float], None]
    ) -> tuple[States, np.ndarray, np.ndarray, bool]:
        """States at the outputs, designs with trusted steps, residuals, and interruption."""
        requested, started, single = self.run.requested, starts.started, _step(self.kernel)
        step_count = 2 * COARSE_STEPS + requested.size if self.run.chosen else self.run.grid.size
        requested_steps = _requested_steps(self.kernel)
        requested_steps[0] += step_count * started.size
        columns = self.backend.columns(single, True, (3,))
        self.marching = march = LaneMarch(single, columns, self.backend, requested_steps[0])
        p, x0, self.longest = starts.p[started], starts.x0, 0
        x = np.full((self.count, requested.size, self.size), np.nan)
        residuals, trusted = np.full(self.count, np.nan), np.zeros(started.size, dtype=bool)
        displacements, length = np.full(started.size, np.nan), self.model.equations.scales.length

        def move(grid: np.ndarray, sets: np.ndarray, take: Callable[..., None]) -> np.ndarray:
            h, steps = np.diff(grid), np.arange(grid.size - 1)
            shared = march.shared(grid[1:], h)

            def work(group: np.ndarray) -> None:
                path = march.run(x0[group], shared, p[group], steps)
                regular = x0[group, -4] >= REGULAR * 1e-3
                take(group, grid, path, self._trusted(path, h) & regular)

            self.longest = max(self.longest, h.size)
            threads = self.workers if march.threaded else 1
            begun = np.count_nonzero(done) / max(1, started.size)

            def report_group(fraction: float) -> None:
                if take is store_states:
                    report(begun + fraction * sets.size / max(1, started.size))

            return in_groups(work, sets, march.width, threads, report_group)

        def store_displacements(
            group: np.ndarray, _: np.ndarray, path: np.ndarray, converged: np.ndarray
        ) -> None:
            displacements[group] = np.where(
                converged, path[..., -1].max(axis=1, initial=0.0), np.nan
            )

        def store_states(
            group: np.ndarray, grid: np.ndarray, path: np.ndarray, converged: np.ndarray
        ) -> None:
            trusted[group] = converged
            whole = np.concatenate([x0[group, None], path], axis=1)
            x[started[group]] = whole[:, np.searchsorted(grid, requested), : self.size]
            residuals[started[group]] = np.nanmax(whole[..., -3], axis=1) * length

        done, interrupted = np.zeros(started.size, dtype=bool), False
        if self.run.chosen:
            coarse_grid = np.linspace(self.run.start, self.run.end, COARSE_STEPS + 1)
            interrupted = not move(coarse_grid, np.arange(started.size), store_displacements).all()
        for grid, sets in self._grids(displacements):
            if not interrupted:
                done[sets] = move(grid, sets, store_states)
                interrupted = not done[sets].all()
        bodies = _bodies(self.kernel, self.analysis.efforts)
        states = States(self.model, bodies, self.backend, requested, starts.p, x, self.workers)
        return states, started[done & trusted], residuals, not done.all()

    def _grids(self, displacements: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Instants of steps, and the designs that use them.

        As in single runs, the number of steps follows from the largest motion within one of a few
        steps. It is rounded up to a power of two, so that many designs share their instants.
        """
        run = self.run
        with np.errstate(invalid="ignore"):
            doublings = np.ceil(np.log2(np.maximum(displacements / STEP_DISPLACEMENT, 1.0)))
        counts = np.where(
            np.isnan(doublings), run.grid.size, COARSE_STEPS * 2.0 ** np.nan_to_num(doublings)
        )
        grids = []
        for count in np.unique(counts):
            grid = run.grid
            if count + run.requested.size < run.grid.size:
                uniform = np.linspace(run.start, run.end, int(count) + 1)
                grid = np.union1d(uniform, run.requested)
            grids.append((grid, np.flatnonzero(counts == count)))
        return grids

    def _trusted(self, path: np.ndarray, h: np.ndarray) -> np.ndarray:
        """(sets,) whether all steps converged with corrections smaller than their motion."""
        regular, residual, change, displacement = (path[..., k] for k in (-4, -3, -2, -1))
        always, share = SMALL_TURN
        small = np.maximum(always, share * np.abs(h) / (self.run.end - self.run.start))
        with np.errstate(invalid="ignore"):
            converged = (residual < TOLERANCE) & (regular > REGULAR)
            converged &= change <= np.maximum(LARGEST_TURN * displacement, small)
        return np.asarray(np.all(converged, axis=1) & np.all(np.isfinite(path), axis=(1, 2)))


@once
def _requested_steps(kernel: KinematicsKernel) -> list[int]:
    """Number of steps requested by all batches of a model, as in a sweep."""
    return [0]


@once
def _step(kernel: KinematicsKernel) -> ca.Function:
    """``(column, t, h, p) → next`` as in ``single``, with its displacement in natural sizes."""
    single, e = kernel.single, kernel.e
    size, n = single.numel_in(0), e.coordinate_count
    last, t, h, p = (
        ca.SX.sym(s, k) for s, k in zip("cthp", (size + 1, 1, 1, e.p.numel()), strict=True)
    )
    new = single(last[:size], t, h, p)
    step_displacement = e.manifold.displacement(last[:n], new[:n]) / ca.SX(e.scales.displacements)
    largest = ca.norm_inf(step_displacement) if step_displacement.numel() else ca.SX(0)
    return ca.Function("driven_step", [last, t, h, p], [ca.vertcat(new, largest)], {"cse": True})


@once
def _first(kernel: KinematicsKernel) -> ca.Function:
    """``(t, y, p) → column`` from an assembled position."""
    single, e = kernel.single, kernel.e
    t, y, p = (
        ca.SX.sym(s, k) for s, k in zip("typ", (1, e.coordinate_count, e.p.numel()), strict=True)
    )
    column = ca.vertcat(y, ca.SX.zeros(single.numel_in(0) - y.numel()))
    return ca.Function("first", [t, y, p], [ca.vertcat(single(column, t, 0, p), 0)])


@once
def _bodies(kernel: KinematicsKernel, efforts: bool) -> ca.Function:
    """``(t, x, p) → y, v, v̇, λ`` of states; λ is NaN without efforts."""
    e, closure = kernel.e, kernel.model.closure
    n, k, m = e.coordinate_count, e.speed_count, e.constraint_count
    t, p = ca.SX.sym("t"), ca.SX.sym("p", e.p.numel())
    x = ca.SX.sym("x", n + 2 * k + (m if efforts else 0))
    multiplier = ca.SX.nan(len(closure.owners), 1)
    if efforts:
        multiplier = ca.SX.zeros(len(closure.owners), 1)
        multiplier[list(closure.rows)] = x[n + 2 * k :]
    parts = [x[:n], x[n : n + k], x[n + k : n + 2 * k], multiplier]
    return ca.Function("bodies", [t, x, p], [ca.densify(part) for part in parts])
