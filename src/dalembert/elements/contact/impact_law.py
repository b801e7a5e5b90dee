"""Definitions of the coefficient of restitution."""

from __future__ import annotations

from enum import Enum
from functools import cached_property


class ImpactLaw(Enum):
    """Quantity of an impact whose ratio is the coefficient of restitution ``e``.

    NEWTON: speeds, ``u_N⁺ = −e u_N⁻``. POISSON: normal impulses of expansion and compression,
    ``P_e = e P_c``. ENERGETIC: work of the normal impulse, ``W_e = −e² W_c`` (Stronge 1990).
    """

    NEWTON = "newton"
    POISSON = "poisson"
    ENERGETIC = "energetic"

    @cached_property
    def number(self) -> int:
        """Its number among the coefficients of a contact."""
        return list(ImpactLaw).index(self)
