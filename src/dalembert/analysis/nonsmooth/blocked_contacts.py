"""Contacts that joints and drivers leave no motion, so that no impulse opens them.

Where a driver presses a body against another one that its joints hold in this direction, the
mobility of the contact ``w M⁻¹ wᵀ`` with the joints is zero, but for rounding. An impulse that
opens the gap is then the quotient of a speed and of rounding: it has a small residual, and no
meaning.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.integrators.contact.contacts import Contacts
from dalembert.integrators.contact.impulses import Impulses

UNRESOLVED = 1e-2
"""Rounding of the speeds of contacts by their impulses, relative to the largest speed without
these, above which the impulses are not a solution [-]."""


def without_unresolved(
    impulses: Impulses, contacts: Contacts, mobility: Mobility, fastest: float
) -> Impulses:
    """The impulses, not accepted if the rounding of their speeds is not small against ``fastest``.

    With joints, the speeds by an impulse are differences of those that it causes without joints,
    and have the rounding of these.

    Parameters
    ----------
    impulses : solution of the friction problem
    fastest : the largest speed of a contact without impulses [m/s]
    """
    if not contacts.count or not mobility.joints.shape[0]:
        return impulses
    error = np.finfo(float).eps * _free_speeds(impulses.impulses, contacts, mobility)
    if error <= UNRESOLVED * fastest:
        return impulses
    residual = max(impulses.residual, error)
    return replace(impulses, residual=residual, converged=False, accepted=False)


def _free_speeds(impulses: np.ndarray, contacts: Contacts, mobility: Mobility) -> float:
    """Bound on the normal speeds of a contact by the normal impulses, without joints [m/s]."""
    inertia = np.abs(mobility.matrix.diagonal())
    inverse = np.divide(1.0, inertia, out=np.zeros(inertia.size), where=inertia > 0)
    normals = contacts.normals
    squares = (normals**2 if isinstance(normals, np.ndarray) else normals.power(2)) @ inverse
    roots = np.sqrt(squares)
    return float(roots.max() * (roots @ np.abs(impulses[:, 0])))
