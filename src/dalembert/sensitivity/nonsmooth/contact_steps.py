"""The steps of a run with contacts, taken again one by one as maps that are known to be smooth."""

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
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.integrators.contact.schemes import MoreauJean
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps, Pattern, Rubbing
from dalembert.sensitivity.nonsmooth.implicit_map import MapAt
from dalembert.symbolic.equations import newton

STUCK = 1e-6
"""Share of the friction that is left over by what sticks."""
SAME = 1e-6
"""Difference of a state from the one that was recorded, by its size."""


class ContactSteps:
    """All steps of a run.

    Parameters
    ----------
    motion : NonsmoothMotion

    Raises
    ------
    UnsupportedError
        Another scheme than that of Moreau and Jean.
    """

    def __init__(self, motion: NonsmoothMotion):
        analysis: Any = motion.analysis
        if not isinstance(analysis.integrator, MoreauJean):
            raise UnsupportedError(
                f"{type(analysis.integrator).__name__} chooses what contacts ask for by "
                "comparisons that are not differentiated; give integrator=da.MoreauJean(), or use "
                "solve_dynamics, which locates impacts"
            )
        self.record, self.p = motion.record, motion.parameters
        run = analysis.execution(analysis, motion.model, motion.parameters)
        self.step: ContactStep = run.step
        self.maps = ContactMaps(self.step)
        self.x = np.vstack([self.record.ends.y, self.record.ends.v])
        self.size = self.record.ends.y.shape[0]

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.record.t.size - 1

    @cached_property
    def patterns(self) -> list[dict[int, tuple[Rubbing, np.ndarray]]]:
        """Gaps that press in each step, how they rub, and their impulses."""
        found: list[dict] = [{} for _ in range(self.count)]
        for k, key, impulse in zip(
            self.record.step, self.record.key, self.record.impulse, strict=True
        ):
            state = self.split(int(k))
            _, speeds, *_, friction = self.maps.gap(int(key))(self.record.t[k], *state, self.p)
            own = impulse[: speeds.numel()]
            limit, along = float(friction) * own[0], float(np.linalg.norm(own[1:]))
            rubs = Rubbing.NOT if limit == 0 or own.size == 1 else Rubbing.SLIPS
            if along < (1 - STUCK) * limit:
                rubs = Rubbing.STICKS
            found[int(k)][int(key)] = rubs, own
        return found

    def split(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """``y`` and ``v`` where a step begins."""
        return self.x[: self.size, k], self.x[self.size :, k]

    def span(self, k: int) -> tuple[float, float]:
        """Instant and length of a step."""
        t = self.record.t
        return float(t[k]), float(t[k + 1] - t[k])

    def at(self, k: int) -> list[MapAt]:
        """The maps that make the k-th step, one after the other.

        Raises
        ------
        AnalysisError
            They lead somewhere else than it did.
        """
        maps = self._maps(k)
        end, wanted = maps[-1].following, self.x[:, k + 1]
        scale = np.abs(self.x[:, k : k + 2]).max(initial=0.0) + self.step.model.scales.length
        if not np.abs(end - wanted).max(initial=0.0) <= SAME * scale:
            raise AnalysisError(
                f"the step at t = {self.record.t[k]:.9g} s cannot be repeated as a smooth map; "
                "give ContactSolver a smaller tolerance"
            )
        return maps

    def _maps(self, k: int) -> list[MapAt]:
        (t, h), pattern = self.span(k), self.patterns[k]
        maps = [self.free(k, pattern, self.x[:, k], t, h)]
        place = Followed(self.step, t + h, self.step.scheme.projection)
        newton.solve(place, maps[0].following[: self.size], SETTINGS)
        for held in place.taken:
            opening = self.maps.opening(tuple((key, key in pattern) for key in held))
            lifts, x = np.array(list(held.values())), maps[-1].following
            maps.append(opening.at(np.zeros(opening.size), x, t + h, self.p, lifts))
        if self.step.smooth.has_joints:
            joined, x = self.maps.consistent, maps[-1].following
            maps.append(joined.at(np.zeros(joined.size), x, t + h, self.p, np.zeros(0)))
        return maps

    def free(self, k: int, pattern: dict, x: np.ndarray, t: float, h: float) -> MapAt:
        """A step with some contacts and nothing corrected, from any state."""
        chosen: Pattern = tuple((key, rubs) for key, (rubs, _) in sorted(pattern.items()))
        step, joints = self.maps.step(chosen), self.step.model.equations.constraint_count
        impulses = [pattern[key][1] for key, _ in chosen]
        near = self.x[self.size :, k + 1]
        z = np.concatenate([near, np.zeros(joints), *impulses])
        return step.at(z, x, t, self.p, np.array([h]))


class Followed(PositionCorrection):
    """Opening of positions that remembers its steps.

    Attributes
    ----------
    taken : gaps that were held open, by key, and how far they were closed, step by step
    """

    def __init__(self, step: ContactStep, t: float, open_gaps: bool):
        super().__init__(step, t, open_gaps)
        self.taken: list[dict[int, float]] = []

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, PositionResidual)
        found, gaps = self.shift(x, residual)
        held: dict[int, float] = {}
        if gaps is not None:
            left = np.abs(gaps.distance + normals_of(gaps) @ found)
            for n in np.flatnonzero(left <= SAME * -gaps.distance.min()):
                held[int(gaps.key[n])] = float(gaps.distance[n])
        self.taken.append(held)
        return found
