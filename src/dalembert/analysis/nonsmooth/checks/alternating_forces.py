"""Warning about contact forces at rest that alternate from step to step.

A closed gap with a residual speed ``±c`` reverses it in every step, since a contact that does no
positive work can only reflect it. Its impulses are ``m (g h ± 2 c)`` in turns; their mean is exact.
"""

from __future__ import annotations

import numpy as np

from dalembert.results.nonsmooth_motion import ContactRecord

LAST = 8
"""Number of steps at the end that are examined, an even one."""
SHARE = 0.05
"""Amplitude relative to the mean of the largest force above which a warning is given [-]."""


def alternation_warnings(record: ContactRecord) -> list[str]:
    """Warning about a run whose contacts press in all of the last steps, with normal impulses
    ``P̄ ± A`` in turns and an amplitude ``A`` that is a large share of the largest mean."""
    count = record.loss.size
    if count < LAST or not np.allclose(np.diff(record.t[-LAST - 1 :]), record.t[-1] - record.t[-2]):
        return []
    first = np.searchsorted(record.step, count - LAST)
    keys, place = np.unique(record.key[first:], return_inverse=True)
    impulses = np.zeros((keys.size, LAST))
    np.add.at(impulses, (place, record.step[first:] - (count - LAST)), record.impulse[first:, 0])
    pressing = (impulses > 0).all(axis=1)
    if not pressing.any():
        return []
    impulses, keys = impulses[pressing], keys[pressing]
    mean = impulses.mean(axis=1)
    signs = np.where(np.arange(LAST) % 2, 1.0, -1.0)
    amplitude = impulses @ signs / LAST
    others = np.abs(impulses - mean[:, None] - amplitude[:, None] * signs).max(axis=1)
    alternates = np.abs(amplitude) > np.maximum(SHARE * mean.max(), 2 * others)
    if not alternates.any():
        return []
    worst = int(np.argmax(np.where(alternates, np.abs(amplitude), 0.0)))
    h, owner = record.t[-1] - record.t[-2], record.owner[first:][record.key[first:] == keys[worst]]
    low, high = np.sort((mean[worst] + amplitude[worst] * np.array([-1.0, 1.0])) / h)
    return [
        f"a contact force of {record.names[owner[0]]} alternates between {low:.3g} and "
        f"{high:.3g} N from step to step at the end, about a mean of {mean[worst] / h:.3g} N, "
        "which is exact; use a shorter step, or integrator=MoreauJean()"
    ]
