"""What restitution a law with damping in proportion to its elastic force really has.

Of ``m δ̈ = −K δⁿ (1 + d δ̇/v₀)`` from ``δ̇ = v₀``, whatever m, K and n (Hunt and Crossley 1975):

    (1 + e) d = ln (1 + d) − ln (1 − d e).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dalembert.errors import ModelError
from dalembert.text.spelling import spelled

ROUNDING = 1e-15


@spelled
def achieved_restitution(factor: float) -> float:
    """The restitution ``e`` of an impact with the speed ``v₀`` that a factor ``d`` leads to.

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
    >>> round(contact.achieved_restitution(0.0), 6)  # without damping all of the speed returns
    1.0
    >>> round(contact.achieved_restitution(1.5 * (1 - 0.5)), 3)  # Hunt and Crossley's for 0.5
    0.663
    """
    if not factor >= 0:
        raise ModelError(f"a damping factor is not negative, got {factor!r}")
    if factor < 1e-9:  # e = 1 − 2 d/3 …
        return 1 - 2 * factor / 3
    most = min(1.0, (1 - ROUNDING) / factor)
    if _imbalance(most, factor) > 0:  # nearer to 1/d than numbers can tell
        return most
    return _root(lambda e: _imbalance(e, factor), 0.0, most)


@spelled
def damping_factor(restitution: float) -> float:
    """The factor ``d`` with which an impact of the speed ``v₀`` has this restitution.

    ``HuntCrossley(stiffness=…, damping=damping_factor(e) / v₀)`` achieves what is asked for.

    Parameters
    ----------
    restitution : ``e``, above zero and up to one

    Raises
    ------
    ModelError
        It is not above zero and up to one.

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
    most = (1 - ROUNDING) / restitution
    least = (1 - restitution) / 2
    if _imbalance(restitution, most) > 0:
        return most
    return _root(lambda d: _imbalance(restitution, d), least, most)


def _imbalance(e: float, d: float) -> float:
    return (1 + e) * d - math.log1p(d) + math.log1p(-d * e)


def _root(function: Callable[[float], float], least: float, most: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(function, least, most, xtol=1e-15, rtol=1e-14))
