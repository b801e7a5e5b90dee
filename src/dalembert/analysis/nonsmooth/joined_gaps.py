"""Gaps of one element from several sources."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.gaps import GapSource, SymbolicGap
from dalembert.integrators.contact.contacts import Contacts

SOURCE = 2**50
"""Offset between the keys of gaps of different sources of an element."""


class JoinedGaps(GapSource):
    """Sources of one element as a single source.

    Parameters
    ----------
    sources : of the same element, with keys below ``SOURCE``
    """

    def __init__(self, sources: list[GapSource]):
        self.sources, self.elements = sources, sources[0].elements
        self.groups, self.law = sources[0].groups, sources[0].law

    def near(
        self,
        time: float,
        y: np.ndarray,
        p: np.ndarray,
        travels: np.ndarray,
        groups: tuple[int, ...],
    ) -> Contacts:
        parts = [source.near(time, y, p, travels, groups) for source in self.sources]
        return Contacts.joined(
            [replace(part, key=part.key + k * SOURCE) for k, part in enumerate(parts)]
        )

    def deepest(self, time: float, y: np.ndarray, p: np.ndarray, speeds: int) -> float:
        return min(source.deepest(time, y, p, speeds) for source in self.sources)

    def symbolic(self, key: int) -> SymbolicGap:
        number, own = divmod(int(key), SOURCE)
        return self.sources[number].symbolic(own)

    def points(
        self, time: float, y: np.ndarray, p: np.ndarray, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        places, directions = super().points(time, y, p, keys)
        for number, source in enumerate(self.sources):
            own = keys // SOURCE == number
            if own.any():
                places[own], directions[own] = source.points(time, y, p, keys[own] % SOURCE)
        return places, directions
