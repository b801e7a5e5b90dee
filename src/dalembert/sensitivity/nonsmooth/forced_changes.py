"""Gaps with the largest changes of normal speeds by forces in steps, without impulses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.advance import AHEAD
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.paths import path_means
from dalembert.errors import AnalysisError
from dalembert.integrators.contact.contacts import Contacts, among

SAME = 1e-8
"""Tolerance of an offset that depends on the change, relative to it [-]."""


@dataclass(frozen=True, eq=False)
class ForcedSteps:
    """Steps with offsets that depend on the largest change of a normal speed by forces.

    Attributes
    ----------
    x : (n_x, K) states at the starts
    t, h : (K,) starts and lengths
    means : keys of the contacts with means over the path of a single step, and the speeds at the
        end of this path
    changes, slopes : the change of each of these contacts of a step as its offset states it, and
        the derivative of the offset by it
    """

    x: np.ndarray
    t: np.ndarray
    h: np.ndarray
    changes: list[np.ndarray]
    slopes: list[np.ndarray]
    means: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.t.size

    def largest(self, step: ContactStep, free: np.ndarray) -> tuple[np.ndarray, ...]:
        """(K,) keys of the gaps with the largest changes for speeds ``free`` (n_v, K) at the ends,
        signs of the changes, and masks of the gaps with directions at the starts and with means.

        Raises
        ------
        AnalysisError
            An offset states another change.
        """
        gaps = [self._largest(step, k, column) for k, column in enumerate(free.T)]
        keys, signs, kept, means = (np.array(values) for values in zip(*gaps, strict=True))
        return keys, signs, kept, means

    def _largest(
        self, step: ContactStep, k: int, free: np.ndarray
    ) -> tuple[int, float, bool, bool]:
        """Key and sign of step ``k``, and whether its gap is of the masks of ``largest``."""
        y, v = np.split(self.x[:, k], [self.x.shape[0] - free.size])
        t, h = float(self.t[k]), float(self.h[k])
        near = step.near(step.at(t, y), AHEAD * h * np.column_stack([v, free]))
        start = step.begin(t, h, y, v, False)
        contacts = step.in_middle(start, near)
        curved = np.zeros(0, dtype=int)
        if self.means is not None:
            curved, after = self.means
            path = path_means(step, start, step.starting(start, curved), after)
            contacts = Contacts.joined([contacts.some(~among(contacts.key, curved)), path])
        changes = (contacts.at_end(free) - contacts.at_start(v))[:, 0]
        row = int(np.argmax(np.abs(changes)))
        largest = abs(changes[row])
        errors = self.slopes[k] * np.abs(self.changes[k] - largest)
        if not errors.max(initial=0.0) <= SAME * largest:
            raise AnalysisError(
                f"the speed of a contact in the step at t = {t:.9g} s follows no branch of "
                f"{type(step.scheme).__name__} with a derivative; use integrator=da.MoreauJean()"
            )
        key, sign = int(contacts.key[row]), float(np.sign(changes[row]))
        return key, sign, bool(contacts.kept_mask[row]), bool(np.isin(key, curved))
