"""Warning about corrections of positions that lift bodies.

A scheme that opens gaps after a step adds the work of its corrections. A body that turns about a
corner is lifted in every step and then falls behind its motion.
"""

from __future__ import annotations

from dalembert.integrators.contact.schemes import ContactScheme

SHARE = 0.02
"""Work of corrections, relative to the energy in the motion, that causes a warning [-]."""


def lifting_warnings(work: float, moved: float, scheme: ContactScheme) -> list[str]:
    """Warning about a run in which corrections of positions did much work.

    Parameters
    ----------
    work : of the corrections [J]
    moved : energy that took part in the motion [J]
    """
    if not abs(work) > SHARE * moved:
        return []
    other = "" if scheme.anticipates else ", or integrator=AnticipatedImpacts()"
    return [
        f"corrections of positions, which lift bodies, did {work:.3g} J of work, where "
        f"{moved:.3g} J took part in the motion; use a shorter step{other}"
    ]
