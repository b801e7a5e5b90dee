"""Warning about corrections of positions that lift bodies.

A scheme that opens gaps after a step adds the work of its corrections: after an impact in the
second half of a step, and in every step of a body that turns about a corner, which then falls
behind its motion.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction_work import CorrectionWork
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.02
"""Work of corrections, relative to the energy in the motion, that causes a warning [-]."""
GROWTH = 1e-10
"""Growth of the energy in one step, relative to that in the motion and to the natural one, that
causes a warning; for a scheme that needs corrections in the first step only, ``SHARE`` applies
[-]."""


def least_growth(step: ContactStep, moved: float) -> float:
    """Growth of the energy in one step that causes a warning [J]."""
    return GROWTH * max(moved, step.model.scales.energy)


def lifting_warnings(
    corrections: CorrectionWork, record: ContactRecord, moved: float, starts_open: bool
) -> list[str]:
    """Warning about a run in which corrections of positions let the energy grow, or did much work.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    starts_open : whether the first correction opens no gap of the start
    """
    scheme, grown = corrections.step.scheme, np.zeros(record.loss.size)
    if not scheme.anticipates:
        grown = corrections.growth(record.loss, least_growth(corrections.step, moved))
        grown[:1] *= starts_open
    much = starts_open and abs(corrections.total) > SHARE * moved
    if not (much or grown.any()):
        return []
    count, t = np.count_nonzero(grown), record.t[int(np.argmax(grown))]
    steps = f"{count} steps" if count > 1 else "one step"
    growth = f", and let the energy grow by {grown.sum():.3g} J in {steps}"
    most = f", most of it in that at t = {t:.9g} s" if count > 1 else f", at t = {t:.9g} s"
    other = "" if scheme.anticipates else ", or integrator=AnticipatedImpacts()"
    return [
        f"corrections of positions, which lift bodies, did {corrections.total:.3g} J of work, "
        f"where {moved:.3g} J took part in the motion{(growth + most) * bool(count)}; use a "
        f"shorter step{other}"
    ]
