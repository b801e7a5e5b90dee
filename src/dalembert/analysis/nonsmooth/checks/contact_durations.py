"""Warning about compliant contacts whose durations have few steps."""

from __future__ import annotations

import numpy as np

from dalembert.results.nonsmooth_motion import ContactRecord

SHORT, ENOUGH = 5, 20
"""Steps in the duration of a contact: threshold for a warning, and recommendation."""
ERROR = 0.3
"""Error of the restitution times the squared number of steps, at most, for one body [-]."""
SHARE = 0.01
"""Work of short contacts, relative to the energy in the motion, that causes a warning [-]."""


def duration_warnings(record: ContactRecord, moved: float) -> list[str]:
    """Warning about a run with steps that are too long for its compliant contacts.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    """
    work, short = np.abs(record.work), record.fraction * SHORT > 1
    exchanged = float(work[short].sum())
    if not exchanged > SHARE * moved:
        return []
    fraction = float(np.average(record.fraction[short], weights=work[short]))
    worst = np.flatnonzero(short)[np.argmax(work[short])]
    owner, t = record.names[record.owner[worst]], record.t[record.step[worst] + 1]
    step = float(np.diff(record.t).max()) / fraction / ENOUGH
    return [
        f"compliant contacts that last {1 / fraction:.2g} steps, as of {owner} at t = {t:.9g} s, "
        f"exchange {exchanged:.3g} J, {exchanged / moved:.2g} times the energy that took part in "
        f"the motion; their restitution may be wrong by {min(1.0, ERROR * fraction**2):.1g}; use "
        f"step={step:.1g} or shorter"
    ]
