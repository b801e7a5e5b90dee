"""Status and statistics of a dynamic run."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.residual_check import DynamicsResidualCheck
from dalembert.analysis.singular_positions import LOST, SingularPosition, near_singular_position
from dalembert.integrators.marching.steps import Steps
from dalembert.model.graph.assembly.regularity import left_table
from dalembert.results.recording import EventRecord, Trajectory
from dalembert.results.status import Outcome, Status, reached, stopped, unsolved
from dalembert.symbolic.once import once
from dalembert.timing import Timing


class RunEnd:
    """Diagnosis of the end of a run.

    Parameters
    ----------
    kernel, steps, trajectory : of the run
    p : (np,) parameters
    following : length of the step after the last one [s]
    residual_check : DynamicsResidualCheck of the trajectory
    """

    def __init__(
        self,
        kernel: DynamicsKernel,
        steps: Steps,
        trajectory: Trajectory,
        p: np.ndarray,
        following: float,
        residual_check: DynamicsResidualCheck,
    ):
        self.kernel, self.steps, self.s, self.p = kernel, steps, trajectory, p
        self.following, self.residual_check = following, residual_check
        self.time = float(trajectory.t[-1])
        self.lost = LOST * kernel.model.scales.length

    @property
    def violations(self) -> np.ndarray:
        """Largest violation of a position constraint at every output."""
        return self.residual_check.residuals.violations

    def _ends(self, outcome: Outcome, text: str) -> Status:
        return Status(outcome, text, self.time, float(np.max(self.violations, initial=0.0)))

    def over_budget(self, text: str) -> Status:
        """Status of a run that would exceed its budget."""
        return self._ends(Outcome.NOT_CONVERGED, text)

    def chattering(self, text: str) -> Status:
        """Status of a run that chatters at a switch."""
        return self._ends(Outcome.CHATTERING, text)

    def contact(self, text: str, undecided: bool) -> Status:
        """Status of a run without a unique contact state, or with contacts that chatter."""
        return self._ends(Outcome.UNDECIDED if undecided else Outcome.CHATTERING, text)

    def status(self, ended_by: EventRecord | None) -> Status:
        """Outcome, message and residual of the run."""
        steps, s = self.steps, self.s
        residual = float(np.max(self.violations, initial=0.0))
        if steps.interrupted:
            return stopped(self.time, residual)
        table_end = self.left_table() if steps.message and not steps.explained else ""
        if table_end:
            return self._ends(Outcome.DIVERGED, f"after t = {steps.end:.9g} s {table_end}")
        if steps.explained:
            if singular := self.singular_position():
                return self._ends(Outcome.SINGULAR, singular)
            text = f"after t = {steps.end:.9g} s {steps.message}"
            return self._ends(Outcome.DIVERGED, text)
        newton_residual = self.newton_residual() if steps.message else None
        if newton_residual is not None:
            constraints = self.kernel.equations.constraint_count
            cure = ", or look for a singular position there" if constraints else ""
            return replace(unsolved(steps.end, newton_residual, residual, cure), time=self.time)
        lost = steps.message or not residual <= self.lost
        singular = self.singular_position() if lost else ""
        if singular:
            return self._ends(Outcome.SINGULAR, singular)
        if steps.message:
            text = f"{steps.message} after t = {steps.end:.9g} s; {self.reason}"
            return self._ends(Outcome.DIVERGED, text)
        finite = np.isfinite(s.a).all(axis=0) & np.isfinite(s.multiplier).all(axis=0)
        if not finite.all():
            text = f"accelerations have no unique value at t = {s.t[np.argmin(finite)]:.9g} s"
            return self._ends(Outcome.SINGULAR, text)
        if self.kernel.variants[0].step.corrects and residual > self.lost:
            text = f"the projection left a violation of {residual:.3g}; use a shorter step"
            return self._ends(Outcome.NOT_CONVERGED, text)
        if objection := self.residual_check.objection:
            return self._ends(*objection)
        if ended_by:
            text = f"{ended_by.name} at t = {ended_by.time:.9g} s"
            return self._ends(Outcome.TERMINATED, text)
        return reached(self.time, residual)

    @property
    def reason(self) -> str:
        """Probable cause where steps became too short or the state is not finite."""
        kernel, rates = self.kernel, self.s.a[:, -1:]
        singular = "the mechanism may be at a singular position"
        if kernel.adaptive is None:
            constraints = kernel.equations.constraint_count
            return (
                f"{singular}, or the step too long" if constraints else "the step may be too long"
            )
        finite = np.flatnonzero(np.isfinite(rates[:, 0]))
        if not finite.size:
            return "accelerations are not finite there"
        shares = np.abs(rates[finite, 0]) / kernel.model.scales.speeds[finite]
        k = int(finite[np.argmax(shares)])
        name = kernel.model.guesses.speed_names[k]
        text = f"{name} changes by {rates[k, 0]:.3g} per second there, the fastest of all speeds; "
        text += "a force may jump or grow without bound"
        return f"{text}, or {singular}" if kernel.equations.constraint_count else text

    def left_table(self) -> str:
        """Message about a table that ends where the run ends; empty if none does."""
        model, s = self.kernel.model, self.s
        states = [(s.t[k], s.y[:, k], s.v[:, k]) for k in range(max(0, s.t.size - 2), s.t.size)]
        return left_table(model.parts, model.all_equations, states, self.p)

    def newton_residual(self) -> float | None:
        """Relative residual of Newton's method in the failed step; None if Newton converged."""
        steps = self.steps
        step = self.kernel.variants[steps.mode[-1] if steps.count else self.kernel.latest].step
        if step.residual is None:
            return None
        arguments = (steps.end, self.following, steps.x[:, -1], self.p)
        if np.all(np.isfinite(step.function(*arguments).full())):
            return None
        return float(step.residual(*arguments))

    def singular_position(self) -> str:
        """Message if the run lost its constraints at a singular position, else empty."""
        if self.kernel.formulation.every_equation:
            return ""
        lost = ~(self.violations < self.lost)
        lost_at = float(self.s.t[np.argmax(lost)] if lost.any() else self.s.t[-1])
        kernel, steps = self.kernel, self.steps
        variant = kernel.variants[steps.mode[-1] if steps.count else kernel.latest]
        position = near_singular_position(
            variant.equations, self.steps, self.p, lost_at, self.following
        )
        if position is None:
            return ""
        time, smallest, state = position
        y = self.kernel.view.body_coordinates(time, state, self.p)
        there = SingularPosition(self.kernel.model, time, y, self.p)
        cure = "formulation=AugmentedLagrangian() passes through such positions"
        if not self.kernel.model.diagnosis.free:  # no motion exists beyond a lock
            cure = f"solve_kinematics shows whether the drivers lock there; if not, {cure}"
        return (
            f"the constraints were lost at t = {time:.6g} s near a singular position{there.drivers}"
            f", where {there.joints} lose their independence (smallest singular value of C "
            f"{smallest:.2g}); {cure}"
        )


def statistics(
    kernel: DynamicsKernel,
    steps: Steps,
    s: Trajectory,
    p: np.ndarray,
    timing: Timing,
) -> dict[str, Any]:
    """Statistics of a run: strategies, counts of steps, and computation times."""
    elapsed, parts = timing.parts["integration"], timing.parts
    choices = {
        "coordinates": kernel.coordinates,
        "formulation": kernel.formulation,
        "stabilization": kernel.stabilization,
        "integrator": kernel.integrator,
    }
    entries: dict[str, Any] = {name: type(choice).__name__ for name, choice in choices.items()}
    columns = kernel.steps(int(steps.mode[-1]) if steps.count else 0)
    entries["backend"] = columns.report
    entries |= dict(zip(("code blocks", "distinct code blocks"), columns.pieces, strict=False))
    entries |= {
        "steps": steps.lasting.size,
        "rejected steps": steps.rejected,
        **_counts(kernel, steps),
        "build time [s]": round(kernel.model.build_time, 6),
        "preparation time [s]": round(parts["assembly"] + parts["compile"], 6),
        **timing.statistics,
    }
    entries |= kernel.formulation.report
    if kernel.formulation.every_equation:  # multipliers are iterated or approximate
        entries["maximum |C v̇ − ξ|"] = _acceleration_residual(kernel, s, p)
    modes, h = steps.mode[steps.lasting], steps.h[steps.lasting]
    if np.unique(modes).size > 1:
        entries["variant changes"] = int(np.sum(np.diff(modes) != 0))
    if len(kernel.methods) > 1:
        implicit = [v.integrator.implicit for v in kernel.variants]
        entries["implicit steps"] = int(np.sum(np.array(implicit, dtype=bool)[modes]))
    if crossings := kernel.crossings(steps):
        entries["contact changes" if kernel.contacts else "switches"] = len(crossings)
    if h.size:
        entries["time per step [µs]"] = round(1e6 * elapsed / h.size, 2)
        entries["shortest step [s]"] = float(h.min())
        entries["longest step [s]"] = float(h.max())
    return entries


def _counts(kernel: DynamicsKernel, steps: Steps) -> dict[str, int]:
    """Counts of evaluations that are visible outside of a step."""
    counts: dict[str, int] = {}
    if evaluations := kernel.integrator.evaluations:
        counts["evaluations of accelerations"] = evaluations * (
            int(steps.lasting.size) + steps.rejected
        )
    last = steps.lasting[-1:]
    if last.size and kernel.variants[int(steps.mode[last[0]])].problem.correction is not None:
        counts["projections"] = int(np.sum(steps.corrected))
    return counts


@once
def _largest_residual(kernel: DynamicsKernel) -> ca.Function:
    """``(t, y, v, v̇, p) → |C v̇ − ξ|`` of all equations."""
    e = kernel.model.all_equations
    rest = ca.mtimes(e.jacobian, e.a) - kernel.stabilization.constraint_acceleration(e)
    largest = ca.norm_inf(rest) if rest.numel() else ca.SX(0)
    return ca.Function("rest", [e.t, e.y, e.v, e.a, e.p], [largest])


def _acceleration_residual(kernel: DynamicsKernel, s: Trajectory, p: np.ndarray) -> float:
    """Largest ``|C v̇ − ξ|`` of all equations over the outputs."""
    parameters = np.tile(p[:, None], s.t.size)
    return float(
        _largest_residual(kernel).map(s.t.size)(s.t, s.y, s.v, s.a, parameters).full().max()
    )
