"""Compiled functions of a dynamic run, and where its outputs lie among its steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, SingularityError, UnsupportedError
from dalembert.formulations.base import Formulation, state_rate
from dalembert.formulations.consistency import with_consistent_speeds
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.adaptive import AdaptiveMarch
from dalembert.integrators.base import Attempt, Integrator, Problem
from dalembert.integrators.march import FixedMarch
from dalembert.integrators.step import Step
from dalembert.integrators.steps import Steps, Switch
from dalembert.model.assembly import AssembledState
from dalembert.model.coordinates import Coordinates
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.implicit import ImplicitFunction
from dalembert.symbolic.kernel import Kernel


@dataclass(frozen=True)
class Branches:
    """Where the outputs lie: ``length`` seconds after the beginning of step ``index``."""

    index: np.ndarray
    length: np.ndarray

    def ends_of(self, steps: Steps) -> np.ndarray:
        """Whether an output is the end of its step."""
        if not steps.count:
            return np.zeros(self.index.size, dtype=bool)
        return (self.length > 0) & np.isclose(self.length, steps.h[self.index], rtol=1e-12, atol=0)


@dataclass(frozen=True)
class DynamicsRecord:
    """What a gradient needs of a run: the steps taken and the branches to the outputs."""

    kernel: DynamicsKernel
    steps: Steps
    branches: Branches


class Variant:
    """Functions of one definite formulation, e.g. with one partition of the speeds."""

    def __init__(self, kernel: DynamicsKernel, formulation: Formulation):
        self.kernel, self.formulation = kernel, formulation

    @cached_property
    def problem(self) -> Problem:
        """The equations as integrators take them."""
        kernel, formulation = self.kernel, self.formulation
        e, stabilization = kernel.equations, kernel.stabilization
        explicit = not kernel.integrator.implicit and formulation.gives_accelerations
        correction = stabilization.correction(e, formulation)
        return Problem(
            rate=formulation.acceleration(e, kernel.xi, [state_rate(e)], "state_rate")
            if explicit
            else None,
            make_system=lambda: formulation.semi_explicit(e, kernel.xi),
            correction=None
            if correction is None
            else with_consistent_speeds(e, formulation, correction),
            controlled=e.coordinate_count + e.speed_count,
            positions=e.coordinate_count,
            tangential=stabilization.tangential(e, formulation)
            if kernel.integrator.adaptive
            else None,
            upkeep=with_consistent_speeds(e, formulation, None),
        )

    @cached_property
    def step(self) -> Step:
        return self.kernel.integrator.step(self.problem)

    @cached_property
    def attempt(self) -> Attempt | None:
        return self.kernel.integrator.attempt(self.problem, self.step)

    def measured(self, outputs: list[ca.SX], name: str = "measured") -> ImplicitFunction:
        """``(t, x, p) → outputs``, expressions of the bodies' states and multipliers."""
        kernel = self.kernel
        seen = [kernel.view.lift(expression) for expression in outputs]
        return self.formulation.acceleration(kernel.equations, kernel.xi, seen, name)

    @cached_property
    def bodies(self) -> ca.Function:
        """``(t, x, p) → y, v, v̇, λ`` of all bodies and equations."""
        e = self.kernel.model.all_equations
        return self.measured([e.y, e.v, e.a, e.multiplier], "bodies").function

    @cached_property
    def conditioning(self) -> tuple[ca.Function, float] | None:
        """``(t, y, p) → value`` and the limit above which another variant is chosen."""
        e = self.kernel.equations
        found = self.formulation.conditioning(e)
        if found is None:
            return None
        return ca.Function("conditioning", [e.t, e.y, e.p], [found[0]]), found[1]


class DynamicsKernel:
    """Compiled functions of one model under one choice of strategies."""

    def __init__(
        self,
        model: Model,
        coordinates: Coordinates,
        formulation: Formulation,
        stabilization: Stabilization,
        integrator: Integrator,
    ):
        self.model, self.formulation, self.stabilization = model, formulation, stabilization
        self.coordinates, self.integrator = coordinates, integrator
        self.view = coordinates.view(model, formulation.every_equation)
        self.equations = self.view.equations
        self.xi = stabilization.constraint_acceleration(self.equations)
        self.variants: list[Variant] = []
        self._mapped: dict[tuple[ca.Function, int], Kernel] = {}
        self.fixed = FixedMarch(lambda mode: self.variants[mode].step, stabilization.period)
        self.adaptive = AdaptiveMarch(self._attempt) if integrator.adaptive else None

    def _attempt(self, mode: int) -> Attempt:
        found = self.variants[mode].attempt
        if found is None:
            raise UnsupportedError(f"{self.integrator.name} has no error control")
        return found

    # variants -----------------------------------------------------------------------
    def choose(self, t: float, x: np.ndarray, p: np.ndarray) -> int:
        """The variant for a state."""
        y = x[: self.equations.coordinate_count]
        chosen = self.formulation.choose(self.equations, t, y, p)
        for mode, variant in enumerate(self.variants):
            if variant.formulation == chosen:
                return mode
        self.variants.append(Variant(self, chosen))
        return len(self.variants) - 1

    def switch(self, times: np.ndarray, states: np.ndarray, mode: int, p: np.ndarray) -> Switch:
        """How many of these steps to keep, and the variant after them."""
        everything, watched = Switch(times.size - 1, mode), self.variants[mode].conditioning
        if watched is None:
            return everything
        function, limit = watched
        y = states[: self.equations.coordinate_count]
        (values,) = self.over(function, times.size)(times, y, np.tile(p[:, None], times.size))
        bad = np.flatnonzero(~(values.ravel() <= limit))
        if not bad.size:
            return everything
        last_good = max(int(bad[0]) - 1, 0)
        for kept in (last_good, int(bad[0])):
            try:
                following = self.choose(float(times[kept]), states[:, kept], p)
            except SingularityError as error:
                return Switch(last_good, mode, str(error))
            if following != mode:
                return Switch(kept, following)
        return everything

    def over(self, function: ca.Function, count: int) -> Kernel:
        """The function for ``count`` columns at once; made once, for chunks ask again and again."""
        key = (function, count)
        if key not in self._mapped:
            self._mapped[key] = Kernel(function.map(count))
        return self._mapped[key]

    # states -------------------------------------------------------------------------
    @cached_property
    def start(self) -> ImplicitFunction:
        """``(t, y, v, p)`` of the bodies → state ``x = [q; u; work]`` without memory."""
        reduce, e = self.view.reduce, self.equations
        t, _, _, p = reduce.inputs
        q, u = reduce.outputs
        energy = self.stabilization.reference_energy(e)
        stored = ca.substitute(energy, ca.vertcat(e.t, e.y, e.v, e.p), ca.vertcat(t, q, u, p))
        return ImplicitFunction(
            "start", reduce.inputs, [], [ca.vertcat(q, u, ca.SX(0), ca.densify(stored))]
        )

    def initial(self, state: AssembledState, t: float, p: np.ndarray) -> tuple[np.ndarray, int]:
        """State with memory at the start, and its variant."""
        x = self.start.function(t, state.y, state.v, p).full().ravel()
        mode = self.choose(t, x, p)
        begin = self.variants[mode].step.begin
        if begin is not None:
            x = np.concatenate([x, begin(t, x, p).full().ravel()])
        return x, mode

    def branch_states(self, steps: Steps, branches: Branches, p: np.ndarray) -> np.ndarray:
        """States at the outputs: ends of steps as they are, others by a partial step."""
        k = branches.index
        states = steps.x[:, k].copy()
        ends = branches.ends_of(steps)
        states[:, ends] = steps.x[:, k[ends] + 1]
        inside = np.flatnonzero((branches.length > 0) & ~ends)
        for mode in np.unique(steps.mode[k[inside]]):
            part = inside[steps.mode[k[inside]] == mode]
            (states[:, part],) = Kernel(self.variants[mode].step.function.map(part.size))(
                steps.t[k[part]],
                branches.length[part],
                steps.x[:, k[part]],
                np.tile(p[:, None], part.size),
            )
        return states

    def modes(self, steps: Steps, branches: Branches) -> np.ndarray:
        """Variant of each output."""
        if not steps.count:
            return np.full(branches.index.size, len(self.variants) - 1)
        following = np.minimum(branches.index + 1, steps.count - 1)
        return steps.mode[np.where(branches.ends_of(steps), following, branches.index)]

    def mapped(
        self,
        function_of: Callable[[Variant], ca.Function],
        modes: np.ndarray,
        times: np.ndarray,
        states: np.ndarray,
        p: np.ndarray,
        *more: np.ndarray,
    ) -> list[np.ndarray]:
        """``(t, x, p, …)`` functions of the variants over outputs, each by its own variant."""
        results: list[np.ndarray] = []
        size = self.variants[0].step.state_size
        for mode in np.unique(modes):
            part = np.flatnonzero(modes == mode)
            function = function_of(self.variants[mode])
            found = self.over(function, part.size)(
                times[part],
                states[:size, part],
                np.tile(p[:, None], part.size),
                *(column[:, part] for column in more),
            )
            results = results or [np.zeros((r.shape[0], modes.size)) for r in found]
            for whole, piece in zip(results, found, strict=True):
                whole[:, part] = piece
        return results

    def trajectory(
        self, times: np.ndarray, steps: Steps, branches: Branches, p: np.ndarray
    ) -> Trajectory:
        """Poses, speeds, accelerations and multipliers of all bodies at the outputs."""
        states = self.branch_states(steps, branches, p)
        modes = self.modes(steps, branches)
        y, v, a, multiplier = self.mapped(lambda s: s.bodies, modes, times, states, p)
        n = self.equations.coordinate_count + self.equations.speed_count
        work = states[n : n + 2] - steps.x[n : n + 2, :1]
        return Trajectory(times, y, v, a, multiplier, work)


def place_outputs(steps: Steps, times: np.ndarray) -> Branches:
    """Where times lie among the steps taken."""
    count = steps.count
    slack = 1e-12 * max(1.0, abs(steps.end))
    if times[0] < steps.t[0] - slack or times[-1] > steps.end + slack:
        raise AnalysisError(
            f"times {times[0]:g}…{times[-1]:g} s leave the run {steps.t[0]:g}…{steps.end:g} s"
        )
    index = np.clip(np.searchsorted(steps.t[:count], times, side="right") - 1, 0, count - 1)
    length = np.clip(times - steps.t[index], 0.0, steps.h[index])
    small = 1e-12 * np.maximum(1.0, np.abs(times))
    length[length < small] = 0.0
    near = np.abs(length - steps.h[index]) < small
    length[near] = steps.h[index[near]]
    return Branches(index, length)
