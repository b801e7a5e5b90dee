"""Coefficients of the laws of contacts: restitution and friction."""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import zip_longest

import numpy as np

from dalembert.errors import UnsupportedError


@dataclass(frozen=True, eq=False)
class ContactLaws:
    """Coefficients of n contacts.

    Attributes
    ----------
    restitution, tangential : (n,) restitution along the normal and of the slip [-]
    friction : (n, groups) of each group of tangential components, as in ``FrictionProblem``
    """

    restitution: np.ndarray
    tangential: np.ndarray
    friction: np.ndarray

    @classmethod
    def of(cls, coefficients: np.ndarray, groups: tuple[int, ...]) -> ContactLaws:
        """Laws from columns of ``Collisions.coefficients`` (c, n)."""
        return cls(coefficients[0], coefficients[1], coefficients[2 : 2 + len(groups)].T)

    def some(self, selected: np.ndarray) -> ContactLaws:
        """Laws of the selected contacts."""
        return ContactLaws(*(getattr(self, field.name)[selected] for field in fields(self)))

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
