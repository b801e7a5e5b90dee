"""Coefficients of the laws of contacts: restitution and friction."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import zip_longest

import numpy as np

from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import UnsupportedError

IMPACT, FIRST = 2, 4
"""Numbers of the law of impact and of the first coefficient of friction in a column of
``Collisions.coefficients``."""


@dataclass(frozen=True, eq=False)
class ContactLaws:
    """Coefficients of n contacts.

    Attributes
    ----------
    restitution, tangential : (n,) restitution along the normal and of the slip [-]
    impact : (n,) number of the ``ImpactLaw``
    static_friction : (n,) ``μ_s ≥ μ`` of contacts without slip [-]
    friction : (n, groups) of each group of tangential components, as in ``FrictionProblem``
    number : (n,) number of the law in the element of the gap
    """

    restitution: np.ndarray
    tangential: np.ndarray
    impact: np.ndarray
    static_friction: np.ndarray
    friction: np.ndarray
    number: np.ndarray

    @classmethod
    def of(
        cls,
        coefficients: np.ndarray,
        groups: tuple[int, ...],
        number: np.ndarray | None = None,
    ) -> ContactLaws:
        """Laws from columns of ``Collisions.coefficients`` (c, n); numbers are 0 by default."""
        restitution, tangential, impact, static_friction = coefficients[:FIRST]
        friction = coefficients[FIRST : FIRST + len(groups)].T
        number = np.zeros(restitution.size, dtype=int) if number is None else number
        return cls(restitution, tangential, impact, static_friction, friction, number)

    def follows(self, law: ImpactLaw) -> np.ndarray:
        """(n,) mask of contacts with a law of impact."""
        mask: np.ndarray = self.impact == law.number
        return mask

    @cached_property
    def higher_at_rest(self) -> np.ndarray:
        """(n,) mask of contacts with more friction while they do not slip."""
        higher = np.zeros(self.restitution.size, dtype=bool)
        if self.friction.size:
            higher = self.static_friction > self.friction[:, 0]
        return higher

    def some(self, selected: np.ndarray) -> ContactLaws:
        """Laws of the selected contacts."""
        return ContactLaws(
            self.restitution[selected],
            self.tangential[selected],
            self.impact[selected],
            self.static_friction[selected],
            self.friction[selected],
            self.number[selected],
        )

    def padded(self, groups: int) -> ContactLaws:
        """Laws with a number of groups, the further ones frictionless."""
        missing = ((0, 0), (0, groups - self.friction.shape[1]))
        return replace(self, friction=np.pad(self.friction, missing))

    @classmethod
    def joined(cls, parts: list[ContactLaws]) -> ContactLaws:
        """Laws of several sources."""
        columns = ([getattr(part, field.name) for part in parts] for field in fields(cls))
        return cls(*(np.concatenate(column) for column in columns))


def widest_groups(parts: list[tuple[int, ...]]) -> tuple[int, ...]:
    """Groups of tangential components into which those of all sources fit, padded by zeros.

    Raises
    ------
    UnsupportedError
        A source with rotations has fewer components of slip than another source.
    """
    widest = tuple(max(widths) for widths in zip_longest(*parts, fillvalue=0))
    if any(own[:-1] != widest[: len(own) - 1] for own in parts if own):
        raise UnsupportedError(
            "rolling friction in the plane and contacts in space are not available in one model; "
            "leave out rolling="
        )
    return widest
