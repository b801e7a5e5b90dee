"""Active-set search for rigid contacts in the steps of a run.

Steps are taken with the phases frozen. Where a guard of the phases becomes negative, the instant is
located, the step is cut there, and a new active set is selected: closing gaps bounce, all touching
gaps at once by one law; resting gaps press, stick or slide according to the accelerations.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.contact.active_set import ActiveSetSelector
from dalembert.analysis.contact.guards import (
    HALVINGS,
    Guard,
    Guards,
    chattering,
    first_zero,
    zero_guard,
)
from dalembert.analysis.contact.modes import ContactModes
from dalembert.analysis.contact.pattern import ActiveSet
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import cubic, minimum_of_cubic
from dalembert.analysis.dynamics.transition import SIMULTANEOUS, StepReplacement
from dalembert.analysis.events import locate
from dalembert.errors import SingularityError, UnsolvedPart, UnsupportedError
from dalembert.formulations.base import state_symbols
from dalembert.integrators.marching.steps import Crossing
from dalembert.model.graph.contacts import BranchedPhases, Phase, Phases, branches_of
from dalembert.results.recording import ImpactRecord
from dalembert.symbolic.evaluation.kernel import Kernel

PARTS = np.arange(1, 8)[:, None, None] / 8
"""Fractions of a step at which guards are checked for temporary negative values."""
UNEVEN = 0.02
"""Threshold for evaluations inside a step: deviation of a guard from its cubic in the middle,
relative to values and changes at the ends."""
MANY = 25
"""Threshold for chattering: number of changes at one time."""


class ContactSearch:
    """Search for changes of contact phases in one run.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    modes : ContactModes of the kernel
    p : (np,) parameters
    start, end : of the run [s]

    Attributes
    ----------
    impacts : ImpactRecord of every jump
    closed : (time, element) of contacts that closed after bounces
    together : (time, elements) of gaps that closed at one time
    slides : (time, element) of sliding over a surface that began from rest
    trouble : message if the motion cannot continue, else empty
    """

    def __init__(
        self, kernel: DynamicsKernel, modes: ContactModes, p: np.ndarray, start: float, end: float
    ):
        self.kernel, self.p, self.start, self.span = kernel, p, start, end - start
        self.modes, self.selector = modes, ActiveSetSelector(kernel, modes, p, end - start)
        self.impacts: list[ImpactRecord] = []
        self.closed: list[tuple[float, str]] = []
        self.together: list[tuple[float, str]] = []
        self.slides: list[tuple[float, str]] = []
        self.trouble, self.inconsistent = "", False
        self._changes: list[tuple[float, Guard]] = []
        self._kernels: dict[object, Kernel] = {}
        self.size = state_symbols(kernel.equations).numel()

    def begin(self, x0: np.ndarray, mode: int) -> int:
        """The mode at the start, with gaps that touch and rest there closed."""
        active_set = self.selector.at_start(self.start, x0[: self.size], mode)
        self._note(active_set, self.start)
        return self._phased(mode, initial_phases(active_set), self.start, x0)

    def statistics(self, end: float) -> dict[str, Any]:
        """Statistics of contacts up to a time."""
        entries: dict[str, Any] = {"impacts": sum(i.time <= end for i in self.impacts)}
        if together := [f"{names} at t = {t:.9g} s" for t, names in self.together if t <= end]:
            entries["simultaneous impacts"] = ", ".join(together)
        if closed := [f"{name} at t = {t:.9g} s" for t, name in self.closed if t <= end]:
            entries["accumulation of impacts"] = ", ".join(closed)
        return entries

    @property
    def warnings(self) -> list[str]:
        """Warning about sliding over surfaces that begins from rest, where directions are stiff."""
        if self.kernel.adaptive is not None or not self.slides:
            return []
        time, name = self.slides[0]
        return [
            f"{name} begins to slide over a surface at t = {time:.6g} s: while the slip is small "
            "its direction follows the forces so fast that steps of given length miss it; use "
            "integrator=DormandPrince()"
        ]

    # search ------------------------------------------------------------------------------
    def cross(self, times: np.ndarray, states: np.ndarray, mode: int) -> Crossing | None:
        """Replacement of the first step in which a guard becomes negative, if there is one."""
        if times.size < 2:
            return None
        first = self._first(times, states, mode)
        if first is None:
            return None
        k, length, number = first
        replacement = StepReplacement(float(times[k]), states[:, k])
        if length > 0:
            replacement.add(length, self._state(mode, times[k], length, states[:, k]), mode)
        moving = replacement.time > self.start
        after = self._change(replacement, mode, number, moving)
        if not replacement.entries:  # no motion leaves the start
            replacement.add(0.0, replacement.x, mode)
        crossing = replacement.crossing(k, float(times[k + 1] - times[k]), self.trouble)
        return crossing._replace(after=after)

    def _first(self, times, states, mode: int) -> tuple[int, float, int] | None:
        """Step, length from its beginning, and number of the guard that becomes negative first."""
        guards = self._guards(mode)
        count = 1 << (times.size - 1).bit_length()  # few sizes, for few functions
        whole = np.minimum(np.arange(count), times.size - 1)
        guard_function = self.kernel.over(guards.function, count)
        values_and_rates = guard_function(
            times[whole], states[: self.size, whole], np.tile(self.p[:, None], count)
        )
        values, rates = (column[:, : times.size] for column in values_and_rates)
        near, h = guards.near[:, None], np.diff(times)
        beyond = ~(values[:, 1:] >= -near)
        ends_of = values[:, :-1], values[:, 1:], h * rates[:, :-1], h * rates[:, 1:]
        parts = np.concatenate(
            [np.broadcast_to(PARTS, (7, *beyond.shape)), [minimum_of_cubic(*ends_of)]]
        )
        leading_negative = values[:, :-1] + h * rates[:, :-1] < -near
        beyond |= leading_negative & guards.stiff[:, None]
        beyond &= ~guards.idle[:, None]
        dips = cubic(parts, *ends_of) < -near
        dips[:-1] |= self._dips_between(times, states, mode, ends_of)
        for k in np.flatnonzero(beyond.any(axis=0) | dips.any(axis=(0, 1))):
            ends: dict[int, float] = {int(i): float(h[k]) for i in np.flatnonzero(beyond[:, k])}
            low = {
                int(i): float(h[k] * parts[dips[:, i, k], i, k].min())
                for i in np.flatnonzero(dips[:, :, k].any(axis=0))
            }
            try:
                roots = self._roots(mode, float(times[k]), states[:, k], ends, low)
            except FloatingPointError:
                raise UnsolvedPart(int(k), float(times[k])) from None
            if roots:
                number = min(roots, key=lambda i: roots[i])
                return int(k), roots[number], number
        return None

    def _dips_between(
        self, times: np.ndarray, states: np.ndarray, mode: int, ends_of: tuple[np.ndarray, ...]
    ) -> np.ndarray:
        """(parts, guards, steps) negative guards inside steps in which cubics are inaccurate.

        A surface may move faster than the body, whose motion determines the steps.
        """
        guards, count = self._guards(mode), times.size - 1

        def inside(parts: np.ndarray) -> np.ndarray:
            instants, x = self.kernel.between(times, states[: self.size], mode, self.p, parts)
            guard_function = self.kernel.over(guards.function, instants.size)
            values = guard_function(instants, x, np.tile(self.p[:, None], instants.size))[0]
            return values.reshape(values.shape[0], -1, parts.size)[:, :count]

        middle, cubics = inside(np.array([0.5]))[..., 0], cubic(0.5, *ends_of)
        sizes = sum(np.abs(terms) for terms in ends_of)
        if not np.any(np.abs(middle - cubics) > UNEVEN * sizes + guards.near[:, None]):
            return np.zeros((PARTS.size, *middle.shape), dtype=bool)
        values = inside(PARTS.ravel())
        return np.moveaxis(values < -guards.near[:, None, None], 2, 0)

    def _roots(
        self, mode: int, t: float, x: np.ndarray, ends: dict[int, float], low: dict[int, float]
    ) -> dict[int, float]:
        """Zeros in a step of guards that are negative at its end or possibly inside."""
        near = self._guards(mode).near
        for i, part in low.items():
            if not self._value(mode, i, t, part, x) >= -near[i]:
                ends[i] = part
        roots = {i: self._locate(mode, i, t, x, end) for i, end in ends.items()}
        return {i: root for i, root in roots.items() if root is not None}

    def _locate(
        self, mode: int, number: int, t: float, x: np.ndarray, longest: float
    ) -> float | None:
        """Time from the beginning of a step to the zero of a guard, None without one [s]."""

        def value(length: float) -> float:
            return self._value(mode, number, t, length, x)

        inside, guards = 0.0, self._guards(mode)
        if value(0.0) <= guards.near[number]:  # the step begins at a zero: search for a later one
            candidates = (longest * 2.0**-k for k in range(1, HALVINGS))
            inside = next((length for length in candidates if value(length) > 0), 0.0)
            if not inside:
                return 0.0
        if guards.stiff[number]:
            return first_zero(value, inside, longest)
        return locate(value, inside, longest)

    def _value(self, mode: int, number: int, t: float, length: float, x: np.ndarray) -> float:
        state = self._state(mode, t, length, x) if length else x
        function = self._guards(mode).function
        value = self._call(function, t + length, state[: self.size], self.p)[0].ravel()[number]
        if not np.isfinite(value):
            raise FloatingPointError
        return float(value)

    def _state(self, mode: int, t: float, h: float, x: np.ndarray) -> np.ndarray:
        return self._call(self.kernel.variants[mode].step.function, t, h, x, self.p)[0].ravel()

    def _guards(self, mode: int) -> Guards:
        guards = self.kernel.variants[mode].guards
        assert guards is not None
        return guards

    def _call(self, function, *arguments) -> list[np.ndarray]:
        if function not in self._kernels:
            self._kernels[function] = Kernel(function)
        return self._kernels[function](*arguments)

    # changes ---------------------------------------------------------------------------
    def _change(self, replacement: StepReplacement, mode: int, number: int, moving: bool) -> int:
        """Add a change of phases at the current instant; return the mode after it."""
        guards, state = self._guards(mode), replacement.x[: self.size]
        outputs = self._call(guards.function, replacement.time, state, self.p)
        values, rates = (output.ravel() for output in outputs)
        number, guard, located = zero_guard(guards, number, values, rates, self.span)
        moving = moving and located
        active_set = self.selector.at_guard(replacement.time, state, mode, guard)
        self._note(active_set, replacement.time)
        self._changes.append((replacement.time, guard))
        if self.trouble:
            return mode
        since = replacement.time - SIMULTANEOUS * self.span
        if len(recent := [g for t, g in self._changes if t >= since]) > MANY:
            name = self.kernel.equations.contacts[guard.gap].name
            self.trouble = chattering(recent, name, replacement.time)
            return mode
        after_mode = self._phased(mode, active_set.phases, replacement.time, replacement.x)
        if self.trouble:
            return mode
        change = self.modes.change(mode, after_mode, active_set, number if moving else None)
        after = self._state(change, replacement.time, 0.0, replacement.x)
        replacement.add(0.0, after, change)
        if active_set.impulse is not None:
            self._record(replacement.time, active_set, active_set.impulse)
        return after_mode

    def _phased(self, mode: int, phases: Phases, t: float, x: np.ndarray) -> int:
        """The mode with the given phases; the same mode, and a message, if there is none."""
        try:
            return self.modes.phased(mode, phases, t, x[: self.size], self.p)
        except (SingularityError, UnsupportedError) as error:  # closed gaps are constraints as well
            pairs = zip(self.kernel.equations.contacts, phases, strict=True)
            closed = ", ".join(gap.name for gap, phase in pairs if phase is not Phase.APART)
            self.trouble = f"with {closed} closed at t = {t:.9g} s: {error}; use formulation=KKT()"
            return mode

    def _record(self, time: float, active_set: ActiveSet, impulse: np.ndarray) -> None:
        gaps, slips = self.kernel.equations.contacts, self.selector.slips
        for k in active_set.gaps:
            if impulse[k] > 0:
                tangential = impulse[slips[k]]
                self.impacts.append(ImpactRecord(gaps[k].name, time, float(impulse[k]), tangential))
        if active_set.together:
            self.together.append((time, " and ".join(gaps[k].name for k in active_set.together)))
        self.closed += [(time, gaps[k].name) for k in sorted(active_set.dead)]

    def _note(self, active_set: ActiveSet, time: float) -> None:
        if active_set.rest is not None:
            pairs = zip(active_set.resting, active_set.rest.sectors, strict=True)
            names = (self.kernel.equations.contacts[k].name for k, n in pairs if n is not None)
            self.slides += [(time, name) for name in names]
        if active_set.trouble:
            self.trouble, self.inconsistent = active_set.trouble, True


def initial_phases(active_set: ActiveSet) -> Phases:
    """Phases at the start.

    A gap that begins to slide over a surface sticks until the first step determines its direction.
    """
    phases = list(active_set.phases)
    if active_set.rest is not None:
        for k, sector in zip(active_set.resting, active_set.rest.sectors, strict=True):
            phases[k] = phases[k] if sector is None else Phase.STICKING
    return BranchedPhases(phases, branches_of(active_set.phases))
