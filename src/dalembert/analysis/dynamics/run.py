"""Execution of a dynamic analysis: start, march, events, outputs, status."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.analysis.contact.gap_checks import contact_start, ignored_contacts
from dalembert.analysis.contact.search import ContactSearch
from dalembert.analysis.dynamics.dense_outputs import DenseOutputs, contact_changes
from dalembert.analysis.dynamics.event_search import EventSearch
from dalembert.analysis.dynamics.record import DynamicsRecord
from dalembert.analysis.dynamics.residual_check import DynamicsResidualCheck
from dalembert.analysis.dynamics.status import RunEnd, statistics
from dalembert.analysis.dynamics.step_accuracy import StepAccuracy
from dalembert.analysis.dynamics.step_length_checks import (
    BranchJumps,
    strategy_warnings,
    unstable_step_warnings,
)
from dalembert.analysis.dynamics.switch_search import SwitchSearch
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.events import as_events
from dalembert.analysis.output_places import outputs_of
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.timeline import (
    Pace,
    afford_states,
    check_driver_laws,
    run_times,
    step_count,
    uniform_grid,
)
from dalembert.budget import STEP
from dalembert.errors import AssemblyError, SingularityError
from dalembert.integrators.marching.march import SHORT_CHUNK
from dalembert.integrators.marching.method_choice import MethodChoice
from dalembert.integrators.marching.steps import (
    Crossing,
    Steps,
    Switch,
    Watch,
    halving_warnings,
    standstill,
)
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.results.recording import EventRecord
from dalembert.results.status import Outcome, Status, Warnings
from dalembert.timing import Timing

SHORTEST = 1e-12
"""Step length, relative to the time, of the failed step of an adaptive run."""
REJECTED = (Outcome.VIOLATED, Outcome.UNBALANCED)
"""Outcomes of complete runs that are not motions of the model; they recommend a step, too."""
PASSING = ", or use formulation=AugmentedLagrangian(), which passes through such positions"
COPIES = 8
"""Memory of a run in units of its states: trajectory, measures and their arguments."""


class DynamicsRun:
    """One execution of a dynamic analysis.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model : Model
    parameters : new values, or the whole vector
    """

    def __init__(self, analysis: Any, model: Model, parameters):
        self.analysis, self.model = analysis, model
        self.start, self.end, self.step, self.requested = run_times(analysis)
        self.begin = self.start
        self._check_budget()
        self.p = model.values(parameters)
        contacts = analysis.coordinates.rigid_contacts
        model, self.closed_gaps = contact_start(model, self.p, self.start, contacts)
        self.model = model
        model.diagnosis.refuse_massless()
        if not analysis.formulation.every_equation:
            model.closure.refuse_singular_start(PASSING)
        check_driver_laws(model, np.linspace(self.start, self.end, 1001), self.p)
        self.kernel = analysis.kernel(model)
        if self.kernel.sampling is not None:
            self.kernel.sampling.forget()
        self._refuse_lost_mass()
        self.events = EventSearch(self.kernel, as_events(analysis.events), self.p)
        self.switches = SwitchSearch(self.kernel, self.p, self.start, self.end)
        self.contacts: ContactSearch | None = None
        if modes := self.kernel.contacts:
            self.contacts = ContactSearch(self.kernel, modes, self.p, self.start, self.end)

    def _check_budget(self) -> None:
        """Refuse too many steps and outputs; adaptive runs count their smallest number of steps."""
        e, integrator = self.model.equations, self.analysis.integrator
        longest = integrator.longest_step or self.end - self.start
        step = min(longest, self.end - self.start) if integrator.adaptive else self.step
        count = step_count(self.start, self.end, step)
        count = count if self.requested is None else self.requested.size
        numbers = e.coordinate_count + 2 * e.speed_count + e.constraint_count
        afford_states(count, COPIES * numbers)

    def _refuse_lost_mass(self) -> None:
        """Refuse a zero mass that was positive when the model was built."""
        mass = np.diag(self.model.mass_matrix(self.p))
        lost = set(np.flatnonzero(mass == 0)) - set(self.model.equations.massless)
        if lost and self.kernel.formulation.needs_mass:
            names = ", ".join(self.model.guesses.speed_names[k] for k in sorted(lost))
            raise SingularityError(
                f"the inertia of {names} is zero with these parameters but was not when the model "
                "was built; build it with this value, or use formulation=KKT()"
            )

    def initial_state(self) -> tuple[np.ndarray, int]:
        state = self.model.assemble(self.p, self.start)
        length = self.end - self.start
        method = self.analysis.integrator
        self.stability_warnings = unstable_step_warnings(
            self.model, state, self.p, method, self.step, length
        )
        if self.analysis.strict and state.projected_speeds:
            raise AssemblyError(
                "initial speeds are inconsistent with the joints: "
                + ", ".join(
                    f"{n} changed by {c:.3g}" for n, c in state.velocity_corrections.items()
                )
            )
        x0, mode = self.kernel.initial(state, self.start, self.p)
        if self.contacts is None:
            return x0, mode
        mode = self.contacts.begin(x0, mode)
        return self.kernel.remembered(self.start, x0, self.p, mode), mode

    def warnings(self, motion: Motion, check: DynamicsResidualCheck) -> list[str]:
        """Warnings about strategies and results; energy exchange below rounding counts as zero."""
        a = self.analysis
        exchanged = float(np.max(np.abs(motion.trajectory.work), initial=0.0))
        if exchanged <= 1e-9 * np.max(motion.values("kinetic_energy"), initial=0.0):
            exchanged = 0.0
        freedom = self.model.diagnosis.free
        formulation = self.kernel.formulation
        choice = formulation, a.stabilization, a.integrator
        warnings = strategy_warnings(*choice, self.step, freedom, exchanged)
        warnings += self.stability_warnings
        warnings += self.contacts.warnings if self.contacts else []
        if not a.coordinates.rigid_contacts:
            warnings += ignored_contacts(self.model, motion.trajectory, self.p)
        warnings += halving_warnings(self.halved_steps(motion.record.steps))
        if motion.status.success:
            warnings += check.warnings + BranchJumps(self.kernel, motion.record.steps).warnings
        warnings += elastic_warnings(self.model, motion.trajectory, self.p)
        return warnings

    def accuracy_warnings(self, motion: Motion) -> list[str]:
        """Warnings about an estimated error above the tolerance."""
        accuracy, integrator = motion.record.accuracy, self.analysis.integrator
        if accuracy is None or not (motion.status.success or motion.status.outcome in REJECTED):
            return []
        if not integrator.controls_error:
            return accuracy.fixed_step_warnings  # type: ignore[no-any-return]
        rtol = integrator.run_tolerance
        return [] if rtol is None else accuracy.tolerance_warnings(rtol)

    def execute(self, progress) -> Motion:
        timing = Timing()
        x0, mode = self.initial_state()
        timing.lap("assembly")
        self.prepare(mode)
        timing.lap("compile")
        with progress_reporter(progress, f"integrating {self.model.name}") as report:
            watch = self.watch(report)
            steps = self.march(x0, mode, watch)
        timing.lap("integration")
        events, ends = self.events.find(steps)
        if ends is not None:
            steps = self.events.cut(steps, *ends)
        adaptive = self.kernel.adaptive is not None
        jumps = contact_changes(self.kernel, steps) if adaptive else self.kernel.jumps(steps)
        requested = self.requested
        if requested is None and self.contacts is None and self.halved_steps(steps):
            requested = self.instants
        times, places = outputs_of(steps, requested, ends is not None, jumps)
        dense = requested is None and adaptive
        if dense:
            outputs = DenseOutputs(self.kernel, steps, times, places, self.p)
            places, trajectory = outputs.places, outputs.trajectory
        else:
            trajectory = self.kernel.trajectory(times, steps, places, self.p)
        timing.lap("outputs")
        balance = self.analysis.balance
        check = DynamicsResidualCheck(self.kernel, steps, trajectory, self.p, balance)
        motion = Motion(
            model=self.model,
            analysis=self.analysis,
            parameters=self.p,
            trajectory=trajectory,
            status=self.status(steps, check, events if ends is not None else []),
            statistics=statistics(self.kernel, steps, trajectory, self.p, timing),
            events=events,
            record=DynamicsRecord(
                self.kernel, steps, places, dense=dense, accuracy=self.accuracy(steps)
            ),
        )
        if self.contacts:
            motion.statistics |= self.contacts.statistics(steps.end)
            if self.closed_gaps:
                motion.statistics["initial overlaps removed"] = self.closed_gaps
            motion.impacts = [i for i in self.contacts.impacts if i.time <= steps.end]
        warnings = self.warnings(motion, check)
        motion.warnings = Warnings(warnings, lambda: self.accuracy_warnings(motion))
        timing.lap("checks")
        motion.statistics |= timing.statistics
        return motion

    def accuracy(self, steps: Steps) -> StepAccuracy | None:
        """Error estimate, computed when it is read; None for multistep methods."""
        methods = self.kernel.methods
        if any(m.controls_error and m.stability is None for m in methods):
            return None
        return StepAccuracy(self.kernel, steps, self.p)

    def prepare(self, mode: int) -> None:
        """Compile the march, so that compilation is not part of its time."""
        if self.kernel.adaptive is not None:
            self.kernel.adaptive.prepare(mode)
        else:
            count = self.grid.size - 1
            count = min(count, SHORT_CHUNK) if self.contacts else count
            self.kernel.fixed.prepare(count, mode)

    @property
    def grid(self) -> np.ndarray:
        """Times of fixed steps."""
        return uniform_grid(self.begin, self.end, self.step)

    @property
    def instants(self) -> np.ndarray:
        """Ends of the fixed steps of the whole run."""
        return self.grid

    def halved_steps(self, steps: Steps) -> int:
        """Number of fixed steps that were halved."""
        return steps.rejected if self.kernel.adaptive is None else 0

    # marching ----------------------------------------------------------------------
    def march(self, x0: np.ndarray, mode: int, watch: Watch) -> Steps:
        kernel, sampling = self.kernel, self.kernel.sampling
        samples = sampling and sampling.samples(self.begin, self.end)
        if self.contacts and self.contacts.trouble:  # no motion leaves the start
            return standstill(self.begin, x0, self.contacts.trouble)
        if kernel.adaptive is None:
            events = bool(self.contacts)
            return kernel.fixed.run(self.grid, x0, self.p, mode, watch, events, samples)
        longest = kernel.integrator.longest_in(self.end - self.begin)
        first = min(self.first_step, longest)
        span = self.begin, self.end
        return kernel.adaptive.run(*span, x0, self.p, first, longest, mode, watch, samples)

    @property
    def first_step(self) -> float:
        """Length of the first attempted step of an adaptive integrator [s]."""
        return self.step if self.analysis.step else 1e-4 * (self.end - self.start)

    def watch(self, report: Callable[[float], None]) -> Watch:
        """Callbacks of the march; the states of all steps are stored where all are outputs."""
        store_all = self.requested is None
        stored = 24.0 * self.model.equations.coordinate_count if store_all else 0.0
        self.pace = Pace(self.start, self.end, STEP + stored)
        memory = np.inf if store_all else self.analysis.memory
        choice, kernel = None, self.kernel
        if len(kernel.methods) > 1:
            mode_functions = kernel.implicit, kernel.cost, kernel.by_other_method
            choice = MethodChoice(self.end, *mode_functions)
        hooks = report, self.ends, self.switch, self.cross
        return Watch(*hooks, choice, memory, self.requested)

    def ends(self, ends: np.ndarray, states: np.ndarray, modes: np.ndarray) -> bool:
        """Whether a terminal event happens in these steps, or the run would need too many."""
        return self.events.terminal_crossing(ends, states, modes) or self.pace.exceeds(ends)

    def cross(self, times: np.ndarray, states: np.ndarray, mode: int) -> Crossing | None:
        """The first change of a rigid contact or of a switch in these steps."""
        contact = self.contacts.cross(times, states, mode) if self.contacts else None
        if self.kernel.adaptive is None or not self.kernel.equations.switches.count:
            return contact
        if contact is not None:
            times, states = times[: contact.accepted + 2], states[:, : contact.accepted + 2]
        switch = self.switches.cross(times, states, mode)
        if contact is None or switch is None:
            return contact or switch
        return min(contact, switch, key=lambda crossing: crossing.t[0] + crossing.h[0])

    def switch(self, times: np.ndarray, states: np.ndarray, mode: int) -> Switch:
        return self.kernel.switch(times, states, mode, self.p)

    # status ------------------------------------------------------------------
    def status(
        self, steps: Steps, check: DynamicsResidualCheck, ended_by: list[EventRecord]
    ) -> Status:
        """Status of the run; ``ended_by`` are the events up to a terminal one."""
        following = self.following_length(steps)
        end = RunEnd(self.kernel, steps, check.s, self.p, following, check)
        if self.contacts and self.contacts.trouble and not ended_by:
            return end.contact(self.contacts.trouble, self.contacts.inconsistent)
        if self.switches.trouble and not ended_by:
            return end.chattering(self.switches.trouble)
        if self.pace.excess:
            return end.over_budget(self.pace.excess)
        return end.status(ended_by[-1] if ended_by else None)

    def following_length(self, steps: Steps) -> float:
        """Length of the step after the last one [s]."""
        if self.kernel.adaptive is not None:
            return SHORTEST * max(self.end - self.start, abs(steps.end))
        lengths, done = np.diff(self.grid), np.searchsorted(self.grid, steps.end + steps.instant)
        return float(lengths[min(max(int(done) - 1, 0), lengths.size - 1)])
