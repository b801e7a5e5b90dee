"""Modes of a kernel for phases of rigid gaps, and for changes between them."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.contact.contact_dynamics import ContactDynamics
from dalembert.analysis.contact.pattern import ActiveSet, Pattern
from dalembert.analysis.contact.state_jumps import Headings, Jump
from dalembert.analysis.dynamics.variant import Variant
from dalembert.integrators.base import Integrator
from dalembert.model.graph.contacts import Phase, Phases
from dalembert.model.graph.coordinates import CoordinateView
from dalembert.model.graph.rigid_gaps import Branch

Choose = Callable[[float, np.ndarray, np.ndarray, tuple[int, ...], Phases, Integrator], int]


class ContactModes:
    """Variants and changes of a kernel for rigid contacts.

    Parameters
    ----------
    view : the model in the integrated coordinates
    variants : variants of the kernel by mode; changes are appended
    choose : ``(t, x, p, rows, phases, integrator)`` → mode
    """

    def __init__(self, view: CoordinateView, variants: list[Variant], choose: Choose):
        self.view, self.variants, self.choose = view, variants, choose
        self._changes: dict[tuple, int] = {}
        self._jumps: dict[tuple, Jump] = {}
        self._headings: dict[tuple, Headings] = {}
        self._dynamics: dict[tuple, tuple[ContactDynamics, ca.Function]] = {}

    def phased(self, mode: int, phases: Phases, t: float, x: np.ndarray, p: np.ndarray) -> int:
        """The mode with the given phases of gaps, well conditioned at a state.

        Closed gaps are additional constraints, so the formulation chooses again.
        """
        variant = self.variants[mode]
        if phases == variant.phases:
            return mode
        key = (variant.rows, phases, variant.integrator)
        for candidate, v in enumerate(self.variants):
            same = type(v) is Variant and (v.rows, v.phases, v.integrator) == key
            if same and v.is_conditioned(t, x, p):
                return candidate
        return self.choose(t, x, p, variant.rows, phases, variant.integrator)

    def dynamics(self, mode: int) -> tuple[ContactDynamics, ca.Function]:
        """Contact dynamics with the constraints of a mode, on any branches, and its function."""
        variant = self.variants[mode]
        key = (variant.rows, variant.bare)
        if key not in self._dynamics:
            dynamics = ContactDynamics(self.view.with_rows(variant.rows), variant.bare)
            self._dynamics[key] = dynamics, dynamics.function
        return self._dynamics[key]

    def jump(
        self,
        mode: int,
        gaps: tuple[int, ...],
        patterns: tuple[Pattern, ...],
        dead: frozenset[int],
        branches: tuple[Branch, ...],
    ) -> Jump:
        """The jump of an impact with the given patterns of gaps."""
        variant = self.variants[mode]
        key = (variant.rows, variant.bare, gaps, patterns, dead, branches)
        if key not in self._jumps:
            self._jumps[key] = Jump(self.dynamics(mode)[0], gaps, patterns, dead, branches)
        return self._jumps[key]

    def headings(self, mode: int, active_set: ActiveSet) -> Headings | None:
        """Renewal of slip directions, None if no gap slides over a surface."""
        resting, rest = active_set.resting, active_set.rest
        if rest is None or Phase.SLIDING not in rest.phases:
            return None
        variant, branches = self.variants[mode], active_set.branches
        key = (variant.rows, variant.bare, resting, rest, branches)
        if key not in self._headings:
            self._headings[key] = Headings(self.dynamics(mode)[0], resting, rest, branches)
        return self._headings[key]

    def settling(self, mode: int, active_set: ActiveSet) -> Jump | None:
        """Jump that removes residual slips where sliding over surfaces stops, None if none does."""
        rest = active_set.rest
        if rest is None:
            return None
        before, resting = self.variants[mode].phases, active_set.resting
        stops = [
            before[k] is Phase.SLIDING and active_set.phases[k] is Phase.STICKING for k in resting
        ]
        if not any(stops):
            return None
        unchanged = Phase.APART, Phase.STICKING
        phases = tuple(p if p in unchanged else Phase.SMOOTH for p in rest.phases)
        none: tuple[None, ...] = (None,) * len(resting)
        pattern = Pattern(phases, rest.released, none)
        return self.jump(mode, resting, (pattern,), frozenset(resting), active_set.branches)

    def change(self, mode: int, after: int, active_set: ActiveSet, guard: int | None) -> int:
        """The mode of the change from one mode to the phases of another."""
        impact = active_set.gaps, active_set.patterns, active_set.dead, active_set.branches
        phases = active_set.phases, active_set.resting, active_set.rest
        struck = active_set.impulse is not None
        key = (mode, after, guard, struck, *phases, *impact, active_set.together)
        if key not in self._changes:
            jump = self.jump(mode, *impact) if struck else self.settling(mode, active_set)
            headings = self.headings(mode, active_set)
            state_maps = [state_map for state_map in (jump, headings) if state_map is not None]
            ends = active_set.dead, active_set.together
            variants = self.variants[mode], self.variants[after]
            self.variants.append(ContactChange(*variants, guard, state_maps, struck, *ends))
            self._changes[key] = len(self.variants) - 1
        return self._changes[key]
