"""Pressing contacts of a step, and the solutions on whose paths a step has means of gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dalembert.analysis.nonsmooth.impact_stage import ImpactStage
from dalembert.analysis.nonsmooth.step_state import StepResult

ROUNDING = 1e-13
"""Rounding error of the impulses after impacts, relative to the sums [-]."""


@dataclass(frozen=True, eq=False)
class ActiveContacts:
    """Pressing contacts, in the order of their keys.

    Attributes
    ----------
    keys : (n,)
    impulses, offsets : (n, k)
    curved : (n,) mask of means over the path of the step
    kept : (n,) mask of directions at the start of the step
    longest : (n,) longest step that might follow [s]
    limits : (n, d) directions of slip of the contacts at the limit of static friction, zero for
        others; None without any
    """

    keys: np.ndarray
    impulses: np.ndarray
    offsets: np.ndarray
    curved: np.ndarray
    kept: np.ndarray
    longest: np.ndarray
    limits: np.ndarray | None = None

    @classmethod
    def of(cls, result: StepResult) -> ActiveContacts:
        """Pressing contacts of a result, without the impulses of impacts at the start."""
        impulses, keys = result.impulses.impulses, result.contacts.key
        rows = np.flatnonzero(impulses[:, 0] > 0)
        rows = rows[np.argsort(keys[rows])]
        curved, kept = np.isin(keys[rows], result.curved), result.contacts.kept_mask[rows]
        longest = np.full(rows.size, result.longest)
        own = cls(keys[rows], impulses[rows], result.offsets[rows], curved, kept, longest)
        return own.after(result.impact)

    def after(self, impact: ImpactStage | None) -> ActiveContacts:
        """The same contacts without the impulses of impacts at the start of the step."""
        if impact is None:
            return self
        impulses, place = self.impulses.copy(), {int(key): i for i, key in enumerate(self.keys)}
        for key, own in zip(impact.contacts.key, impact.impulses.impulses, strict=True):
            if (i := place.get(int(key))) is not None:
                rest = impulses[i] - own
                impulses[i] = np.where(abs(rest) > ROUNDING * abs(impulses[i]), rest, 0.0)
        return replace(self, impulses=impulses)

    @property
    def at_limit(self) -> np.ndarray:
        """(n,) mask of the contacts at the limit of static friction."""
        if self.limits is None:
            return np.zeros(self.keys.size, dtype=bool)
        return np.asarray(self.limits.any(axis=1))

    def some(self, selected: np.ndarray) -> ActiveContacts:
        """The selected contacts."""
        fields = self.keys, self.impulses, self.offsets, self.curved, self.kept, self.longest
        limits = None if self.limits is None else self.limits[selected]
        return replace(ActiveContacts(*(field[selected] for field in fields)), limits=limits)

    def pressing(self, impulses: np.ndarray) -> ActiveContacts:
        """The same contacts with other impulses."""
        return replace(self, impulses=impulses.reshape(self.impulses.shape))


@dataclass(frozen=True, eq=False)
class PathSolution:
    """Solution of a step on whose path the next one of the same step has means of gaps.

    Attributes
    ----------
    v : (n_v,) speeds at the end
    active : the pressing contacts
    curved : keys of all contacts with means over the path of the solution before
    impact : impacts at the start; None without any
    """

    v: np.ndarray
    active: ActiveContacts
    curved: np.ndarray
    impact: ImpactStage | None = None


@dataclass(frozen=True, eq=False)
class StepPath:
    """Solutions of a step before the last one.

    Attributes
    ----------
    curved : keys of the contacts of the last solution with means over the path of the one before
    solutions : those before, each on the path of the one before
    """

    curved: np.ndarray
    solutions: Sequence[PathSolution]

    @classmethod
    def of(cls, result: StepResult) -> StepPath:
        """The path of the result of a step."""
        solutions, path = [], result.path
        while path is not None:
            solutions.append(
                PathSolution(path.v, ActiveContacts.of(path), path.curved, path.impact)
            )
            path = path.path
        return cls(result.curved, solutions[::-1])


NO_PATH = StepPath(np.zeros(0, dtype=int), [])
"""The path of a step with a single solution."""
