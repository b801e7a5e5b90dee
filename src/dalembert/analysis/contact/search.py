"""Where gaps change their phases in a run, and the steps that are put in place there.

Steps are taken as if nothing changed. Where a guard of the phases becomes negative, the instant is
located, the step cut there, and the state asked what it does: gaps that close bounce, all that
touch at once by one law; those that rest press, stick or slide as the accelerations ask.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.contact.choice import ContactChoice
from dalembert.analysis.contact.guards import Guard, Guards
from dalembert.analysis.contact.modes import ContactModes
from dalembert.analysis.contact.ruling import Ruling
from dalembert.analysis.contact.zeros import HALVINGS, cubic, first_zero, lowest
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.passage import NOW, Passage
from dalembert.analysis.events import locate
from dalembert.errors import SingularityError, UnsolvedPart, UnsupportedError
from dalembert.formulations.base import state_symbols
from dalembert.integrators.marching.steps import Crossing
from dalembert.model.contacts import Phase, Phases
from dalembert.results.recording import ImpactRecord
from dalembert.symbolic.evaluation.kernel import Kernel

PARTS = np.arange(1, 8)[:, None, None] / 8
"""Of a step, where it is looked for a guard that becomes negative and positive again."""
UNEVEN = 0.02
"""Distance of a guard from its cubic in the middle of a step, by its values and their changes at
the ends, from which on it is evaluated inside."""
MANY = 25
"""Changes at one time that are recognised as chattering."""


class ContactSearch:
    """Looks for changes of phases in one run.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    modes : its ContactModes
    p : (np,) parameters
    start, end : of the run [s]

    Attributes
    ----------
    impacts : ImpactRecord of every jump
    closed : (time, element) of contacts that closed after bounces
    together : (time, elements) of gaps that closed at one time
    begun : (time, element) of slides over a surface that began at rest
    trouble : why no motion goes on, or nothing
    """

    def __init__(
        self, kernel: DynamicsKernel, modes: ContactModes, p: np.ndarray, start: float, end: float
    ):
        self.kernel, self.p, self.start, self.span = kernel, p, start, end - start
        self.modes, self.choice = modes, ContactChoice(kernel, modes, p, end - start)
        self.impacts: list[ImpactRecord] = []
        self.closed: list[tuple[float, str]] = []
        self.together: list[tuple[float, str]] = []
        self.begun: list[tuple[float, str]] = []
        self.trouble, self.inconsistent = "", False
        self._changes: list[float] = []
        self._kernels: dict[object, Kernel] = {}
        self.size = state_symbols(kernel.equations).numel()

    def begin(self, x0: np.ndarray, mode: int) -> int:
        """The mode at the start, with gaps that touch and rest there closed."""
        ruling = self.choice.at_start(self.start, x0[: self.size], mode)
        self._told(ruling, self.start)
        return self._phased(mode, begun(ruling), self.start, x0)

    def statistics(self, end: float) -> dict[str, Any]:
        """What happened up to a time, for people."""
        found: dict[str, Any] = {"impacts": sum(i.time <= end for i in self.impacts)}
        if together := [f"{names} at t = {t:.9g} s" for t, names in self.together if t <= end]:
            found["closed at one time"] = ", ".join(together)
        if closed := [f"{name} at t = {t:.9g} s" for t, name in self.closed if t <= end]:
            found["closed after ever shorter bounces"] = ", ".join(closed)
        return found

    @property
    def doubts(self) -> list[str]:
        """Slides over surfaces that begin at rest, where directions are stiff at first."""
        if self.kernel.adaptive is not None or not self.begun:
            return []
        time, name = self.begun[0]
        return [
            f"{name} begins to slide over a surface at t = {time:.6g} s: while the slip is small "
            "its direction follows the forces so fast that steps of given length miss it; use "
            "integrator=DormandPrince()"
        ]

    # looking ------------------------------------------------------------------------------
    def cross(self, times: np.ndarray, states: np.ndarray, mode: int) -> Crossing | None:
        """What is put in place of the first step in which a guard becomes negative."""
        if times.size < 2:
            return None
        found = self._first(times, states, mode)
        if found is None:
            return None
        k, length, number = found
        passage = Passage(float(times[k]), states[:, k])
        if length > 0:
            passage.add(length, self._state(mode, times[k], length, states[:, k]), mode)
        moving = passage.time > self.start
        after = self._change(passage, mode, number, moving)
        if not passage.entries:  # no motion goes on from the start
            passage.add(0.0, passage.x, mode)
        made = passage.crossing(k, float(times[k + 1] - times[k]), self.trouble)
        return made._replace(after=after)

    def _first(self, times, states, mode: int) -> tuple[int, float, int] | None:
        """Step, length from its beginning and number of the guard that becomes negative first."""
        guards = self._guards(mode)
        count = 1 << (times.size - 1).bit_length()  # few sizes, for few functions
        whole = np.minimum(np.arange(count), times.size - 1)
        looked = self.kernel.over(guards.function, count)
        found = looked(times[whole], states[: self.size, whole], np.tile(self.p[:, None], count))
        values, rates = (column[:, : times.size] for column in found)
        near, h = guards.near[:, None], np.diff(times)
        beyond = ~(values[:, 1:] >= -near)
        ends_of = values[:, :-1], values[:, 1:], h * rates[:, :-1], h * rates[:, 1:]
        parts = np.concatenate([np.broadcast_to(PARTS, (7, *beyond.shape)), [lowest(*ends_of)]])
        led = values[:, :-1] + h * rates[:, :-1] < -near
        beyond |= led & guards.stiff[:, None]
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
        """(parts, guards, steps) where guards are negative inside steps that no cubic follows.

        A surface may move faster than the body, whose motion alone determines the steps.
        """
        guards, count = self._guards(mode), times.size - 1

        def inside(parts: np.ndarray) -> np.ndarray:
            at, x = self.kernel.between(times, states[: self.size], mode, self.p, parts)
            looked = self.kernel.over(guards.function, at.size)
            values = looked(at, x, np.tile(self.p[:, None], at.size))[0]
            return values.reshape(values.shape[0], -1, parts.size)[:, :count]

        middle, cubics = inside(np.array([0.5]))[..., 0], cubic(0.5, *ends_of)
        sizes = sum(np.abs(each) for each in ends_of)
        if not np.any(np.abs(middle - cubics) > UNEVEN * sizes + guards.near[:, None]):
            return np.zeros((PARTS.size, *middle.shape), dtype=bool)
        values = inside(PARTS.ravel())
        return np.moveaxis(values < -guards.near[:, None, None], 2, 0)

    def _roots(
        self, mode: int, t: float, x: np.ndarray, ends: dict[int, float], low: dict[int, float]
    ) -> dict[int, float]:
        """Zeros of guards in a step, that are negative at its end or perhaps inside."""
        near = self._guards(mode).near
        for i, part in low.items():
            if not self._value(mode, i, t, part, x) >= -near[i]:
                ends[i] = part
        found = {i: self._locate(mode, i, t, x, end) for i, end in ends.items()}
        return {i: root for i, root in found.items() if root is not None}

    def _locate(
        self, mode: int, number: int, t: float, x: np.ndarray, longest: float
    ) -> float | None:
        """Time from the beginning of a step to the zero of a guard, if it has one."""

        def value(length: float) -> float:
            return self._value(mode, number, t, length, x)

        inside, guards = 0.0, self._guards(mode)
        if value(0.0) <= guards.near[number]:  # it begins at a zero: only a later one counts
            tried = (longest * 2.0**-k for k in range(1, HALVINGS))
            inside = next((length for length in tried if value(length) > 0), 0.0)
            if not inside:
                return 0.0
        if guards.stiff[number]:
            return first_zero(value, inside, longest)
        return locate(value, inside, longest)

    def _value(self, mode: int, number: int, t: float, length: float, x: np.ndarray) -> float:
        state = self._state(mode, t, length, x) if length else x
        function = self._guards(mode).function
        found = self._call(function, t + length, state[: self.size], self.p)[0].ravel()[number]
        if not np.isfinite(found):
            raise FloatingPointError
        return float(found)

    def _state(self, mode: int, t: float, h: float, x: np.ndarray) -> np.ndarray:
        return self._call(self.kernel.variants[mode].step.function, t, h, x, self.p)[0].ravel()

    def _guards(self, mode: int) -> Guards:
        found = self.kernel.variants[mode].guards
        assert found is not None
        return found

    def _call(self, function, *arguments) -> list[np.ndarray]:
        if function not in self._kernels:
            self._kernels[function] = Kernel(function)
        return self._kernels[function](*arguments)

    # going over ---------------------------------------------------------------------------
    def _change(self, passage: Passage, mode: int, number: int, moving: bool) -> int:
        """Let gaps go over to other phases, here and now; the mode after it."""
        guard: Guard = self._guards(mode).watched[number]
        ruling = self.choice.ruled(passage.time, passage.x[: self.size], mode, guard)
        self._told(ruling, passage.time)
        self._changes.append(passage.time)
        if self.trouble:
            return mode
        passed = passage.time - np.array(self._changes)
        if np.sum(passed <= NOW * self.span) > MANY:
            names = self.kernel.equations.contacts[guard.gap].name
            self.trouble = (
                f"{names} opens and closes again and again at t = {passage.time:.9g} s; give it "
                "restitution=0, or a compliant contact"
            )
            return mode
        after_mode = self._phased(mode, ruling.phases, passage.time, passage.x)
        if self.trouble:
            return mode
        change = self.modes.change(mode, after_mode, ruling, number if moving else None)
        after = self._state(change, passage.time, 0.0, passage.x)
        passage.add(0.0, after, change)
        if ruling.impulse is not None:
            self._record(passage.time, ruling, ruling.impulse)
        return after_mode

    def _phased(self, mode: int, phases: Phases, t: float, x: np.ndarray) -> int:
        """The mode with gaps in these phases; the same one where none can be chosen."""
        try:
            return self.modes.phased(mode, phases, t, x[: self.size], self.p)
        except (SingularityError, UnsupportedError) as error:  # closed gaps are constraints as well
            pairs = zip(self.kernel.equations.contacts, phases, strict=True)
            closed = ", ".join(gap.name for gap, phase in pairs if phase is not Phase.APART)
            self.trouble = f"with {closed} closed at t = {t:.9g} s: {error}; use formulation=Kkt()"
            return mode

    def _record(self, time: float, ruling: Ruling, impulse: np.ndarray) -> None:
        gaps, slips = self.kernel.equations.contacts, self.choice.slips
        for k in ruling.gaps:
            if impulse[k] > 0:
                tangential = impulse[slips[k]]
                self.impacts.append(ImpactRecord(gaps[k].name, time, float(impulse[k]), tangential))
        if ruling.together:
            self.together.append((time, " and ".join(gaps[k].name for k in ruling.together)))
        self.closed += [(time, gaps[k].name) for k in sorted(ruling.dead)]

    def _told(self, ruling: Ruling, time: float) -> None:
        if ruling.rest is not None:
            pairs = zip(ruling.resting, ruling.rest.sectors, strict=True)
            names = (self.kernel.equations.contacts[k].name for k, n in pairs if n is not None)
            self.begun += [(time, name) for name in names]
        if ruling.trouble:
            self.trouble, self.inconsistent = ruling.trouble, True


def begun(ruling: Ruling) -> Phases:
    """Phases at the start; what begins to slide over a surface sticks until the first step, in
    which its direction is found."""
    phases = list(ruling.phases)
    if ruling.rest is not None:
        for k, sector in zip(ruling.resting, ruling.rest.sectors, strict=True):
            phases[k] = phases[k] if sector is None else Phase.STICKING
    return tuple(phases)
