"""Steps of a nonsmooth run, repeated as smooth maps with known contact states."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import (
    SETTINGS,
    PositionCorrection,
    PositionResidual,
    normals_of,
)
from dalembert.analysis.nonsmooth.nonsmooth_run import NonsmoothRun
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.integrators.contact.schemes import MoreauJean
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps, Friction, Pattern
from dalembert.sensitivity.nonsmooth.implicit_map import MapAt
from dalembert.symbolic.equations import newton

STICK_MARGIN = 1e-6
"""Friction reserve of a sticking contact, relative to the friction limit [-]."""
SAME = 1e-6
"""Permitted difference of a repeated state from the recorded one, relative to its size [-]."""


class ContactSteps:
    """All steps of a run.

    Parameters
    ----------
    motion : NonsmoothMotion

    Raises
    ------
    UnsupportedError
        The integrator is not ``MoreauJean``, or the law of impact not Newton's.
    """

    def __init__(self, motion: NonsmoothMotion):
        analysis: Any = motion.analysis
        if not isinstance(analysis.integrator, MoreauJean):
            raise UnsupportedError(
                f"{type(analysis.integrator).__name__} selects contact velocities by "
                "comparisons that are not differentiable; use integrator=da.MoreauJean(), or "
                "solve_dynamics, which locates impacts"
            )
        self.record, self.p = motion.record, motion.parameters
        run = NonsmoothRun(analysis, motion.model, motion.parameters)
        self.step: ContactStep = run.step
        if self.step.law is not ImpactLaw.NEWTON:
            raise UnsupportedError(
                f"gradients of impacts by the {self.step.law.value} law are not available in "
                "solve_nonsmooth; use Newton's law, or solve_dynamics"
            )
        self.maps = ContactMaps(self.step)
        self.x = np.vstack([self.record.ends.y, self.record.ends.v])
        self.size = self.record.ends.y.shape[0]

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.record.t.size - 1

    @cached_property
    def patterns(self) -> list[dict[int, tuple[tuple[Friction, ...], np.ndarray]]]:
        """Pressing gaps of each step with their tangential states and impulses.

        Raises
        ------
        UnsupportedError
            A contact with static friction breaks away.
        """
        patterns: list[dict] = [{} for _ in range(self.count)]
        for k, key, impulse in zip(
            self.record.step, self.record.key, self.record.impulse, strict=True
        ):
            state = self.split(int(k))
            _, speeds, *_, static, friction = self.maps.gap(int(key))(
                self.record.t[k], *state, self.p
            )
            own = impulse[: speeds.numel()]
            limits = friction.full().ravel() * own[0]
            discs = zip(self.maps.groups(int(key)), limits, strict=True)
            states = tuple(_state(own[components], limit) for components, limit in discs)
            patterns[int(k)][int(key)] = states, own
            before, _ = patterns[k - 1].get(int(key), (states, own)) if k else (states, own)
            slips = states[:1] == (Friction.SLIP,) and before[0] is Friction.STICK
            if slips and float(static) > float(friction[0]):
                raise UnsupportedError(
                    f"a contact with static friction breaks away at t = {self.record.t[k]:.9g} s, "
                    "and gradients do not include the change of this instant; give "
                    "static_friction equal to friction"
                )
        return patterns

    def split(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """``y`` and ``v`` at the start of step ``k``."""
        return self.x[: self.size, k], self.x[self.size :, k]

    def span(self, k: int) -> tuple[float, float]:
        """Start time and length of step ``k``."""
        t = self.record.t
        return float(t[k]), float(t[k + 1] - t[k])

    def at(self, k: int) -> list[MapAt]:
        """Sequence of maps of step ``k``.

        Raises
        ------
        AnalysisError
            The maps do not reproduce the recorded step.
        """
        maps = self._maps(k)
        end, recorded = maps[-1].following, self.x[:, k + 1]
        scale = np.abs(self.x[:, k : k + 2]).max(initial=0.0) + self.step.model.scales.length
        if not np.abs(end - recorded).max(initial=0.0) <= SAME * scale:
            raise AnalysisError(
                f"the step at t = {self.record.t[k]:.9g} s cannot be repeated as a smooth map; "
                "give ContactSolver a smaller tolerance"
            )
        return maps

    def _maps(self, k: int) -> list[MapAt]:
        (t, h), pattern = self.span(k), self.patterns[k]
        maps = [self.free(k, pattern, self.x[:, k], t, h)]
        recorder = RecordedOpening(self.step, t + h, self.step.scheme.projection)
        newton.solve(recorder, maps[0].following[: self.size], SETTINGS)
        for active in recorder.active:
            opening = self.maps.opening(tuple((key, key in pattern) for key in active))
            lifts, x = np.array(list(active.values())), maps[-1].following
            maps.append(opening.at(np.zeros(opening.size), x, t + h, self.p, lifts))
        if self.step.smooth.has_joints:
            joined, x = self.maps.consistent, maps[-1].following
            maps.append(joined.at(np.zeros(joined.size), x, t + h, self.p, np.zeros(0)))
        return maps

    def free(self, k: int, pattern: dict, x: np.ndarray, t: float, h: float) -> MapAt:
        """A step with some contacts and without corrections, from any state."""
        chosen: Pattern = tuple((key, state) for key, (state, _) in sorted(pattern.items()))
        step, joints = self.maps.step(chosen), self.step.model.equations.constraint_count
        impulses = [pattern[key][1] for key, _ in chosen]
        near = self.x[self.size :, k + 1]
        z = np.concatenate([near, np.zeros(joints), *impulses])
        return step.at(z, x, t, self.p, np.array([h]))


def _state(impulse: np.ndarray, limit: float) -> Friction:
    """State of the components of a group, from its impulse and the friction limit."""
    if limit == 0:
        return Friction.NONE
    slips = abs(float(np.linalg.norm(impulse)) - limit) <= STICK_MARGIN * limit
    return Friction.SLIP if slips else Friction.STICK  # above the limit by static friction


class RecordedOpening(PositionCorrection):
    """Position correction that records its active gaps.

    Attributes
    ----------
    active : for each iteration, key of the active gaps → distance
    """

    def __init__(self, step: ContactStep, t: float, open_gaps: bool):
        super().__init__(step, t, open_gaps)
        self.active: list[dict[int, float]] = []

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, PositionResidual)
        shift, gaps = self.shift(x, residual)
        active: dict[int, float] = {}
        if gaps is not None:
            remainder = np.abs(gaps.distance + normals_of(gaps) @ shift)
            for n in np.flatnonzero(remainder <= SAME * -gaps.distance.min()):
                active[int(gaps.key[n])] = float(gaps.distance[n])
        self.active.append(active)
        return shift
