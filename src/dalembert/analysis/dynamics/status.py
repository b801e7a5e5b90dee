"""How a dynamic run ended, and what is told about it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.truth import DynamicsTruth
from dalembert.analysis.singular_positions import LOST, SingularPosition, near_singular_position
from dalembert.integrators.marching.steps import Steps
from dalembert.model.assembly.regularity import left_table
from dalembert.results.recording import EventRecord, Trajectory
from dalembert.results.status import Outcome, Status, reached, stopped, unsolved
from dalembert.symbolic.once import once
from dalembert.timing import Timing


class Ending:
    """The end of a run, examined.

    Parameters
    ----------
    kernel, steps, trajectory : of the run
    p : (np,) parameters
    following : length of the step that comes, or would have come, after the last one [s]
    truth : the trajectory against the model's own equations
    """

    def __init__(
        self,
        kernel: DynamicsKernel,
        steps: Steps,
        trajectory: Trajectory,
        p: np.ndarray,
        following: float,
        truth: DynamicsTruth,
    ):
        self.kernel, self.steps, self.s, self.p = kernel, steps, trajectory, p
        self.following, self.truth = following, truth
        self.time = float(trajectory.t[-1])
        self.lost = LOST * kernel.model.scales.length

    @property
    def violations(self) -> np.ndarray:
        """Largest violation of a position constraint at every output."""
        return self.truth.residuals.violations

    def _ends(self, outcome: Outcome, text: str) -> Status:
        return Status(outcome, text, self.time, float(np.max(self.violations, initial=0.0)))

    def given_up(self, text: str) -> Status:
        """Ended for what it would take."""
        return self._ends(Outcome.NOT_CONVERGED, text)

    def chattering(self, text: str) -> Status:
        """Ended at a switch that no motion leaves."""
        return self._ends(Outcome.CHATTERING, text)

    def contact(self, text: str, undecided: bool) -> Status:
        """Ended where rigid contacts have no motion or several, or open and close for ever."""
        return self._ends(Outcome.UNDECIDED if undecided else Outcome.CHATTERING, text)

    def status(self, ended_by: EventRecord | None) -> Status:
        """Outcome, message and residual."""
        steps, s = self.steps, self.s
        residual = float(np.max(self.violations, initial=0.0))
        if steps.interrupted:
            return stopped(self.time, residual)
        lacking = self.left_table() if steps.message and not steps.explained else ""
        if lacking:
            return self._ends(Outcome.DIVERGED, f"after t = {steps.end:.9g} s {lacking}")
        if steps.explained:
            if singular := self.singular_position():
                return self._ends(Outcome.SINGULAR, singular)
            text = f"after t = {steps.end:.9g} s {steps.message}"
            return self._ends(Outcome.DIVERGED, text)
        left = self.left_open() if steps.message else None
        if left is not None:
            joined = self.kernel.equations.constraint_count
            cure = ", or look for a singular position there" if joined else ""
            return replace(unsolved(steps.end, left, residual, cure), time=self.time)
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
        if objection := self.truth.objection:
            return self._ends(*objection)
        if ended_by:
            text = f"{ended_by.name} at t = {ended_by.time:.9g} s"
            return self._ends(Outcome.TERMINATED, text)
        return reached(self.time, residual)

    @property
    def reason(self) -> str:
        """Why a run ended whose steps became too short, or whose state is not finite."""
        kernel, rates = self.kernel, self.s.a[:, -1:]
        singular = "the mechanism may be at a singular position"
        if kernel.adaptive is None:
            joined = kernel.equations.constraint_count
            return f"{singular}, or the step too long" if joined else "the step may be too long"
        known = np.flatnonzero(np.isfinite(rates[:, 0]))
        if not known.size:
            return "accelerations are not finite there"
        shares = np.abs(rates[known, 0]) / kernel.model.scales.speeds[known]
        k = int(known[np.argmax(shares)])
        name = kernel.model.guesses.speed_names[k]
        text = f"{name} changes by {rates[k, 0]:.3g} per second there, the fastest of all speeds; "
        text += "a force may jump or grow without bound"
        return f"{text}, or {singular}" if kernel.equations.constraint_count else text

    def left_table(self) -> str:
        """Which table ends where the run does; empty if none does."""
        model, s = self.kernel.model, self.s
        states = [(s.t[k], s.y[:, k], s.v[:, k]) for k in range(max(0, s.t.size - 2), s.t.size)]
        return left_table(model.parts, model.all_equations, states, self.p)

    def left_open(self) -> float | None:
        """Relative residual that Newton's method left in the step that failed, if it did."""
        steps = self.steps
        step = self.kernel.variants[steps.mode[-1] if steps.count else self.kernel.latest].step
        if step.residual is None:
            return None
        where = (steps.end, self.following, steps.x[:, -1], self.p)
        if np.all(np.isfinite(step.function(*where).full())):
            return None
        return float(step.residual(*where))

    def singular_position(self) -> str:
        """What to say where a run lost its constraints at a singular position; else empty."""
        if self.kernel.formulation.every_equation:
            return ""
        lost = ~(self.violations < self.lost)
        lost_at = float(self.s.t[np.argmax(lost)] if lost.any() else self.s.t[-1])
        kernel, steps = self.kernel, self.steps
        variant = kernel.variants[steps.mode[-1] if steps.count else kernel.latest]
        found = near_singular_position(
            variant.equations, self.steps, self.p, lost_at, self.following
        )
        if found is None:
            return ""
        time, smallest, place = found
        y = self.kernel.view.body_coordinates(time, place, self.p)
        there = SingularPosition(self.kernel.model, time, y, self.p)
        cure = "formulation=AugmentedLagrangian() passes through such positions"
        if not self.kernel.model.diagnosis.free:  # beyond a lock there is no motion at all
            cure = f"solve_kinematics tells whether the drivers lock there; if not, {cure}"
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
    """What was done, for people, and how long its parts took."""
    elapsed, parts = timing.parts["integration"], timing.parts
    choices = {
        "coordinates": kernel.coordinates,
        "formulation": kernel.formulation,
        "stabilization": kernel.stabilization,
        "integrator": kernel.integrator,
    }
    made: dict[str, Any] = {name: type(choice).__name__ for name, choice in choices.items()}
    columns = kernel.steps(int(steps.mode[-1]) if steps.count else 0)
    made["backend"] = columns.report
    made |= dict(zip(("pieces of code", "different pieces"), columns.pieces, strict=False))
    made |= {
        "steps": steps.lasting.size,
        "rejected steps": steps.rejected,
        **_counts(kernel, steps),
        "build time [s]": round(kernel.model.build_time, 6),
        "preparation time [s]": round(parts["assembly"] + parts["compile"], 6),
        **timing.statistics,
    }
    made |= kernel.formulation.report
    if kernel.formulation.every_equation:  # whose multipliers are iterated or only nearly right
        made["largest |C v̇ − ξ|"] = _acceleration_residual(kernel, s, p)
    modes, h = steps.mode[steps.lasting], steps.h[steps.lasting]
    if np.unique(modes).size > 1:
        made["changes of variant"] = int(np.sum(np.diff(modes) != 0))
    if len(kernel.methods) > 1:
        implicit = [v.integrator.implicit for v in kernel.variants]
        made["implicit steps"] = int(np.sum(np.array(implicit, dtype=bool)[modes]))
    if crossings := kernel.crossings(steps):
        made["changes of contacts" if kernel.contacts else "switches"] = len(crossings)
    if h.size:
        made["time per step [µs]"] = round(1e6 * elapsed / h.size, 2)
        made["shortest step [s]"] = float(h.min())
        made["longest step [s]"] = float(h.max())
    return made


def _counts(kernel: DynamicsKernel, steps: Steps) -> dict[str, int]:
    """How often something was evaluated, where that can be told from outside of a step."""
    found: dict[str, int] = {}
    if each := kernel.integrator.evaluations:
        found["evaluations of accelerations"] = each * (int(steps.lasting.size) + steps.rejected)
    last = steps.lasting[-1:]
    if last.size and kernel.variants[int(steps.mode[last[0]])].problem.correction is not None:
        found["projections"] = int(np.sum(steps.corrected))
    return found


@once
def _left_out(kernel: DynamicsKernel) -> ca.Function:
    """``(t, y, v, v̇, p) → |C v̇ − ξ|`` of all equations."""
    e = kernel.model.all_equations
    rest = ca.mtimes(e.jacobian, e.a) - kernel.stabilization.constraint_acceleration(e)
    largest = ca.norm_inf(rest) if rest.numel() else ca.SX(0)
    return ca.Function("rest", [e.t, e.y, e.v, e.a, e.p], [largest])


def _acceleration_residual(kernel: DynamicsKernel, s: Trajectory, p: np.ndarray) -> float:
    """Largest ``|C v̇ − ξ|`` of all equations over the outputs."""
    parameters = np.tile(p[:, None], s.t.size)
    return float(_left_out(kernel).map(s.t.size)(s.t, s.y, s.v, s.a, parameters).full().max())
