"""Warning about contacts that give energy to the bodies.

Newton's law of impact does so where friction ends or reverses a slip (Kane's paradox), if the
scheme does not prevent it.
"""

from __future__ import annotations

import numpy as np

from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.02
"""Energy given by contacts, relative to the energy in the motion, that causes a warning [-]."""


def gain_warnings(record: ContactRecord, moved: float) -> list[str]:
    """Warning about a run in which contacts gave much energy to the bodies.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    """
    gains = np.maximum(-record.loss, 0.0)
    total = float(gains.sum())
    if not total > SHARE * moved:
        return []
    t = record.t[int(np.argmax(gains))]
    return [
        f"contacts gave {total:.3g} J to the bodies, most of it in the step at t = {t:.9g} s, "
        f"where {moved:.3g} J took part in the motion: impacts with friction by Newton's law may "
        "do so; use impact_law='energetic', or integrator=AnticipatedImpacts()"
    ]
