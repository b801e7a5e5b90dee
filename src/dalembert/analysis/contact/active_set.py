"""Selection of the active set of rigid gaps at a state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dalembert.analysis.contact.complementarity import GapConditions, Solution, solutions, too_many
from dalembert.analysis.contact.contact_dynamics import ContactState, GapBranches, slip_rows
from dalembert.analysis.contact.gap_checks import TOUCHING, refuse_negative
from dalembert.analysis.contact.guards import Change, Guard
from dalembert.analysis.contact.modes import ContactModes
from dalembert.analysis.contact.pattern import ActiveSet, GapRows, Pattern
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.model.graph.contacts import BranchedPhases, Phase, Phases, branches_of
from dalembert.model.graph.rigid_gaps import Branch, all_sides

RESTING = 1e-9
"""Threshold for a speed at rest, relative to the sum of the magnitudes of its terms."""
ZENO = 1e-9
"""Time of flight, relative to the run, below which a gap stops bouncing."""
LEAST = 1e-3
"""Minimum scale of accelerations: that of this share of the natural force."""
CLOSED = (Phase.SMOOTH, Phase.STICKING, Phase.FORWARD, Phase.BACKWARD)


class ActiveSetSelector:
    """Selection of phases and impacts of the gaps in one run.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    modes : its ContactModes
    p : (np,) parameters
    span : length of the run [s]
    """

    def __init__(self, kernel: DynamicsKernel, modes: ContactModes, p: np.ndarray, span: float):
        self.kernel, self.modes, self.p, self.span = kernel, modes, p, span
        self.gaps, self.slips = kernel.equations.contacts, slip_rows(kernel.equations)
        self.poisson = any(gap.impact.poisson for gap in self.gaps)
        self.crowded = False
        self.near = TOUCHING * kernel.equations.scales.length
        self.selection = GapBranches(kernel.equations)
        self._branches: list[Branch] = []

    def at_start(self, t: float, x: np.ndarray, mode: int) -> ActiveSet:
        """Active set at the start; gaps that close there impact in the first step."""
        self._branches = self._branches_at(t, x, mode)
        state = self._state(t, x, mode)
        refuse_negative(self.gaps, state.distance, self.near)
        apart = (Phase.APART,) * len(self.gaps)
        resting = np.abs(state.speed) <= RESTING * state.size
        touching = [k for k in range(len(self.gaps)) if state.distance[k] <= self.near]
        return self._lasting(t, state, [k for k in touching if resting[k]], apart, None)

    def at_guard(self, t: float, x: np.ndarray, mode: int, guard: Guard) -> ActiveSet:
        """Active set, with an impact if there is one, where a guard has reached zero."""
        before = self.kernel.variants[mode].phases
        if guard.change is Change.TURNS:
            return self._with_new_directions(before)
        passes = guard.change is Change.PASSES
        self._branches = self._branches_at(t, x, mode, guard if passes else None)
        state = self._state(t, x, mode)
        touching = [
            k
            for k, phase in enumerate(before)
            if phase is not Phase.APART or state.distance[k] <= self.near or k == guard.gap
        ]
        if passes and abs(state.distance[guard.gap]) > self.near:
            if state.distance[guard.gap] < 0:
                return ActiveSet(before, trouble=self._overlap(t, guard.gap))
            touching.remove(guard.gap)
        free = [k for k in touching if before[k] is Phase.APART or (passes and k == guard.gap)]
        closing = tuple(k for k in free if state.speed[k] < -RESTING * state.size[k])
        if not closing:
            return self._lasting(t, state, touching, before, guard)
        active_set, flights = self._impact(t, x, mode, touching, closing, frozenset())
        if dead := frozenset(k for k in closing if flights[k] <= ZENO * self.span):
            active_set, _ = self._impact(t, x, mode, touching, closing, dead)
        return active_set

    def _branches_at(
        self, t: float, x: np.ndarray, mode: int, passed: Guard | None = None
    ) -> list[Branch]:
        """Branches of all distances immediately after an instant; closed gaps keep theirs."""
        if not self.selection.count:
            return [()] * len(self.gaps)
        variant = self.kernel.variants[mode]
        rate = variant.rate.function(t, x, self.p).full().ravel()[: x.size]
        switch = None if passed is None else (passed.gap, passed.switch, passed.after)
        branches = self.selection.sides(t, x, rate, self.p, switch)
        for k, branch in enumerate(branches_of(variant.phases)):
            if branch and (passed is None or passed.gap != k):
                branches[k] = branch
        return branches

    def _touched(self, gaps: Sequence[int]) -> tuple[Branch, ...]:
        """Branches of some gaps, without sides of no influence; none of the others."""
        switches = [gap.switches for gap in self.gaps]
        return tuple(
            switches[k].branch(branch) if k in gaps and branch else ()
            for k, branch in enumerate(self._branches)
        )

    def _overlap(self, t: float, gap: int) -> str:
        """Message where the distance jumps to a negative value."""
        return (
            f"the distance of {self.gaps[gap].name} jumps to a negative value at t = {t:.9g} s, "
            "where it changes its branch; make it continuous"
        )

    @staticmethod
    def _with_new_directions(phases: Phases) -> ActiveSet:
        """The same phases with new slip directions."""
        closed = tuple(k for k, phase in enumerate(phases) if phase is not Phase.APART)
        closed_phases = tuple(phases[k] for k in closed)
        none = (None,) * len(closed)
        rest = Pattern(closed_phases, (False,) * len(closed), none)
        return ActiveSet(phases, resting=closed, rest=rest, branches=branches_of(phases))

    def _impact(
        self,
        t: float,
        x: np.ndarray,
        mode: int,
        touching: list[int],
        closing: tuple[int, ...],
        dead: frozenset[int],
    ) -> tuple[ActiveSet, np.ndarray]:
        """Active set after an impact, and times until the gaps close again [s]."""
        before, state = self.kernel.variants[mode].phases, self._state(t, x, mode)
        endless = np.full(len(self.gaps), np.inf)
        parts = self._struck(state, touching, dead)
        if len(parts[-1]) != 1:
            return ActiveSet(
                before, trouble=self._undecided(t, state, touching, parts[-1], "impact")
            ), endless
        patterns = tuple(part[0].pattern for part in parts)
        impulse = sum((part[0].impulse for part in parts), np.zeros(state.speed.size))
        branches = self._touched(touching)
        jump = self.modes.jump(mode, tuple(touching), patterns, dead, branches)
        x_after, jump_impulse = (out.full().ravel() for out in jump.function(t, x, self.p))
        if not np.allclose(jump_impulse, impulse, 0, 1e-6 * np.max(np.abs(impulse), initial=0.0)):
            text = self._undecided(t, state, touching, [], "impact")
            return ActiveSet(before, trouble=text), endless
        after = self._state(t, x_after, mode)
        terms = np.maximum(state.size, after.size)
        resting = [k for k in touching if abs(after.speed[k]) <= RESTING * terms[k]]
        lasting = self._lasting(t, after, resting, before, None, terms)
        together = closing if len(closing) > 1 else ()
        active_set = ActiveSet(
            lasting.phases,
            tuple(touching),
            patterns,
            dead,
            impulse,
            together,
            lasting.trouble,
            lasting.acceleration,
            lasting.resting,
            lasting.rest,
            branches,
        )
        if lasting.acceleration is None:
            return active_set, endless
        away, pull = after.speed[: endless.size], -lasting.acceleration[: endless.size]
        flying = (away > RESTING * terms[: endless.size]) & (pull > 0)
        pull = np.where(flying, pull, 1.0)
        above_rounding = away**2 / (2 * pull) > after.rounding  # higher than rounding
        return active_set, np.where(flying, np.where(above_rounding, 2 * away / pull, 0.0), np.inf)

    def _state(self, t: float, x: np.ndarray, mode: int) -> ContactState:
        function = self.modes.dynamics(mode)[1]
        sides = all_sides(self._branches)
        return ContactState.at(function, self.kernel.equations, t, x, self.p, sides)

    # impacts ------------------------------------------------------------------------------
    def _struck(
        self, state: ContactState, gaps: list[int], dead: frozenset[int]
    ) -> list[list[Solution]]:
        """Possible impacts: one list, or two for compression and restitution by Poisson's law."""
        touches = [self._touch(state, k, (Phase.APART, *self._closed(state, k))) for k in gaps]
        if not self.poisson:
            c = state.speed.copy()
            for k in gaps:
                if k not in dead:
                    c[k] *= 1 + state.restitution[k]
                c[state.slips[k]] *= 1 + state.tangential[k]
            return [self._solutions(state, c, touches)]
        compression = self._solutions(state, state.speed, touches)
        if len(compression) != 1:
            return [compression]
        restitution = [
            0.0 if k in dead else state.restitution[k] * compression[0].impulse[k] for k in gaps
        ]
        touches = [
            replace(t, prescribed=float(g)) for t, g in zip(touches, restitution, strict=True)
        ]
        size = float(np.max(np.abs(state.speed), initial=0.0))
        return [compression, self._solutions(state, compression[0].result, touches, size)]

    def _solutions(
        self, state: ContactState, c: np.ndarray, touches: list[GapConditions], least: float = 0.0
    ) -> list[Solution]:
        self.crowded = too_many(touches)
        return solutions(state.delassus, c, touches, least)

    def _touch(
        self, state: ContactState, k: int, allowed: Phases, along: np.ndarray | None = None
    ) -> GapConditions:
        slips = tuple(state.slips[k]) if state.rubs(k) else ()
        return GapConditions(GapRows(k, slips), float(state.friction[k]), allowed, along)

    @staticmethod
    def _closed(state: ContactState, k: int, slips: bool = False) -> Phases:
        """Phases of a closed gap; the first possible one counts where several gaps share a load.

        Then few gaps rub at rest, and all slide together when the last one begins to slide.
        """
        if not state.rubs(k):
            return (Phase.SMOOTH,)
        wide = len(state.slips[k]) > 1
        resting = Phase.STICKING, Phase.SMOOTH
        sliding = (Phase.SLIDING,) if wide else (Phase.FORWARD, Phase.BACKWARD)
        return sliding + resting if slips else resting + sliding

    # lasting contact ------------------------------------------------------------------------
    def _lasting(
        self,
        t: float,
        state: ContactState,
        gaps: list[int],
        before: Phases,
        guard: Guard | None,
        terms: np.ndarray | None = None,
    ) -> ActiveSet:
        """Active set of gaps that touch and do not separate; the other gaps are apart."""
        terms = state.size if terms is None else terms
        gaps = [k for k in gaps if state.speed[k] <= RESTING * terms[k]]
        touches = [self._resting(state, k, before[k], guard, terms) for k in gaps]
        softest = np.max(np.diag(state.delassus), initial=0.0)
        least = LEAST * self.kernel.equations.scales.force * softest  # scale where a force vanishes
        patterns = self._solutions(state, state.acceleration, touches, least)
        if len(patterns) != 1:
            return ActiveSet(before, trouble=self._undecided(t, state, gaps, patterns, "contact"))
        phases = [Phase.APART] * len(self.gaps)
        for k, phase in zip(gaps, patterns[0].phases, strict=True):
            phases[k] = phase
        resting, rest, branches = tuple(gaps), patterns[0].pattern, self._touched(gaps)
        lasting = BranchedPhases(phases, branches) if any(branches) else tuple(phases)
        acceleration = patterns[0].result
        return ActiveSet(
            lasting, acceleration=acceleration, resting=resting, rest=rest, branches=branches
        )

    def _resting(self, state: ContactState, k: int, before: Phase, guard, terms) -> GapConditions:
        slips = guard is not None and guard.change is Change.SLIPS
        allowed: tuple[Phase, ...] = (Phase.APART, *self._closed(state, k, slips))
        along = None
        if state.rubs(k):
            slip, size = state.speed[state.slips[k]], np.max(terms[state.slips[k]])
            stops = guard is not None and guard.gap == k and guard.change is Change.STOPS
            if np.linalg.norm(slip) > RESTING * size and not stops:
                along = slip / np.linalg.norm(slip)
                allowed = (Phase.APART, self._sliding(along))
        passes = guard is not None and guard.change is Change.PASSES
        if guard is not None and guard.gap == k and before is not Phase.APART and not passes:
            excluded = CLOSED if guard.change is Change.LIFTS else (before,)
            allowed = tuple(phase for phase in allowed if phase not in excluded)
        return self._touch(state, k, allowed, along)

    @staticmethod
    def _sliding(along: np.ndarray) -> Phase:
        if along.size > 1:
            return Phase.SLIDING
        return Phase.FORWARD if along[0] > 0 else Phase.BACKWARD

    def _undecided(
        self, t: float, state: ContactState, gaps, possible: list[Solution], kind: str
    ) -> str:
        """Message where no unique pattern exists; it names friction if there is any."""
        names = ", ".join(dict.fromkeys(self.gaps[k].name for k in gaps))
        if not possible and self.crowded:
            return f"so many gaps touch at t = {t:.9g} s that not all patterns are tried: {names}"
        count = f"{len(possible)} motions" if possible else "no motion"
        if any(state.rubs(k) for k in gaps):
            return (
                f"rigid {kind} with friction has {count} at t = {t:.9g} s at {names} (Painlevé); "
                "lower the friction, or use a compliant contact"
            )
        return (
            f"rigid {kind} has {count} at t = {t:.9g} s at {names}: drivers or joints hold the "
            "bodies there; release them, or use a compliant contact"
        )
