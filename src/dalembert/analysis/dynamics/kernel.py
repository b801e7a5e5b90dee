"""Compiled functions of a dynamic analysis: marches, and evaluation of their steps."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial

import casadi as ca
import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.contact.contact_dynamics import check_contacts
from dalembert.analysis.contact.modes import ContactModes
from dalembert.analysis.contact.state_jumps import first_headings
from dalembert.analysis.dynamics.sampling import Sampling
from dalembert.analysis.dynamics.step_outputs import StepOutputs
from dalembert.analysis.dynamics.transition import MovingSide, Transition, crossed, distances
from dalembert.analysis.dynamics.variant import Variant
from dalembert.errors import SingularityError, UnsupportedError
from dalembert.formulations.base import Formulation
from dalembert.formulations.partition import best_rows, rows_determine
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Attempt, Integrator
from dalembert.integrators.marching.adaptive import AdaptiveMarch
from dalembert.integrators.marching.march import FixedMarch
from dalembert.integrators.marching.steps import Steps, Switch
from dalembert.model.graph.assembly.closure import AssembledState
from dalembert.model.graph.contacts import Phase, Phases, touching
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.model import Model
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.evaluation.backends import Backend, VirtualMachine
from dalembert.symbolic.evaluation.columns import Columns

STAGES = 4
"""Typical number of evaluations of accelerations per step."""


class DynamicsKernel(StepOutputs):
    """Compiled functions of one model under one choice of strategies.

    Built once by ``Dynamics.kernel`` and shared by runs, replays and gradients. Formulations that
    depend on a choice of independent speeds have one ``Variant`` per choice used so far, and each
    crossed switch has a ``Transition``; a *mode* is the index of a variant, and every step stores
    its mode.

    Parameters
    ----------
    model : Model
    coordinates, formulation, stabilization, integrator : as in ``Dynamics``
    backend : evaluator of the functions

    Attributes
    ----------
    view : CoordinateView, the model in the coordinates that are integrated
    equations : Equations in these coordinates, as passed to formulations
    variants : list of Variant and Transition, by mode
    contacts : ContactModes of rigid gaps, None where there are none
    sampling : Sampling of blocks of discrete time, None where there are none
    fixed : FixedMarch over given steps; also repeats steps of adaptive runs
    adaptive : AdaptiveMarch, or None for integrators of fixed steps

    Raises
    ------
    UnsupportedError, ModelError
        The model cannot be described in these coordinates, or the strategies are incompatible.
    """

    def __init__(
        self,
        model: Model,
        coordinates: Coordinates,
        formulation: Formulation,
        stabilization: Stabilization,
        integrator: Integrator,
        backend: Backend | None = None,
    ):
        self.model, self.formulation, self.stabilization = model, formulation, stabilization
        self.coordinates, self.integrator = coordinates, integrator
        explicit = formulation.gives_accelerations
        methods = [method for method in integrator.methods if explicit or method.implicit]
        self.methods = methods or [integrator]
        self.backend = backend or VirtualMachine()
        stabilization.check(formulation)
        self.view = coordinates.view(model, formulation.every_equation)
        if integrator.adaptive:
            self.view.freeze_branches()
        self.equations = self.view.equations
        self.variants: list[Variant] = []
        self.contacts: ContactModes | None = None
        if self.equations.contacts:
            check_contacts(self.equations, formulation)
            self.contacts = ContactModes(self.view, self.variants, self.choose)
        self.sampling = Sampling.of(model, self.variants)
        self._transitions: dict[tuple[int, int, bool], int] = {}
        self._sides: dict[tuple[int, bool], int] = {}
        self.fixed = FixedMarch(
            lambda mode: self.variants[mode].step, stabilization.period, self.backend
        )
        self.adaptive: AdaptiveMarch | None = None
        if integrator.adaptive:
            crossed = self.crossed if self.equations.switches.count else None
            self.adaptive = AdaptiveMarch(
                self._attempt, self.backend, self.fixed, crossed, self.contacts is not None
            )

    def _attempt(self, mode: int) -> Attempt:
        if (attempt := self.variants[mode].attempt) is None:
            raise UnsupportedError(f"{self.integrator.name} has no error control")
        return attempt

    # variants -----------------------------------------------------------------------
    def choose(
        self,
        t: float,
        x: np.ndarray,
        p: np.ndarray,
        rows: tuple[int, ...] | None = None,
        phases: Phases | None = None,
        method: Integrator | None = None,
    ) -> int:
        """The mode for a state, with given rows of the equations or, by default, independent ones.

        By default rigid gaps are open, and the integrator is the initial one of runs.
        """
        y = x[: self.equations.coordinate_count]
        rows = self._rows(t, y, p) if rows is None else rows
        if phases is None:
            phases = (Phase.APART,) * len(self.equations.contacts)
        e = self.view.with_rows(rows)
        bare = chosen = self.formulation.choose(e, t, y, p)
        if any(phase is not Phase.APART for phase in phases):
            chosen = self.formulation.choose(touching(e, phases), t, y, p)
        return self._mode(rows, chosen, phases, method or self.methods[0], bare)

    def _mode(
        self,
        rows: tuple[int, ...],
        chosen: Formulation,
        phases: Phases,
        method: Integrator,
        bare: Formulation,
    ) -> int:
        key = (rows, chosen, phases, method)
        for mode, v in enumerate(self.variants):
            if (v.rows, v.formulation, v.phases, v.integrator) == key:
                return mode
        strategies = chosen, self.stabilization, method
        self.variants.append(Variant(self.view, rows, *strategies, phases, bare))
        return len(self.variants) - 1

    @property
    def latest(self) -> int:
        """The mode of a run without steps: the latest one that is not a transition."""
        return max(k for k, variant in enumerate(self.variants) if type(variant) is Variant)

    def implicit(self, mode: int) -> bool:
        """Whether the integrator of a mode is implicit."""
        return self.variants[mode].integrator.implicit

    def cost(self, mode: int) -> float:
        """Approximate number of operations of an attempted step of a mode."""
        return self._attempt(mode).cost

    def by_other_method(self, mode: int) -> int:
        """The mode of the same equations with the other of two methods, if it is applicable."""
        v = self.variants[mode]
        (other,) = (method for method in self.methods if method != v.integrator)
        following = self._mode(v.rows, v.formulation, v.phases, other, v.bare)
        try:
            other.check(self.variants[following].problem)
        except UnsupportedError:
            return mode
        return following

    def _rows(self, t: float, y: np.ndarray, p: np.ndarray) -> tuple[int, ...]:
        """The rows of the start if the others follow accurately from them, else the best rows."""
        rows, whole = self.view.rows, self.view.whole
        accurate = len(rows) == whole.constraint_count or rows_determine(whole, rows, t, y, p)
        return rows if accurate else best_rows(whole, rows, t, y, p)

    @cached_property
    def distances(self) -> ca.Function:
        """``(t, x, p)`` → distance to each switch, negative beyond it."""
        return distances(self.equations)

    @cached_property
    def crossed(self) -> ca.Function:
        """``(t, x, p)`` → distance of a state beyond each switch, less rounding."""
        return crossed(self.equations)

    def transition(self, mode: int, number: int, moving: bool) -> int:
        """The mode of the transition of a switch between steps of a mode."""
        key = (mode, number, moving)
        if key not in self._transitions:
            self.variants.append(Transition(self.variants[mode], number, moving))
            self._transitions[key] = len(self.variants) - 1
        return self._transitions[key]

    def side(self, mode: int, after: bool) -> int:
        """The mode of outputs just before or just after a change, at its own instant."""
        if (mode, after) not in self._sides:
            change = self.variants[mode]
            assert isinstance(change, Transition | ContactChange)
            self.variants.append(MovingSide(change, after))
            self._sides[mode, after] = len(self.variants) - 1
        return self._sides[mode, after]

    def crossings(self, steps: Steps) -> list[tuple[int, Transition | ContactChange]]:
        """Steps that are transitions at which forces or contacts change."""
        changes = [(int(k), self.variants[steps.mode[k]]) for k in np.flatnonzero(steps.h == 0)]
        kinds = Transition, ContactChange
        return [(k, v) for k, v in changes if isinstance(v, kinds) and v.moving]

    def jumps(self, steps: Steps) -> np.ndarray:
        """Steps in which speeds jump."""
        changes = [(k, v) for k, v in self.crossings(steps) if isinstance(v, ContactChange)]
        return np.array([k for k, change in changes if change.struck], dtype=int)

    def switch(self, times: np.ndarray, states: np.ndarray, mode: int, p: np.ndarray) -> Switch:
        """Number of steps to accept, and the mode after them."""
        accept_all, variant = Switch(times.size - 1, mode), self.variants[mode]
        if variant.conditioning is None:
            return accept_all
        y = states[: self.equations.coordinate_count]
        conditioning = self.over(variant.conditioning, times.size)
        shares, values = conditioning(times, y, np.tile(p[:, None], times.size))
        bad = np.flatnonzero(~((shares.ravel() <= 1) & (values.ravel() <= 1)))
        if not bad.size:
            return accept_all
        last_good, rows = max(int(bad[0]) - 1, 0), variant.rows
        for accepted in (last_good, int(bad[0])):
            t, x = float(times[accepted]), states[:, accepted]
            try:
                if not shares.ravel()[bad[0]] <= 1:
                    rows = best_rows(self.view.whole, rows, t, y[:, accepted], p)
                following = self.choose(t, x, p, rows, variant.phases, variant.integrator)
            except SingularityError as error:
                return Switch(last_good, mode, str(error))
            if following != mode:
                return Switch(accepted, following)
        return accept_all

    @cached_property
    def beginning(self) -> tuple[Variant, np.ndarray]:
        """The variant and the state at the start of the model."""
        start, p = self.model.start, self.model.nominal
        x = self.start.function(0.0, start.y, start.v, p).full().ravel()
        return self.variants[self.choose(0.0, x, p)], x

    @cached_property
    def operations(self) -> int:
        """Operations of a step at the start of the model: accelerations and correction.

        Raises
        ------
        UnsupportedError
            The formulation gives no accelerations.
        """
        if not self.formulation.gives_accelerations:
            kind = type(self.formulation).__name__
            raise UnsupportedError(f"{kind} gives no accelerations whose operations could count")
        variant, _ = self.beginning
        correction = variant.problem.correction
        corrected = 0 if correction is None else correction.function.n_instructions()
        return int(STAGES * variant.rate.function.n_instructions() + corrected)

    def over(self, function: ca.Function, count: int) -> Callable[..., list[np.ndarray]]:
        """The function for ``count`` columns at once."""
        return partial(self.backend.columns(function), count)

    def marched(self, function: ca.Function, fixed: tuple[int, ...]) -> Columns:
        """A function whose result is the first argument of the next column.

        ``fixed`` are the numbers of the arguments that all columns share.
        """
        return self.backend.columns(function, True, fixed)

    def steps(self, mode: int) -> Columns:
        """The steps, or attempted steps, of a mode."""
        return (self.adaptive or self.fixed).columns(mode)

    # states -------------------------------------------------------------------------
    @cached_property
    def start(self) -> ImplicitFunction:
        """``(t, y, v, p)`` of the bodies → state ``x = [q; u; work; sides]`` without memory."""
        reduce, e = self.view.reduce, self.equations
        t, _, _, p = reduce.inputs
        q, u = reduce.outputs
        energy = self.stabilization.reference_energy(e)
        sides = e.switches.actual
        energy = ca.substitute(energy, e.switches.sides, sides)
        initial = [ca.vertcat(ca.SX(0), ca.densify(energy), first_headings(e), sides)]
        old, new = ca.vertcat(e.t, e.y, e.v, e.p), ca.vertcat(t, q, u, p)
        (memory,) = ca.substitute(initial, [old], [new])
        return ImplicitFunction("start", reduce.inputs, [], [ca.vertcat(q, u, memory)])

    def initial(
        self, state: AssembledState, t: float, p: np.ndarray, like: np.ndarray | None = None
    ) -> tuple[np.ndarray, int]:
        """Initial state with memory, and its mode; signs of switching functions as in ``like``."""
        x = self.start.function(t, state.y, state.v, p).full().ravel()
        if like is not None:
            sides = slice(x.size - self.equations.switches.count, x.size)
            x[sides] = like[sides]
        mode = self.choose(t, x, p)
        return self.remembered(t, x, p, mode), mode

    def remembered(self, t: float, x: np.ndarray, p: np.ndarray, mode: int) -> np.ndarray:
        """A state with the initial memory of the steps of a mode."""
        step = self.variants[mode].step
        if step.begin is None:
            return x
        x = x[: step.state_size]
        return np.concatenate([x, step.begin.function(t, x, p).full().ravel()])
