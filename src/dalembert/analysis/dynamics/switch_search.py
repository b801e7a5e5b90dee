"""Switches of forces and laws, located in the steps of an adaptive run, which starts anew there.

Steps are taken with all switches held on their sides. Where the end of a step lies beyond a switch,
the switch is located inside, the step cut there, and the switch goes over to its other side. One
whose sides make no difference, such as that of a damper out of contact, goes over at the end.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.passage import NOW, Passage
from dalembert.analysis.dynamics.switch_owners import owner_of
from dalembert.analysis.events import locate
from dalembert.formulations.base import state_symbols
from dalembert.integrators.marching.steps import Crossing
from dalembert.symbolic.evaluation.kernel import Kernel

ROUNDING = 4 * float(np.finfo(float).eps)
RESTART = 1e-4
"""First step, relative to the run, of methods that lose their memory at a switch."""
HALVINGS = 50
"""Of a step that begins at a switch, in search of its first part."""
PARTS = np.arange(1, 8) / 8
"""Of a step, where it is looked for a switch that it goes across and back."""
JUMPED = 1e4
"""Distance behind a located switch, in those that count as none, to which it has jumped."""
AT_ONCE = 3
"""Crossings of one switch at an instant that others may bring about, on whose sides it depends."""
MANY, SHORTLY = 100, 1e-7
"""Crossings in a time, relative to the run, that are recognised as chattering."""


CURE = "smooth it, for friction by tanh(speed/transition) or JointFriction"


class SwitchSearch:
    """Looks for crossed switches in one run.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    p : (np,) parameters
    start, end : of the run [s]
    """

    def __init__(self, kernel: DynamicsKernel, p: np.ndarray, start: float, end: float):
        self.kernel, self.p, self.start, self.span = kernel, p, start, end - start
        self.count = kernel.equations.switches.count
        self.size = state_symbols(kernel.equations).numel()
        self.crossings: list[tuple[float, int]] = []
        self.trouble = ""
        self._kernels: dict[ca.Function, Kernel] = {}

    def cross(self, times: np.ndarray, states: np.ndarray, mode: int) -> Crossing | None:
        """What is put in place of the first step that went across a switch, to stay or and back."""
        length = times[-1] - times[-2] if times.size > 1 else RESTART * self.span
        if inside := self._inside(times, states, mode):
            k, part = inside
            length = times[k + 1] - times[k]
            there = self._state(mode, times[k], part, states[:, k])
            times = np.append(times[: k + 1], times[k] + part)
            states = np.column_stack([states[:, : k + 1], there])
        end, arrived, kept = float(times[-1]), states[:, -1], times.size - 1
        beyond = self._beyond(end, arrived)
        if not beyond:
            return None
        acting = [k for k in beyond if self._acts(mode, k, end, arrived)]
        if not acting and self._hides(mode, beyond, end, arrived):
            acting = beyond
        if not (acting and kept):
            passage = Passage(end, arrived)
            self._turn(passage, mode, beyond, moving=False)
            return passage.crossing(kept, length, self._chattering(mode, passage, beyond))
        begin, x = float(times[-2]), states[:, -2]
        found = {k: self._locate(k, mode, begin, x, end - begin) for k in acting}
        first = min(found.values())
        together = [k for k in acting if found[k] <= first + ROUNDING * abs(begin)]
        passage = Passage(begin, x)
        if first > 0:
            passage.add(first, self._state(mode, begin, first, x), mode)
        idle = [k for k in self._beyond(passage.time, passage.x) if k not in acting]
        self._turn(passage, mode, idle, moving=False)
        for k in together:  # at the start, and where g jumps over zero, no instant moves
            moving = passage.time > self.start and self._on_surface(k, passage)
            self._turn(passage, mode, [k], moving)
        if self.kernel.variants[mode].step.begin is not None:
            length = min(length, RESTART * self.span)
        return passage.crossing(kept - 1, length, self._chattering(mode, passage, together))

    def _inside(self, times: np.ndarray, states: np.ndarray, mode: int) -> tuple[int, float] | None:
        """First step and part of it that ends beyond a switch that acts, by cubics of the steps."""
        count, size = times.size - 1, self.size
        if not count:
            return None
        c, p = PARTS, self.p[:, None]
        h = np.diff(times)[:, None]
        at, between = self.kernel.between(times, states[:size], mode, self.p, c)
        looked = self.kernel.over(self.kernel.crossed, at.size)
        (beyond,) = looked(at, between, np.tile(p, at.size))
        for place in np.flatnonzero((beyond[:, : count * c.size] > 0).any(axis=0)):
            k, part = divmod(int(place), c.size)
            length = float(h[k, 0] * c[part])
            there = self._state(mode, times[k], length, states[:, k])
            if any(self._acts(mode, j, at[place], there) for j in self._beyond(at[place], there)):
                return k, length
        return None

    # the motion ---------------------------------------------------------------------------
    def _call(self, function: ca.Function, *arguments) -> np.ndarray:
        if function not in self._kernels:
            self._kernels[function] = Kernel(function)
        return self._kernels[function](*arguments)[0].ravel()

    def _state(self, mode: int, t: float, h: float, x: np.ndarray) -> np.ndarray:
        return self._call(self.kernel.variants[mode].step.function, t, h, x, self.p)

    def _beyond(self, t: float, x: np.ndarray) -> list[int]:
        """Switches beyond which a state lies."""
        margins = self._call(self.kernel.crossed, t, x[: self.size], self.p)
        return [int(k) for k in np.flatnonzero(margins > 0)]

    def _on_surface(self, k: int, passage: Passage) -> bool:
        """Whether a switching function is zero there, and has not jumped over it."""
        where = (passage.time, passage.x[: self.size], self.p)
        distance = self._call(self.kernel.distances, *where)[k]
        near = -distance - self._call(self.kernel.crossed, *where)[k]
        return bool(abs(distance) <= JUMPED * near)

    def _acts(self, mode: int, k: int, t: float, x: np.ndarray) -> bool:
        """Whether the sides of a switch differ in what the state does."""
        state, other = x[: self.size], x[: self.size].copy()
        place = self.size - self.count + k
        other[place] = 1 - other[place]
        rate = self.kernel.variants[mode].rate.function
        before, after = (self._call(rate, t, s, self.p) for s in (state, other))
        return not np.array_equal(before, after, equal_nan=True)

    def _hides(self, mode: int, switches: list[int], t: float, x: np.ndarray) -> bool:
        """Whether a state is beyond one that acts, too, once it is on the sides of these.

        So it is where these choose between distances, such as those from the edges of a shape, and
        another one asks whether the distance chosen is gone.
        """
        state, known = x.copy(), list(switches)
        while switches:
            places = [self.size - self.count + k for k in switches]
            state[places] = 1 - state[places]
            switches = [k for k in self._beyond(t, state) if k not in known]
            if any(self._acts(mode, k, t, state) for k in switches):
                return True
            known += switches
        return False

    def _locate(self, k: int, mode: int, t: float, x: np.ndarray, longest: float) -> float:
        """Time from the beginning of a step across a switch until just beyond it."""

        def distance(length: float) -> float:
            state = self._state(mode, t, length, x) if length else x
            where = (t + length, state[: self.size], self.p)
            return float(self._call(self.kernel.distances, *where)[k])

        inside = 0.0
        if distance(0.0) <= 0:  # from the switch itself, into its side first or out at once
            tried = (longest * 2.0**-k for k in range(1, HALVINGS))
            inside = next((length for length in tried if distance(length) > 0), 0.0)
            if not inside:
                return 0.0
        length, more = locate(distance, inside, longest), ROUNDING * max(longest, abs(t))
        while length < longest and distance(length) > 0:
            length, more = min(length + more, longest), 2 * more
        return length

    # going over ---------------------------------------------------------------------------
    def _turn(self, passage: Passage, mode: int, switches: list[int], moving: bool) -> None:
        """Let switches go over to their other sides, here and now."""
        for k in switches:
            made = self.kernel.transition(mode, k, moving)
            passage.add(0.0, self._state(made, passage.time, 0.0, passage.x), made)
            self.crossings.append((passage.time, k))

    def _chattering(self, mode: int, passage: Passage, switches: list[int]) -> str:
        """Why no motion goes on from switches just crossed, or nothing."""
        passed = passage.time - np.array([t for t, _ in self.crossings])
        now = [
            k for (_, k), ago in zip(self.crossings, passed, strict=True) if ago <= NOW * self.span
        ]
        stuck = [k for k in switches if now.count(k) > AT_ONCE]
        often = int(np.sum(passed <= SHORTLY * self.span))
        if not stuck and often <= MANY:
            return ""
        place = (passage.time, passage.x[: self.size], self.p)
        where = owner_of(self.kernel, mode, (stuck or switches)[0], *place)
        self.trouble = f"{where} switches back and forth at t = {passage.time:.9g} s: " + (
            "on both sides it drives the motion back across, so that none goes on; "
            if stuck
            else f"{often} times within {SHORTLY * self.span:.2g} s; "
        )
        self.trouble += CURE
        return self.trouble
