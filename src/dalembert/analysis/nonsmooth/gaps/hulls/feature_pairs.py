"""Pairs of features of shapes that may touch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature


@dataclass(frozen=True, eq=False)
class Pairs:
    """Near features of one kind.

    Attributes
    ----------
    feature : kind
    first, second : (n,) numbers of the shapes
    own, other : (n,) numbers of their features
    """

    feature: Feature
    first: np.ndarray
    second: np.ndarray
    own: np.ndarray
    other: np.ndarray


EvaluatePairs = Callable[[Pairs], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Gaps (n,), contact points (n, 3) and normals (n, 3) of pairs of features."""


def some_pairs(pairs: Pairs, selected: np.ndarray) -> Pairs:
    """The selected pairs."""
    names = ("first", "second", "own", "other")
    return replace(pairs, **{name: getattr(pairs, name)[selected] for name in names})
