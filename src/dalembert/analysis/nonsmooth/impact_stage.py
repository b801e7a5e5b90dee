"""Impacts with compression and expansion at the start of a step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mobility import Mobility, delassus
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem, among
from dalembert.integrators.contact.impact_path import Increment, impact_impulses
from dalembert.integrators.contact.impulses import Impulses

MOVED = 1e-9
"""Threshold of a speed by a unit impulse, relative to the largest one [-]."""


@dataclass(frozen=True, eq=False)
class ImpactStage:
    """Impulses that change the speeds before the forces of a step do.

    Attributes
    ----------
    contacts : those that take part
    impulses : of these
    change, multiplier : changes of the speeds, and impulses of the joints
    increments : of the impulses
    """

    contacts: Contacts
    impulses: Impulses
    change: np.ndarray
    multiplier: np.ndarray
    increments: list[Increment]

    @property
    def momentum(self) -> np.ndarray:
        """(n_v,) ``Wᵀ P``."""
        return np.asarray(self.contacts.directions.T @ self.impulses.impulses.ravel())

    def rows(self, contacts: Contacts) -> np.ndarray:
        """(n,) mask of the contacts that take part."""
        return among(contacts.key, self.contacts.key)

    def added(self, contacts: Contacts, solution: Impulses) -> Impulses:
        """Sums of the impulses of the stage and of the rest of the step."""
        impulses, own = solution.impulses.copy(), self.impulses
        place = {key: row for row, key in enumerate(contacts.key)}
        impulses[[place[key] for key in self.contacts.key]] += own.impulses
        return Impulses(
            impulses,
            max(own.residual, solution.residual),
            own.converged and solution.converged,
            own.rounds + solution.rounds,
            own.accepted and solution.accepted,
        )


def impact_stage(
    approach: Approach, mobility: Mobility, solver: ContactSolver
) -> ImpactStage | None:
    """Impacts of the contacts, in groups on connected bodies, by Poisson's or the energetic law.

    A group takes part if one of its gaps closes faster than forces change speeds, and one has such
    a law; None without any.

    Raises
    ------
    UnsupportedError
        A contact by Newton's law with restitution of the slip is in such a group.
    """
    if not approach.is_impact:
        return None
    taking_part = _taking_part(approach, mobility)
    if not taking_part.any():
        return None
    contacts = approach.contacts.some(taking_part)
    laws = contacts.laws
    if laws.tangential[laws.follows(ImpactLaw.NEWTON)].any():
        raise UnsupportedError(
            "contacts with several laws of impact act in one impact, and one by Newton's law has "
            "restitution of the slip; leave out tangential="
        )
    before, matrix = approach.struck_from[taking_part], delassus(contacts.directions, mobility)
    friction = laws.friction, contacts.groups
    problem = FrictionProblem(matrix, before, *friction, approach.fastest or 1.0)
    impulses, increments = impact_impulses(problem, laws, solver)
    momentum = contacts.directions.T @ impulses.impulses.ravel()
    return ImpactStage(contacts, impulses, *mobility(momentum), increments)


def _taking_part(approach: Approach, mobility: Mobility) -> np.ndarray:
    """(n,) mask of the contacts of an impact."""
    contacts = approach.contacts
    other = ~contacts.laws.follows(ImpactLaw.NEWTON)
    responses = scipy.sparse.csr_array(abs(mobility.responses(contacts.directions)))
    largest = np.repeat(responses.max(axis=1).toarray().ravel(), np.diff(responses.indptr))
    responses.data = (responses.data > MOVED * largest).astype(float)
    width = approach.before.shape[1]
    rows = np.arange(contacts.count * width)
    joined = scipy.sparse.csr_array((np.ones(rows.size), (rows // width, rows))) @ responses
    graph = joined @ joined.T
    count, labels = scipy.sparse.csgraph.connected_components(graph, directed=False)
    impacts, follows = (np.zeros(count, dtype=bool) for _ in range(2))
    impacts[labels[approach.impacting]] = True
    follows[labels[other]] = True
    return np.asarray((impacts & follows)[labels])
