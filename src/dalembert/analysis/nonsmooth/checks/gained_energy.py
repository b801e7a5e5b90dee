"""Warning about contacts that give energy to the bodies.

Newton's law of impact does so where friction ends or reverses a slip (Kane's paradox), if the
scheme does not prevent it. Friction whose direction turns with a body that tips over an edge does
work of the order of the squared step. Impulses within their tolerance may do so by rounding.
"""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.checks.lifted_bodies import least_growth
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.02
"""Energy given by contacts, relative to the energy in the motion, that causes a warning where the
scheme prevents Kane's paradox, and with force laws, whose work has an error of the step [-]."""
INEXACT = 2.0
"""Upper limit of the work of inexact impulses, relative to their residual times their sum [-]."""


def gain_warnings(step: ContactStep, record: ContactRecord, moved: float) -> list[str]:
    """Warning about a run in which contacts gave energy to the bodies.

    Parameters
    ----------
    moved : energy that took part in the motion [J]
    """
    gains = np.maximum(-record.loss, 0.0)
    limit = SHARE * moved
    if not (step.scheme.anticipates or step.force_laws.elements):
        gains[gains <= least_growth(step, moved)] = 0.0
        limit = 0.0
    total = float(gains.sum())
    if not total > limit:
        return []
    k = int(np.argmax(gains))
    pushes = np.bincount(record.step, np.abs(record.impulse).sum(axis=1), gains.size)
    cause = (
        "impacts with friction by Newton's law may do so, and friction of bodies that tip or roll "
        "over their edges, less in shorter steps; use impact_law='energetic', or "
        "integrator=AnticipatedImpacts()"
    )
    if (gains <= INEXACT * record.residual * pushes).all():
        cause = "their impulses are within the tolerance only; give ContactSolver a smaller one"
    return [
        f"contacts gave {total:.3g} J to the bodies, most of it in the step at t = "
        f"{record.t[k]:.9g} s, where {moved:.3g} J took part in the motion: {cause}"
    ]
