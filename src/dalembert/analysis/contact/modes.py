"""The modes of a kernel in which rigid gaps are in other phases, and those between them."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.contact.headings import Headings
from dalembert.analysis.contact.jump import Jump
from dalembert.analysis.contact.pattern import Pattern
from dalembert.analysis.contact.quantities import ContactDynamics
from dalembert.analysis.contact.ruling import Ruling
from dalembert.analysis.dynamics.variant import Variant
from dalembert.formulations.base import Formulation
from dalembert.integrators.base import Integrator
from dalembert.model.contacts import Phase, Phases
from dalembert.model.coordinates import CoordinateView

ModeOf = Callable[[tuple[int, ...], Formulation, Phases, Integrator], int]


class ContactModes:
    """What contacts ask of a kernel.

    Parameters
    ----------
    view : the model in the coordinates that are integrated
    variants : of the kernel, by mode; changes are added to it
    mode_of : ``(rows, formulation, phases, integrator)`` → mode
    """

    def __init__(self, view: CoordinateView, variants: list[Variant], mode_of: ModeOf):
        self.view, self.variants, self.mode_of = view, variants, mode_of
        self._changes: dict[tuple, int] = {}
        self._jumps: dict[tuple, Jump] = {}
        self._headings: dict[tuple, Headings] = {}
        self._dynamics: dict[tuple, tuple[ContactDynamics, ca.Function]] = {}

    def phased(self, mode: int, phases: Phases) -> int:
        """The mode with gaps in these phases."""
        now = self.variants[mode]
        return self.mode_of(now.rows, now.formulation, phases, now.integrator)

    def dynamics(self, mode: int) -> tuple[ContactDynamics, ca.Function]:
        """How gaps move with the constraints of a mode, and the same as a function."""
        now = self.variants[mode]
        key = (now.rows, now.formulation)
        if key not in self._dynamics:
            made = ContactDynamics(self.view.with_rows(now.rows), now.formulation)
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
        key = (now.rows, now.formulation, gaps, patterns, dead)
        if key not in self._jumps:
            self._jumps[key] = Jump(self.dynamics(mode)[0], gaps, patterns, dead)
        return self._jumps[key]

    def headings(self, mode: int, ruling: Ruling) -> Headings | None:
        """Directions of slip to remember, if there are some."""
        if ruling.rest is None or Phase.SLIDING not in ruling.rest.phases:
            return None
        now = self.variants[mode]
        key = (now.rows, now.formulation, ruling.resting, ruling.rest)
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

    def change(self, mode: int, ruling: Ruling, guard: int | None) -> int:
        """The mode in which gaps go over to other phases between steps of a mode."""
        given = ruling.phases, ruling.gaps, ruling.patterns, ruling.dead, ruling.together
        key = (mode, guard, ruling.impulse is None, ruling.resting, ruling.rest, *given)
        if key not in self._changes:
            struck = ruling.impulse is not None
            jump = (
                self.jump(mode, ruling.gaps, ruling.patterns, ruling.dead)
                if struck
                else self.settling(mode, ruling)
            )
            sudden = [each for each in (jump, self.headings(mode, ruling)) if each is not None]
            after, ends = self.phased(mode, ruling.phases), (ruling.dead, ruling.together)
            between = self.variants[mode], self.variants[after]
            self.variants.append(ContactChange(*between, guard, sudden, struck, *ends))
            self._changes[key] = len(self.variants) - 1
        return self._changes[key]
