"""Achieved restitution of laws with damping proportional to the elastic force.

For ``m δ̈ = −K δⁿ (1 + d δ̇/v₀)`` from ``δ̇ = v₀``, for all m, K and n (Hunt and Crossley 1975):

    (1 + e) d = ln (1 + d) − ln (1 − d e).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dalembert.errors import ModelError
from dalembert.text.arguments import check_arguments

ROUNDING = 1e-15
"""Relative distance from the pole of the logarithm that rounding permits."""


@check_arguments
def achieved_restitution(factor: float) -> float:
    """The restitution ``e`` of an impact at the speed ``v₀`` for a damping factor ``d``.

    Parameters
    ----------
    factor : ``d``, not negative

    Raises
    ------
    ModelError
        The factor is negative.

    Examples
    --------
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> round(contact.achieved_restitution(0.0), 6)  # no damping, no loss of speed
    1.0
    >>> round(contact.achieved_restitution(1.5 * (1 - 0.5)), 3)  # Hunt and Crossley, e = 0.5
    0.663
    """
    if not factor >= 0:
        raise ModelError(f"a damping factor is not negative, got {factor!r}")
    if factor < 1e-9:  # e = 1 − 2 d/3 …
        return 1 - 2 * factor / 3
    upper = min(1.0, (1 - ROUNDING) / factor)
    if _imbalance(upper, factor) > 0:  # closer to 1/d than rounding
        return upper
    return _root(lambda e: _imbalance(e, factor), 0.0, upper)


@check_arguments
def damping_factor(restitution: float) -> float:
    """The damping factor ``d`` for which an impact at the speed ``v₀`` has a restitution ``e``.

    ``HuntCrossley(stiffness=…, damping=damping_factor(e) / v₀)`` achieves this restitution.

    Parameters
    ----------
    restitution : ``e``, above zero and up to one

    Raises
    ------
    ModelError
        The restitution is outside this range.

    Examples
    --------
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> factor = contact.damping_factor(0.5)
    >>> round(contact.achieved_restitution(factor), 9)
    0.5
    >>> contact.damping_factor(1.0)
    0.0
    """
    if not 0 < restitution <= 1:
        raise ModelError(f"a restitution is above 0 and up to 1, got {restitution!r}")
    if restitution > 1 - 1e-9:
        return 1.5 * (1 - restitution)
    upper = (1 - ROUNDING) / restitution
    lower = (1 - restitution) / 2
    if _imbalance(restitution, upper) > 0:
        return upper
    return _root(lambda d: _imbalance(restitution, d), lower, upper)


def _imbalance(e: float, d: float) -> float:
    return (1 + e) * d - math.log1p(d) + math.log1p(-d * e)


def _root(function: Callable[[float], float], lower: float, upper: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(function, lower, upper, xtol=1e-15, rtol=1e-14))
