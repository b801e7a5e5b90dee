"""What gaps do at a state: bounce, rest, stick, slide or part."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.contact.complementarity import Solution, Touch, solutions, too_many
from dalembert.analysis.contact.guards import Change, Guard
from dalembert.analysis.contact.modes import ContactModes
from dalembert.analysis.contact.pattern import Pattern, Place
from dalembert.analysis.contact.quantities import ContactState, slip_rows
from dalembert.analysis.contact.ruling import Ruling
from dalembert.analysis.contact.start import TOUCHING, refuse_negative
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.model.contacts import Phase, Phases

RESTING = 1e-9
"""Speed, relative to what it is the sum of, that counts as none."""
ZENO = 1e-9
"""Time of flight, relative to the run, below which a gap bounces no more."""
LEAST = 1e-3
"""Part of the natural force whose acceleration others are measured by at least."""
CLOSED = (Phase.SMOOTH, Phase.STICKING, Phase.FORWARD, Phase.BACKWARD)


class ContactChoice:
    """Decides for one run.

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

    def at_start(self, t: float, x: np.ndarray, mode: int) -> Ruling:
        """Phases at the start; what closes there is left to the first step."""
        state = self._state(t, x, mode)
        refuse_negative(self.gaps, state.distance, self.near)
        apart = (Phase.APART,) * len(self.gaps)
        resting = np.abs(state.speed) <= RESTING * state.size
        touching = [k for k in range(len(self.gaps)) if state.distance[k] <= self.near]
        return self._rested(t, state, [k for k in touching if resting[k]], apart, None)

    def ruled(self, t: float, x: np.ndarray, mode: int, guard: Guard) -> Ruling:
        """What happens where a guard has reached zero."""
        before, state = self.kernel.variants[mode].phases, self._state(t, x, mode)
        if guard.change is Change.TURNS:
            return self._turned(before)
        touching = [
            k
            for k, phase in enumerate(before)
            if phase is not Phase.APART or state.distance[k] <= self.near or k == guard.gap
        ]
        apart = [k for k in touching if before[k] is Phase.APART]
        closing = tuple(k for k in apart if state.speed[k] < -RESTING * state.size[k])
        if not closing:
            return self._rested(t, state, touching, before, guard)
        ruling, flights = self._impact(t, x, mode, touching, closing, frozenset())
        if dead := frozenset(k for k in closing if flights[k] <= ZENO * self.span):
            ruling, _ = self._impact(t, x, mode, touching, closing, dead)
        return ruling

    @staticmethod
    def _turned(phases: Phases) -> Ruling:
        """All goes on; directions of slip are remembered anew."""
        closed = tuple(k for k, phase in enumerate(phases) if phase is not Phase.APART)
        kept = tuple(phases[k] for k in closed)
        none = (None,) * len(closed)
        return Ruling(phases, resting=closed, rest=Pattern(kept, (False,) * len(closed), none))

    def _impact(
        self,
        t: float,
        x: np.ndarray,
        mode: int,
        touching: list[int],
        closing: tuple[int, ...],
        dead: frozenset[int],
    ) -> tuple[Ruling, np.ndarray]:
        """An impact and the phases after it; the time every gap would fly until it closes again."""
        before, state = self.kernel.variants[mode].phases, self._state(t, x, mode)
        endless = np.full(len(self.gaps), np.inf)
        parts = self._struck(state, touching, dead)
        if len(parts[-1]) != 1:
            return Ruling(
                before, trouble=self._undecided(t, state, touching, parts[-1], "impact")
            ), endless
        patterns = tuple(found[0].pattern for found in parts)
        impulse = sum((found[0].impulse for found in parts), np.zeros(state.speed.size))
        jump = self.modes.jump(mode, tuple(touching), patterns, dead)
        x_after, taken = (out.full().ravel() for out in jump.function(t, x, self.p))
        if not np.allclose(taken, impulse, 0, 1e-6 * np.max(np.abs(impulse), initial=0.0)):
            text = self._undecided(t, state, touching, [], "impact")
            return Ruling(before, trouble=text), endless
        after = self._state(t, x_after, mode)
        terms = np.maximum(state.size, after.size)
        resting = [k for k in touching if abs(after.speed[k]) <= RESTING * terms[k]]
        rested = self._rested(t, after, resting, before, None, terms)
        together = closing if len(closing) > 1 else ()
        ruling = Ruling(
            rested.phases,
            tuple(touching),
            patterns,
            dead,
            impulse,
            together,
            rested.trouble,
            rested.acceleration,
            rested.resting,
            rested.rest,
        )
        if rested.acceleration is None:
            return ruling, endless
        away, pull = after.speed[: endless.size], -rested.acceleration[: endless.size]
        flying = (away > RESTING * terms[: endless.size]) & (pull > 0)
        pull = np.where(flying, pull, 1.0)
        seen = away**2 / (2 * pull) > after.blur  # higher than rounding
        return ruling, np.where(flying, np.where(seen, 2 * away / pull, 0.0), np.inf)

    def _state(self, t: float, x: np.ndarray, mode: int) -> ContactState:
        function = self.modes.dynamics(mode)[1]
        return ContactState.at(function, self.kernel.equations, t, x, self.p)

    # impacts ------------------------------------------------------------------------------
    def _struck(
        self, state: ContactState, gaps: list[int], dead: frozenset[int]
    ) -> list[list[Solution]]:
        """What is possible: one list, by Poisson's law of compression and then of restitution."""
        touches = [self._touch(state, k, (Phase.APART, *self._closed(state, k))) for k in gaps]
        if not self.poisson:
            c = state.speed.copy()
            for k in gaps:
                if k not in dead:
                    c[k] *= 1 + state.restitution[k]
                c[state.slips[k]] *= 1 + state.tangential[k]
            return [self._solutions(state, c, touches)]
        pressed = self._solutions(state, state.speed, touches)
        if len(pressed) != 1:
            return [pressed]
        given = [0.0 if k in dead else state.restitution[k] * pressed[0].impulse[k] for k in gaps]
        touches = [replace(t, given=float(g)) for t, g in zip(touches, given, strict=True)]
        size = float(np.max(np.abs(state.speed), initial=0.0))
        return [pressed, self._solutions(state, pressed[0].result, touches, size)]

    def _solutions(
        self, state: ContactState, c: np.ndarray, touches: list[Touch], least: float = 0.0
    ) -> list[Solution]:
        self.crowded = too_many(touches)
        return solutions(state.delassus, c, touches, least)

    def _touch(
        self, state: ContactState, k: int, allowed: Phases, along: np.ndarray | None = None
    ) -> Touch:
        slips = tuple(state.slips[k]) if state.rubs(k) else ()
        return Touch(Place(k, slips), float(state.friction[k]), allowed, along)

    @staticmethod
    def _closed(state: ContactState, k: int, slips: bool = False) -> Phases:
        """Phases of a closed gap; the first that fits counts where several gaps share a load.

        Then at rest few of them rub, and all slide together when the last one begins to.
        """
        if not state.rubs(k):
            return (Phase.SMOOTH,)
        wide = len(state.slips[k]) > 1
        resting = Phase.STICKING, Phase.SMOOTH
        sliding = (Phase.SLIDING,) if wide else (Phase.FORWARD, Phase.BACKWARD)
        return sliding + resting if slips else resting + sliding

    # lasting contact ------------------------------------------------------------------------
    def _rested(
        self,
        t: float,
        state: ContactState,
        gaps: list[int],
        before: Phases,
        guard: Guard | None,
        terms: np.ndarray | None = None,
    ) -> Ruling:
        """Phases of gaps that touch and do not move apart; the others are apart."""
        terms = state.size if terms is None else terms
        gaps = [k for k in gaps if state.speed[k] <= RESTING * terms[k]]
        touches = [self._resting(state, k, before[k], guard, terms) for k in gaps]
        softest = np.max(np.diag(state.delassus), initial=0.0)
        least = LEAST * self.kernel.equations.scales.force * softest  # where a force just vanishes
        found = self._solutions(state, state.acceleration, touches, least)
        if len(found) != 1:
            return Ruling(before, trouble=self._undecided(t, state, gaps, found, "contact"))
        phases = [Phase.APART] * len(self.gaps)
        for k, phase in zip(gaps, found[0].phases, strict=True):
            phases[k] = phase
        touched, rest = tuple(gaps), found[0].pattern
        return Ruling(tuple(phases), acceleration=found[0].result, resting=touched, rest=rest)

    def _resting(self, state: ContactState, k: int, before: Phase, guard, terms) -> Touch:
        slips = guard is not None and guard.change is Change.SLIPS
        allowed: tuple[Phase, ...] = (Phase.APART, *self._closed(state, k, slips))
        along = None
        if state.rubs(k):
            slip, size = state.speed[state.slips[k]], np.max(terms[state.slips[k]])
            stops = guard is not None and guard.gap == k and guard.change is Change.STOPS
            if np.linalg.norm(slip) > RESTING * size and not stops:
                along = slip / np.linalg.norm(slip)
                allowed = (Phase.APART, self._sliding(along))
        if guard is not None and guard.gap == k and before is not Phase.APART:
            left = CLOSED if guard.change is Change.LIFTS else (before,)
            allowed = tuple(phase for phase in allowed if phase not in left)
        return self._touch(state, k, allowed, along)

    @staticmethod
    def _sliding(along: np.ndarray) -> Phase:
        if along.size > 1:
            return Phase.SLIDING
        return Phase.FORWARD if along[0] > 0 else Phase.BACKWARD

    def _undecided(
        self, t: float, state: ContactState, gaps, found: list[Solution], what: str
    ) -> str:
        """Why no pattern was the only one; friction is blamed where there is some."""
        names = ", ".join(dict.fromkeys(self.gaps[k].name for k in gaps))
        if not found and self.crowded:
            return f"so many gaps touch at t = {t:.9g} s that not all patterns are tried: {names}"
        many = f"{len(found)} motions" if found else "no motion"
        if any(state.rubs(k) for k in gaps):
            return (
                f"rigid {what} with friction has {many} at t = {t:.9g} s at {names} (Painlevé); "
                "lower the friction, or use a compliant contact"
            )
        return (
            f"rigid {what} has {many} at t = {t:.9g} s at {names}: drivers or joints leave nothing "
            "there to give way; free what they hold, or use a compliant contact"
        )
