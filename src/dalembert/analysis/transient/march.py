"""Accepted steps of the dynamics of a structure, with their states and charts of its rotations.

A rotation has many vectors, ``r`` and ``r − 2π r/|r|`` among them, and the map from their rates to
the spin is singular where ``|r| = 2π``. Vectors longer than π at the end of a step are replaced by
the shorter ones before the next step, with their rates and accelerations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.output_places import OutputPlaces
from dalembert.analysis.transient.equation import EquationOfMotion, motion_of
from dalembert.analysis.transient.start import TransientStart
from dalembert.analysis.transient.step import TransientStep
from dalembert.integrators.marching.checkpoints import Recorder
from dalembert.integrators.marching.steps import Schedule, Steps
from dalembert.integrators.newmark.rule import Moving
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.status import Outcome, Status, reached, stopped, unsolved


class March:
    """Accepted steps, and the states at their ends.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model : StructuralModel, linear or not as in the analysis
    p : (np,) values of the parameters
    start : of the run [s]
    """

    def __init__(self, analysis: Any, model: StructuralModel, p: np.ndarray, start: float):
        case = analysis.case_of(model)
        self.analysis = analysis
        self.equation = EquationOfMotion(model, p, case, analysis.damping, analysis.lumped)
        self.start = TransientStart(self.equation, analysis.start, case, start)
        self.charts = RotationCharts(self.equation)
        self.shortened: dict[int, np.ndarray] = {}
        """Number of steps → rotations whose vectors were replaced after them."""
        self._steps: dict[float, TransientStep] = {}
        self.steps: Steps

    def step(self, h: float) -> TransientStep:
        """Step of a length; equal lengths share their factors."""
        if h not in self._steps:
            self._steps[h] = TransientStep(self.equation, self.analysis.integrator, h)
        return self._steps[h]

    @property
    def iterations(self) -> int:
        """Number of Newton iterations in all steps."""
        return sum(step.iterations for step in self._steps.values())

    @property
    def factorisations(self) -> int:
        """Number of factorisations in all steps."""
        return sum(step.factorisations for step in self._steps.values())

    def run(self, times: np.ndarray, report: Callable[[float], None]) -> Status:
        """Take the steps between the times; returns the status.

        A step in which Newton's method fails is halved, repeatedly if necessary.
        """
        state = self.start.state()
        recorder = Recorder(np.concatenate(state), steps=times.size - 1)
        lengths, accepted = _lengths(times), 0
        no_halvings = np.zeros(lengths.size, dtype=int)
        schedule = Schedule(times[:-1], lengths, no_halvings > 0, no_halvings)
        status: Status | None = None
        try:
            while accepted < schedule.h.size:
                t, h = float(schedule.t[accepted]), float(schedule.h[accepted])
                end = float(np.append(schedule.t, times[-1])[accepted + 1])
                result = self.step(h).advance(state, end)
                if result is None:
                    if schedule.halve(accepted):
                        continue
                    status = unsolved(t, self.step(h).relative_residual, 0.0)
                    break
                if not np.all(np.isfinite(result.a)):
                    text = f"no finite state after t = {t:.9g} s; use a shorter step"
                    status = Status(Outcome.DIVERGED, text)
                    break
                accepted += 1
                state = self._shorten(result, accepted)
                recorder.add(np.array([t, end]), np.concatenate(state)[:, None])
                report(accepted / schedule.h.size)
        except KeyboardInterrupt:
            status = stopped(float(np.append(schedule.t, times[-1])[accepted]), 0.0)
        x = recorder.states(None)
        steps = Steps(schedule.t, schedule.h, x, schedule.corrected, schedule.mode, schedule.halved)
        self.steps = steps if accepted == schedule.h.size else steps.cut(accepted)
        end, residual = self.steps.end, self._residual(float(lengths[0]))
        return replace(status or reached(end, 0.0), time=end, residual=residual)

    def _residual(self, h: float) -> float:
        """Residual of the equations of motion at the end, relative to their terms."""
        e, end = self.equation, self.steps.end
        last = motion_of(self.node(self.steps.count))
        rows = e.free if self.steps.count else e.massive
        step, sizes = self.step(h), abs(e.tangent(last.u))
        return step.residual(last, e.loads(end), rows, sizes).relative(step.settings.tolerance)

    def _shorten(self, x: Moving, node: int) -> Moving:
        rotations = self.charts.long(x.u)
        if not rotations.size:
            return x
        self.shortened[node] = rotations
        for step in self._steps.values():
            step.previous = None
        return self.charts.shorten(x, rotations)

    def node(self, k: int) -> Moving:
        """State at the end of step ``k``; the start for zero."""
        return Moving(*self.steps.x[:, k].reshape(4, -1))

    def arrived(self, k: int) -> Moving:
        """State at the end of step ``k`` before rotation vectors were replaced."""
        x, rotations = self.node(k), self.shortened.get(k)
        return x if rotations is None else self.charts.shorten(x, rotations)

    def states(self, places: OutputPlaces) -> list[Moving]:
        """States at outputs; between the ends of steps by a shorter step."""
        ends = places.ends_of(self.steps)
        return [
            self.node(int(k) + int(end)) if end or not length else self._inside(int(k), length)
            for k, length, end in zip(places.index, places.length, ends, strict=True)
        ]

    def _inside(self, k: int, length: float) -> Moving:
        step = TransientStep(self.equation, self.analysis.integrator, length)
        state = step.advance(self.node(k), float(self.steps.t[k]) + length)
        if state is None:
            return Moving(*np.full((4, self.equation.assembly.size), np.nan))
        return state


def _lengths(times: np.ndarray) -> np.ndarray:
    """Lengths of the steps; nearly equal ones become identical."""
    h = np.diff(times)
    same = np.isclose(h, h[0], rtol=1e-9, atol=0)
    return np.where(same, h[0], h)


class RotationCharts:
    """Spatial nodes with free rotations, on which no element counts whole turns.

    Parameters
    ----------
    equation : EquationOfMotion
    """

    def __init__(self, equation: EquationOfMotion):
        e, degrees = equation, equation.model.degrees
        eligible = np.ones(e.assembly.size, dtype=bool)
        eligible[e.held] = eligible[e.load_case.nodal.filled] = False
        for block in e.assembly.blocks:
            if block.kind.cls.counts_turns:
                eligible[block.degrees] = False
        table = degrees.table[:, degrees.dimension :]
        if e.linear or degrees.dimension < 3:
            table = table[:0]
        self.table = table[(table >= 0).all(axis=1) & eligible[table].all(axis=1)]
        """(nodes, 3) numbers of the rotations."""

    def long(self, u: np.ndarray) -> np.ndarray:
        """(k, 3) numbers of the rotations by more than π."""
        return self.table[np.linalg.norm(u[self.table], axis=1) > np.pi]

    def shorten(self, x: Moving, rotations: np.ndarray) -> Moving:
        """The same motion with the other vectors of rotations (k, 3); an involution."""
        return _with_columns(x, rotations, VALUE(_columns(x, rotations)))

    def push(self, x: Moving, rotations: np.ndarray, change: Moving) -> Moving:
        """Change of ``shorten`` with changes (n, columns)."""
        return self._linear(PUSH, x, rotations, change)

    def pull(self, x: Moving, rotations: np.ndarray, weights: Moving) -> Moving:
        """Weights of the motion from those (n, columns) of ``shorten``."""
        return self._linear(PULL, x, rotations, weights)

    def _linear(
        self, function: ca.Function, x: Moving, rotations: np.ndarray, tangent: Moving
    ) -> Moving:
        columns = _columns(tangent, rotations)
        at = np.repeat(_columns(x, rotations), tangent.u.shape[1], axis=1)
        return _with_columns(tangent, rotations, function(at, columns))


def _columns(x: Moving, rotations: np.ndarray) -> np.ndarray:
    """(12, k · columns) rotations with their rates, accelerations and memory."""
    return np.concatenate([part[rotations.T].reshape(3, -1) for part in x])


def _with_columns(x: Moving, rotations: np.ndarray, columns: ca.DM) -> Moving:
    copy = Moving(*(part.copy() for part in x))
    for part, rows in zip(copy, np.split(np.array(columns), 4), strict=True):
        part[rotations.T] = rows.reshape(part[rotations.T].shape)
    return copy


def _functions() -> tuple[ca.Function, ca.Function, ca.Function]:
    """Rotation vector, rate, acceleration and memory of the shorter vector; both tangents."""
    x, w = ca.SX.sym("x", 12), ca.SX.sym("w", 12)
    r, v, a, s = ca.vertsplit(x, 3)
    shorter = r * (1 - 2 * ca.pi / ca.norm_2(r))
    rate = ca.jtimes(shorter, r, v)
    acceleration = ca.jtimes(rate, r, v) + ca.jtimes(shorter, r, a)
    memory = ca.jtimes(shorter, r, s)
    value = ca.vertcat(shorter, rate, acceleration, memory)
    return (
        ca.Function("shorter", [x], [value]),
        ca.Function("push", [x, w], [ca.jtimes(value, x, w)]),
        ca.Function("pull", [x, w], [ca.jtimes(value, x, w, True)]),
    )


VALUE, PUSH, PULL = _functions()
