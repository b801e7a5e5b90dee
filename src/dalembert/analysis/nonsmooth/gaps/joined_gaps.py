"""Gaps of one element from several sources."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.gap_source import GapFormulas, GapKind, GapSource
from dalembert.integrators.contact.contacts import Contacts

SOURCE = 2**50
"""Offset between the keys of gaps of different sources of an element."""
PARTS = "geometry", "velocities"


def selected_of(
    sources: list[GapSource], offset: int, configuration: Configuration, keys: np.ndarray
) -> Contacts:
    """The gaps with some keys, of sources whose keys differ by multiples of ``offset``."""
    if len(sources) == 1:
        return sources[0].selected(configuration, keys)
    numbers, own = np.divmod(keys, offset)
    if keys.size and (numbers == numbers[0]).all():
        gaps = sources[numbers[0]].selected(configuration, own)
        return replace(gaps, key=keys) if numbers[0] else gaps
    parts, order = [], []
    for number in np.unique(numbers) if keys.size else range(len(sources)):
        rows = np.flatnonzero(numbers == number)
        gaps = sources[number].selected(configuration, own[rows])
        parts.append(replace(gaps, key=keys[rows]))
        order.append(rows)
    joined, place = Contacts.joined(parts), np.argsort(np.concatenate(order))
    return joined if (np.diff(place) > 0).all() else joined.some(place)


def separating_of(
    sources: list[GapSource],
    offset: int,
    start: Configuration,
    end: Configuration,
    keys: np.ndarray,
    rounding: float,
) -> np.ndarray:
    """Keys of separating gaps of sources whose keys differ by multiples of ``offset``."""
    numbers, own = np.divmod(keys, offset)
    parts = [keys[:0]]
    for number in np.unique(numbers):
        selected = own[numbers == number]
        parts.append(sources[number].separating(start, end, selected, rounding) + number * offset)
    return np.concatenate(parts)


def pairs_of(sources: list[GapSource], offset: int, keys: np.ndarray) -> np.ndarray:
    """Numbers of the pairs of shapes of gaps of sources whose keys differ by multiples of
    ``offset``."""
    numbers, own = np.divmod(keys, offset)
    pairs = numbers * offset
    for number in np.unique(numbers):
        rows = numbers == number
        pairs[rows] += sources[number].pairs(own[rows])
    return pairs


def normals_of(
    sources: list[GapSource], offset: int, configuration: Configuration, keys: np.ndarray
) -> np.ndarray:
    """(n, 3) normals of gaps of sources whose keys differ by multiples of ``offset``, as
    ``GapSource.normals``."""
    numbers, own = np.divmod(keys, offset)
    normals = np.zeros((keys.size, 3))
    for number in np.unique(numbers):
        rows = numbers == number
        normals[rows] = sources[number].normals(configuration, own[rows])
    return normals


def leaving_of(
    sources: list[GapSource],
    offset: int,
    start: Configuration,
    end: Configuration,
    keys: np.ndarray,
) -> np.ndarray:
    """Mask of the leaving gaps of sources whose keys differ by multiples of ``offset``."""
    numbers, own = np.divmod(keys, offset)
    mask = np.zeros(keys.size, dtype=bool)
    for number in np.unique(numbers):
        rows = numbers == number
        mask[rows] = sources[number].leaving(start, end, own[rows])
    return mask


class JoinedGaps(GapSource):
    """Sources of one element as a single source.

    Parameters
    ----------
    sources : of the same element, with keys below ``SOURCE``
    """

    def __init__(self, sources: list[GapSource]):
        self.sources, self.elements = sources, sources[0].elements
        self.groups, self.speeds = sources[0].groups, sources[0].speeds
        formulas = [source.formulas for source in sources]
        geometry, velocities = ([getattr(f, name) for f in formulas] for name in PARTS)
        self.formulas = GapFormulas(ca.vertcat(*geometry), ca.vertcat(*velocities))

    def near(self, configuration: Configuration, travels: np.ndarray) -> Contacts:
        parts = [source.near(configuration, travels) for source in self.sources]
        others = (replace(part, key=part.key + k * SOURCE) for k, part in enumerate(parts[1:], 1))
        return Contacts.joined([parts[0], *others])

    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        return selected_of(self.sources, SOURCE, configuration, keys)

    def separating(
        self, start: Configuration, end: Configuration, keys: np.ndarray, rounding: float
    ) -> np.ndarray:
        return separating_of(self.sources, SOURCE, start, end, keys, rounding)

    def leaving(self, start: Configuration, end: Configuration, keys: np.ndarray) -> np.ndarray:
        return leaving_of(self.sources, SOURCE, start, end, keys)

    def deepest(self, configuration: Configuration) -> float:
        return min(source.deepest(configuration) for source in self.sources)

    def kinds(self, keys: np.ndarray) -> list[GapKind]:
        kinds, geometry, velocity = [], 0, 0
        for number, source in enumerate(self.sources):
            rows = np.flatnonzero(keys // SOURCE == number)
            for kind in source.kinds(keys[rows] % SOURCE) if rows.size else []:
                arguments = [entries + geometry for entries in kind.arguments]
                places = kind.velocities + velocity, kind.laws + geometry
                kinds.append(GapKind(kind.function, rows[kind.row], arguments, *places))
            geometry += source.formulas.geometry.numel()
            velocity += source.formulas.velocities.numel()
        return kinds

    def points(
        self, configuration: Configuration, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        places, directions = super().points(configuration, keys)
        for number, source in enumerate(self.sources):
            own = keys // SOURCE == number
            if own.any():
                places[own], directions[own] = source.points(configuration, keys[own] % SOURCE)
        return places, directions

    def normals(self, configuration: Configuration, keys: np.ndarray) -> np.ndarray:
        return normals_of(self.sources, SOURCE, configuration, keys)

    def pairs(self, keys: np.ndarray) -> np.ndarray:
        return pairs_of(self.sources, SOURCE, keys)

    def bodies(self, keys: np.ndarray) -> np.ndarray:
        names = super().bodies(keys)
        for number, source in enumerate(self.sources):
            own = keys // SOURCE == number
            names[own] = source.bodies(keys[own] % SOURCE)
        return names
