"""Pressing contacts of a step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

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
    """

    keys: np.ndarray
    impulses: np.ndarray
    offsets: np.ndarray
    curved: np.ndarray
    kept: np.ndarray
    longest: np.ndarray

    @classmethod
    def of(cls, result: StepResult) -> ActiveContacts:
        """Pressing contacts of a result, with the impulses after impacts at the start."""
        impulses, keys = result.impulses.impulses, result.contacts.key
        rows = np.flatnonzero(impulses[:, 0] > 0)
        rows = rows[np.argsort(keys[rows])]
        curved, impulses = np.isin(keys[rows], result.curved), impulses[rows]
        if result.impact is not None:
            stage, place = result.impact, {int(key): i for i, key in enumerate(keys[rows])}
            for key, own in zip(stage.contacts.key, stage.impulses.impulses, strict=True):
                if (i := place.get(int(key))) is not None:
                    rest = impulses[i] - own
                    impulses[i] = np.where(abs(rest) > ROUNDING * abs(impulses[i]), rest, 0.0)
        kept = result.contacts.kept_mask[rows]
        longest = np.full(rows.size, result.longest)
        return cls(keys[rows], impulses, result.offsets[rows], curved, kept, longest)

    def some(self, selected: np.ndarray) -> ActiveContacts:
        """The selected contacts."""
        fields = self.keys, self.impulses, self.offsets, self.curved, self.kept, self.longest
        return ActiveContacts(*(field[selected] for field in fields))

    def pressing(self, impulses: np.ndarray) -> ActiveContacts:
        """The same contacts with other impulses."""
        return replace(self, impulses=impulses.reshape(self.impulses.shape))
