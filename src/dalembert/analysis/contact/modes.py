"""The modes of a kernel in which rigid gaps are in other phases, and those between them."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.contact.headings import Headings
from dalembert.analysis.contact.jump import Jump
from dalembert.analysis.contact.pattern import Pattern
from dalembert.analysis.contact.quantities import ContactDynamics
from dalembert.analysis.contact.ruling import Ruling
from dalembert.analysis.dynamics.variant import Variant
from dalembert.integrators.base import Integrator
from dalembert.model.contacts import Phase, Phases
from dalembert.model.coordinates import CoordinateView

Choose = Callable[[float, np.ndarray, np.ndarray, tuple[int, ...], Phases, Integrator], int]


class ContactModes:
    """What contacts ask of a kernel.

    Parameters
    ----------
    view : the model in the coordinates that are integrated
    variants : of the kernel, by mode; changes are added to it
    choose : ``(t, x, p, rows, phases, integrator)`` → mode
    """

    def __init__(self, view: CoordinateView, variants: list[Variant], choose: Choose):
        self.view, self.variants, self.choose = view, variants, choose
        self._changes: dict[tuple, int] = {}
        self._jumps: dict[tuple, Jump] = {}
        self._headings: dict[tuple, Headings] = {}
        self._dynamics: dict[tuple, tuple[ContactDynamics, ca.Function]] = {}

    def phased(self, mode: int, phases: Phases, t: float, x: np.ndarray, p: np.ndarray) -> int:
        """The mode with gaps in these phases, well conditioned at a state.

        Closed gaps are further constraints, so that the formulation chooses anew.
        """
        now = self.variants[mode]
        if phases == now.phases:
            return mode
        wanted = (now.rows, phases, now.integrator)
        for known, v in enumerate(self.variants):
            alike = type(v) is Variant and (v.rows, v.phases, v.integrator) == wanted
            if alike and v.is_conditioned(t, x, p):
                return known
        return self.choose(t, x, p, now.rows, phases, now.integrator)

    def dynamics(self, mode: int) -> tuple[ContactDynamics, ca.Function]:
        """How gaps move with the constraints of a mode, and the same as a function."""
        now = self.variants[mode]
        key = (now.rows, now.bare)
        if key not in self._dynamics:
            made = ContactDynamics(self.view.with_rows(now.rows), now.bare)
            self._dynamics[key] = made, made.function
        return self._dynamics[key]

    def jump(
        self,
        mode: int,
        gaps: tuple[int, ...],
        patterns: tuple[Pattern, ...],
        dead: frozenset[int],
    ) -> Jump:
        """An impact in which gaps do this."""
        now = self.variants[mode]
        key = (now.rows, now.bare, gaps, patterns, dead)
        if key not in self._jumps:
            self._jumps[key] = Jump(self.dynamics(mode)[0], gaps, patterns, dead)
        return self._jumps[key]

    def headings(self, mode: int, ruling: Ruling) -> Headings | None:
        """Directions of slip to remember, if there are some."""
        if ruling.rest is None or Phase.SLIDING not in ruling.rest.phases:
            return None
        now = self.variants[mode]
        key = (now.rows, now.bare, ruling.resting, ruling.rest)
        if key not in self._headings:
            self._headings[key] = Headings(self.dynamics(mode)[0], ruling.resting, ruling.rest)
        return self._headings[key]

    def settling(self, mode: int, ruling: Ruling) -> Jump | None:
        """What takes away the rest of slips over surfaces that stop."""
        if ruling.rest is None:
            return None
        before = self.variants[mode].phases
        stops = [
            before[k] is Phase.SLIDING and ruling.phases[k] is Phase.STICKING
            for k in ruling.resting
        ]
        if not any(stops):
            return None
        held = Phase.APART, Phase.STICKING
        kept = (phase if phase in held else Phase.SMOOTH for phase in ruling.rest.phases)
        none: tuple[None, ...] = (None,) * len(ruling.resting)
        pattern = Pattern(tuple(kept), ruling.rest.released, none)
        return self.jump(mode, ruling.resting, (pattern,), frozenset(ruling.resting))

    def change(self, mode: int, after: int, ruling: Ruling, guard: int | None) -> int:
        """The mode in which gaps go over to the phases of the mode after it."""
        given = ruling.phases, ruling.gaps, ruling.patterns, ruling.dead, ruling.together
        key = (mode, after, guard, ruling.impulse is None, ruling.resting, ruling.rest, *given)
        if key not in self._changes:
            struck = ruling.impulse is not None
            jump = (
                self.jump(mode, ruling.gaps, ruling.patterns, ruling.dead)
                if struck
                else self.settling(mode, ruling)
            )
            sudden = [each for each in (jump, self.headings(mode, ruling)) if each is not None]
            ends = ruling.dead, ruling.together
            between = self.variants[mode], self.variants[after]
            self.variants.append(ContactChange(*between, guard, sudden, struck, *ends))
            self._changes[key] = len(self.variants) - 1
        return self._changes[key]
