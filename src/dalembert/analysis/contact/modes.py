"""The modes of a kernel in which rigid gaps are in other phases, and those between them."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.contact.jump import Jump
from dalembert.analysis.contact.quantities import ContactDynamics
from dalembert.analysis.contact.ruling import Ruling
from dalembert.analysis.variant import Variant
from dalembert.formulations.base import Formulation
from dalembert.model.contacts import Phases
from dalembert.model.coordinates import CoordinateView

ModeOf = Callable[[tuple[int, ...], Formulation, Phases], int]


class ContactModes:
    """What contacts ask of a kernel.

    Parameters
    ----------
    view : the model in the coordinates that are integrated
    variants : of the kernel, by mode; changes are added to it
    mode_of : ``(rows, formulation, phases)`` → mode
    """

    def __init__(self, view: CoordinateView, variants: list[Variant], mode_of: ModeOf):
        self.view, self.variants, self.mode_of = view, variants, mode_of
        self._changes: dict[tuple, int] = {}
        self._jumps: dict[tuple, Jump] = {}
        self._dynamics: dict[tuple, tuple[ContactDynamics, ca.Function]] = {}

    def phased(self, mode: int, phases: Phases) -> int:
        """The mode with gaps in these phases."""
        now = self.variants[mode]
        return self.mode_of(now.rows, now.formulation, phases)

    def dynamics(self, mode: int) -> tuple[ContactDynamics, ca.Function]:
        """How gaps move with the constraints of a mode, and the same as a function."""
        now = self.variants[mode]
        key = (now.rows, now.formulation)
        if key not in self._dynamics:
            made = ContactDynamics(self.view.with_rows(now.rows), now.formulation)
            self._dynamics[key] = made, made.function
        return self._dynamics[key]

    def jump(self, mode: int, gaps: tuple[int, ...], pattern: Phases, dead: frozenset[int]) -> Jump:
        """An impact in which gaps are in these phases."""
        now = self.variants[mode]
        key = (now.rows, now.formulation, gaps, pattern, dead)
        if key not in self._jumps:
            self._jumps[key] = Jump(self.dynamics(mode)[0], gaps, pattern, dead)
        return self._jumps[key]

    def change(self, mode: int, ruling: Ruling, guard: int | None) -> int:
        """The mode in which gaps go over to other phases between steps of a mode."""
        given = ruling.phases, ruling.gaps, ruling.pattern, ruling.dead, ruling.together
        key = (mode, guard, ruling.impulse is None, *given)
        if key not in self._changes:
            jump = None
            if ruling.impulse is not None:
                jump = self.jump(mode, ruling.gaps, ruling.pattern, ruling.dead)
            after = self.variants[self.phased(mode, ruling.phases)]
            ends = ruling.dead, ruling.together
            self.variants.append(ContactChange(self.variants[mode], after, guard, jump, *ends))
            self._changes[key] = len(self.variants) - 1
        return self._changes[key]
