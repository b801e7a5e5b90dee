"""Kinematics of many designs at the same instants: assembled at once, moved side by side."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.ending import ended_batch
from dalembert.analysis.batch.judgement import open_by
from dalembert.analysis.batch.starts import Starts, backend_of
from dalembert.analysis.batch.states import States
from dalembert.analysis.kinematics.kernel import KinematicsKernel
from dalembert.analysis.kinematics.run import (
    FEW,
    LARGEST_TURN,
    REGULAR,
    SHORT_WAY,
    SMALL_TURN,
    TOLERANCE,
    KinematicsRun,
)
from dalembert.budget import check_budget
from dalembert.model.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import reached
from dalembert.symbolic.evaluation.lane_march import LaneMarch, in_groups
from dalembert.symbolic.once import once


class DrivenSteps:
    """One execution of a batch; what is not beyond doubt has a run of its own.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Kinematics``
    model, designs : what is moved
    workers : threads at most
    """

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.count = workers, len(designs)
        self.run = KinematicsRun(analysis, model, None)
        self.kernel: KinematicsKernel = self.run.kernel
        self.backend = backend_of(model)
        e, times = model.equations, self.run.requested.size
        self.kept = e.coordinate_count + 2 * e.speed_count
        if analysis.efforts:
            self.kept += e.constraint_count
        check_budget(
            f"{self.count} designs with {times} outputs of {self.kept} numbers",
            memory=24.0 * self.count * times * self.kept,
            cure="ask for fewer, e.g. outputs=101, or move the designs in several batches",
        )

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether its equations determine every position."""
        return not (model.closure.lost or model.diagnosis.free)

    def execute(self, report: Callable[[float], None]) -> Batch:
        """All designs; after an interruption those that were finished."""
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
        states, known, residuals, interrupted = self._move(starts, report)
        passed = known
        if known.size:
            passed = known[open_by(states, known, self.analysis.efforts) <= 1]
        end = float(self.run.requested[-1])
        for k in passed:
            statuses[int(k)] = reached(end, float(residuals[k]))
        made_by = self.analysis, self.model, self.designs, self.workers
        about = {"backend": self.marching.report, "steps of a design": self.longest}
        return ended_batch(made_by, states, statuses, interrupted, about, begin)

    def _move(
        self, starts: Starts, report: Callable[[float], None]
    ) -> tuple[States, np.ndarray, np.ndarray, bool]:
        """States at the outputs, designs trusted all the way, residuals, and whether it stopped."""
        requested, known, single = self.run.requested, starts.known, _step(self.kernel)
        looks = 2 * FEW + requested.size if self.run.chosen else self.run.grid.size
        asked = _asked(self.kernel)
        asked[0] += looks * known.size
        columns = self.backend.columns(single, True, (3,))
        self.marching = march = LaneMarch(single, columns, self.backend, asked[0])
        p, x0, self.longest = starts.p[known], starts.x0, 0
        x = np.full((self.count, requested.size, self.kept), np.nan)
        residuals, trusted = np.full(self.count, np.nan), np.zeros(known.size, dtype=bool)
        moved, length = np.full(known.size, np.nan), self.model.equations.scales.length

        def move(grid: np.ndarray, sets: np.ndarray, take: Callable[..., None]) -> np.ndarray:
            h, every = np.diff(grid), np.arange(grid.size - 1)
            shared = march.shared(grid[1:], h)

            def work(group: np.ndarray) -> None:
                path = march.run(x0[group], shared, p[group], every)
                regular = x0[group, -4] >= REGULAR * 1e-3
                take(group, grid, path, self._trusted(path, h) & regular)

            self.longest = max(self.longest, h.size)
            threads = self.workers if march.threaded else 1
            begun = np.count_nonzero(done) / max(1, known.size)

            def told(fraction: float) -> None:
                if take is keep:
                    report(begun + fraction * sets.size / max(1, known.size))

            return in_groups(work, sets, march.width, threads, told)

        def look(group: np.ndarray, _: np.ndarray, path: np.ndarray, sound: np.ndarray) -> None:
            moved[group] = np.where(sound, path[..., -1].max(axis=1, initial=0.0), np.nan)

        def keep(group: np.ndarray, grid: np.ndarray, path: np.ndarray, sound: np.ndarray) -> None:
            trusted[group] = sound
            whole = np.concatenate([x0[group, None], path], axis=1)
            x[known[group]] = whole[:, np.searchsorted(grid, requested), : self.kept]
            residuals[known[group]] = np.nanmax(whole[..., -3], axis=1) * length

        done, stopped = np.zeros(known.size, dtype=bool), False
        if self.run.chosen:
            few = np.linspace(self.run.start, self.run.end, FEW + 1)
            stopped = not move(few, np.arange(known.size), look).all()
        for grid, sets in self._grids(moved):
            if not stopped:
                done[sets] = move(grid, sets, keep)
                stopped = not done[sets].all()
        bodies = _bodies(self.kernel, self.analysis.efforts)
        states = States(self.model, bodies, self.backend, requested, starts.p, x, self.workers)
        return states, known[done & trusted], residuals, not done.all()

    def _grids(self, moved: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Instants of steps, and the designs that take them.

        As single runs do, designs take no more steps than the way asks for that they go at most in
        one of a few; but their number is rounded up, so that many have the same.
        """
        run = self.run
        with np.errstate(invalid="ignore"):
            times = np.ceil(np.log2(np.maximum(moved / SHORT_WAY, 1.0)))
        counts = np.where(np.isnan(times), run.grid.size, FEW * 2.0 ** np.nan_to_num(times))
        made = []
        for count in np.unique(counts):
            grid = run.grid
            if count + run.requested.size < run.grid.size:
                needed = np.linspace(run.start, run.end, int(count) + 1)
                grid = np.union1d(needed, run.requested)
            made.append((grid, np.flatnonzero(counts == count)))
        return made

    def _trusted(self, path: np.ndarray, h: np.ndarray) -> np.ndarray:
        """(sets,) whether all steps converged with corrections small against their motion."""
        regular, residual, change, moved = (path[..., k] for k in (-4, -3, -2, -1))
        always, share = SMALL_TURN
        small = np.maximum(always, share * np.abs(h) / (self.run.end - self.run.start))
        with np.errstate(invalid="ignore"):
            sound = (residual < TOLERANCE) & (regular > REGULAR)
            sound &= change <= np.maximum(LARGEST_TURN * moved, small)
        return np.asarray(np.all(sound, axis=1) & np.all(np.isfinite(path), axis=(1, 2)))


@once
def _asked(kernel: KinematicsKernel) -> list[int]:
    """Steps that batches of this model have asked for: those of a sweep are many."""
    return [0]


@once
def _step(kernel: KinematicsKernel) -> ca.Function:
    """``(column, t, h, p) → next`` as ``single``, and how far it goes, by natural sizes."""
    single, e = kernel.single, kernel.e
    size, n = single.numel_in(0), e.coordinate_count
    last, t, h, p = (
        ca.SX.sym(s, k) for s, k in zip("cthp", (size + 1, 1, 1, e.p.numel()), strict=True)
    )
    new = single(last[:size], t, h, p)
    way = e.manifold.displacement(last[:n], new[:n]) / ca.SX(e.scales.displacements)
    moved = ca.norm_inf(way) if way.numel() else ca.SX(0)
    return ca.Function("driven_step", [last, t, h, p], [ca.vertcat(new, moved)], {"cse": True})


@once
def _first(kernel: KinematicsKernel) -> ca.Function:
    """``(t, y, p) → column`` of an assembled position."""
    single, e = kernel.single, kernel.e
    t, y, p = (
        ca.SX.sym(s, k) for s, k in zip("typ", (1, e.coordinate_count, e.p.numel()), strict=True)
    )
    column = ca.vertcat(y, ca.SX.zeros(single.numel_in(0) - y.numel()))
    return ca.Function("first", [t, y, p], [ca.vertcat(single(column, t, 0, p), 0)])


@once
def _bodies(kernel: KinematicsKernel, efforts: bool) -> ca.Function:
    """``(t, x, p) → y, v, v̇, λ`` of states; where efforts are not asked for, λ is not known."""
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
