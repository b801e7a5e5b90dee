"""Search for switches of forces and laws in the steps of an adaptive run.

Steps are taken with the signs of all switching functions frozen. If a step ends beyond a switch,
the switch is located inside the step, the step is cut there, and the sign changes. A switch without
effect on the rate, such as that of a damper out of contact, changes at the end of the step.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.transition import SIMULTANEOUS, StepReplacement
from dalembert.analysis.events import locate
from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.coordinates import rate_of
from dalembert.formulations.base import state_symbols
from dalembert.integrators.marching.steps import Crossing
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.switches import freeze_branches

ROUNDING = 4 * float(np.finfo(float).eps)
RESTART = 1e-4
"""First step, relative to the run, of methods that lose their memory at a switch."""
HALVINGS = 50
"""Upper limit of the halvings of a step that begins at a switch."""
PARTS = np.arange(1, 8) / 8
"""Fractions of a step at which double crossings of a switch are searched."""
JUMPED = 1e4
"""Threshold for a jump of a switching function at its crossing, relative to its rounding."""
SIMULTANEOUS_CROSSINGS = 3
"""Upper limit of crossings of one switch at an instant that other switches may cause."""
MANY, SHORTLY = 100, 1e-7
"""Threshold for chattering: number of crossings, within a time relative to the run."""


REMEDY = "smooth it, for friction by tanh(speed/transition) or JointFriction"
SAME = 1e-9
"""Relative difference below which two switching functions are equal at a state."""


class SwitchSearch:
    """Search for crossed switches in one run.

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
        """Replacement of the first step that crosses a switch, once or back and forth."""
        length = times[-1] - times[-2] if times.size > 1 else RESTART * self.span
        if inside := self._inside(times, states, mode):
            k, part = inside
            length = times[k + 1] - times[k]
            state = self._state(mode, times[k], part, states[:, k])
            times = np.append(times[: k + 1], times[k] + part)
            states = np.column_stack([states[:, : k + 1], state])
        end, arrived, count = float(times[-1]), states[:, -1], times.size - 1
        beyond = self._beyond(end, arrived)
        if not beyond:
            return None
        effective = [k for k in beyond if self._is_effective(mode, k, end, arrived)]
        if not effective and self._hides_effective(mode, beyond, end, arrived):
            effective = beyond
        if not (effective and count):
            replacement = StepReplacement(end, arrived)
            self._turn(replacement, mode, beyond, moving=False)
            return replacement.crossing(count, length, self._chattering(mode, replacement, beyond))
        begin, x = float(times[-2]), states[:, -2]
        lengths = {k: self._locate(k, mode, begin, x, end - begin) for k in effective}
        first = min(lengths.values())
        simultaneous = [k for k in effective if lengths[k] <= first + ROUNDING * abs(begin)]
        replacement = StepReplacement(begin, x)
        if first > 0:
            replacement.add(first, self._state(mode, begin, first, x), mode)
        idle = [k for k in self._beyond(replacement.time, replacement.x) if k not in effective]
        self._turn(replacement, mode, idle, moving=False)
        for k in simultaneous:  # no instant moves at the start and where g jumps over zero
            moving = replacement.time > self.start and self._on_surface(k, replacement)
            self._turn(replacement, mode, [k], moving)
        if self.kernel.variants[mode].step.begin is not None:
            length = min(length, RESTART * self.span)
        return replacement.crossing(
            count - 1, length, self._chattering(mode, replacement, simultaneous)
        )

    def _inside(self, times: np.ndarray, states: np.ndarray, mode: int) -> tuple[int, float] | None:
        """First step, and a length in it, beyond an effective switch, by cubics of the steps."""
        count, size = times.size - 1, self.size
        if not count:
            return None
        c, p = PARTS, self.p[:, None]
        h = np.diff(times)[:, None]
        instants, between = self.kernel.between(times, states[:size], mode, self.p, c)
        crossed = self.kernel.over(self.kernel.crossed, instants.size)
        (beyond,) = crossed(instants, between, np.tile(p, instants.size))
        for column in np.flatnonzero((beyond[:, : count * c.size] > 0).any(axis=0)):
            k, part = divmod(int(column), c.size)
            length = float(h[k, 0] * c[part])
            state = self._state(mode, times[k], length, states[:, k])
            if any(
                self._is_effective(mode, j, instants[column], state)
                for j in self._beyond(instants[column], state)
            ):
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
        """Numbers of the switches beyond which a state lies."""
        margins = self._call(self.kernel.crossed, t, x[: self.size], self.p)
        return [int(k) for k in np.flatnonzero(margins > 0)]

    def _on_surface(self, k: int, replacement: StepReplacement) -> bool:
        """Whether a switching function is zero there and has not jumped."""
        where = (replacement.time, replacement.x[: self.size], self.p)
        distance = self._call(self.kernel.distances, *where)[k]
        near = -distance - self._call(self.kernel.crossed, *where)[k]
        return bool(abs(distance) <= JUMPED * near)

    def _is_effective(self, mode: int, k: int, t: float, x: np.ndarray) -> bool:
        """Whether the rate of the state depends on the sign of a switch."""
        state, flipped = x[: self.size], x[: self.size].copy()
        entry = self.size - self.count + k
        flipped[entry] = 1 - flipped[entry]
        rate = self.kernel.variants[mode].rate.function
        before, after = (self._call(rate, t, s, self.p) for s in (state, flipped))
        return not np.array_equal(before, after, equal_nan=True)

    def _hides_effective(self, mode: int, switches: list[int], t: float, x: np.ndarray) -> bool:
        """Whether the state lies beyond an effective switch after a change of these signs.

        This happens where these switches select a distance, such as those from the edges of a
        shape, and another switch compares the selected distance with zero.
        """
        state, visited = x.copy(), list(switches)
        while switches:
            entries = [self.size - self.count + k for k in switches]
            state[entries] = 1 - state[entries]
            switches = [k for k in self._beyond(t, state) if k not in visited]
            if any(self._is_effective(mode, k, t, state) for k in switches):
                return True
            visited += switches
        return False

    def _locate(self, k: int, mode: int, t: float, x: np.ndarray, longest: float) -> float:
        """Time from the beginning of a step to just beyond a switch [s]."""

        def distance(length: float) -> float:
            state = self._state(mode, t, length, x) if length else x
            where = (t + length, state[: self.size], self.p)
            return float(self._call(self.kernel.distances, *where)[k])

        inside = 0.0
        if distance(0.0) <= 0:  # the step begins at the switch
            candidates = (longest * 2.0**-k for k in range(1, HALVINGS))
            inside = next((length for length in candidates if distance(length) > 0), 0.0)
            if not inside:
                return 0.0
        length, increment = locate(distance, inside, longest), ROUNDING * max(longest, abs(t))
        while length < longest and distance(length) > 0:
            length, increment = min(length + increment, longest), 2 * increment
        return length

    # transitions ---------------------------------------------------------------------------
    def _turn(
        self, replacement: StepReplacement, mode: int, switches: list[int], moving: bool
    ) -> None:
        """Add transitions of switches at the current instant."""
        for k in switches:
            transition = self.kernel.transition(mode, k, moving)
            replacement.add(
                0.0, self._state(transition, replacement.time, 0.0, replacement.x), transition
            )
            self.crossings.append((replacement.time, k))

    def _chattering(self, mode: int, replacement: StepReplacement, switches: list[int]) -> str:
        """Message if the crossed switches chatter, else empty."""
        elapsed = replacement.time - np.array([t for t, _ in self.crossings])
        simultaneous = [
            k
            for (_, k), ago in zip(self.crossings, elapsed, strict=True)
            if ago <= SIMULTANEOUS * self.span
        ]
        stuck = [k for k in switches if simultaneous.count(k) > SIMULTANEOUS_CROSSINGS]
        count = int(np.sum(elapsed <= SHORTLY * self.span))
        if not stuck and count <= MANY:
            return ""
        at = (replacement.time, replacement.x[: self.size], self.p)
        owner = owner_of(self.kernel, mode, (stuck or switches)[0], *at)
        self.trouble = f"{owner} switches back and forth at t = {replacement.time:.9g} s: " + (
            "on both sides it drives the motion back across, so no motion continues; "
            if stuck
            else f"{count} times within {SHORTLY * self.span:.2g} s; "
        )
        self.trouble += REMEDY
        return self.trouble


def owner_of(kernel: DynamicsKernel, mode: int, number: int, t: float, x: np.ndarray, p) -> str:
    """Names of the elements whose switching functions have the value of this one at a state."""
    model = kernel.model
    distance = float(kernel.distances(t, x, p)[number])
    y, v, *_ = kernel.variants[mode].bodies(t, x, p)
    names = []
    for element in [*model.forces, *model.constraints]:
        values = np.abs(_values(model, element, t, y, v, p))
        if np.any(np.abs(values - abs(distance)) <= SAME * np.maximum(values, SAME)):
            names.append(element.name)
    return f"the force of {', '.join(names)}" if names else "a force"


def _values(model: Model, element: Element, t, y, v, p) -> np.ndarray:
    """The switching functions of one element."""
    e = model.all_equations
    if isinstance(element, ForceElement):
        owners = element.parts() or model.coordinates
        powers = element.powers(lambda s: rate_of(s, owners, e.t))
        formulas = [model.at_ground(effort) for _, effort in powers]
    else:
        formulas = [model.at_ground(element.equations)] if isinstance(element, Constraint) else []
    _, switches = freeze_branches(formulas, ca.vertcat(e.t, e.y, e.v))
    g = ca.substitute(switches.functions, switches.sides, switches.actual)
    return ca.Function("g", [e.t, e.y, e.v, e.p], [g])(t, y, v, p).full().ravel()
