"""All gaps of a model with given parameters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dalembert.analysis.contact.gap_checks import ROUNDED
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.gap_source import GapSource
from dalembert.analysis.nonsmooth.gaps.joined_gaps import (
    leaving_of,
    normals_of,
    pairs_of,
    selected_of,
    separating_of,
)
from dalembert.analysis.nonsmooth.gaps.tangents import with_tangents_of
from dalembert.integrators.contact.contact_laws import widest_groups
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model

CLOSED = 1e-12
"""Penetration that counts as rounding, by the size of the bodies [-]."""
APART = 2**54
"""Offset between the keys of gaps of different sources."""


@dataclass(frozen=True, eq=False)
class ModelGaps:
    """Gaps of all sources of a model.

    Attributes
    ----------
    model : Model
    sources : of its gaps
    p : (np,) parameters
    """

    model: Model
    sources: list[GapSource]
    p: np.ndarray

    @cached_property
    def groups(self) -> tuple[int, ...]:
        """Widths of the groups of tangential components of the relative velocities."""
        return widest_groups([source.groups for source in self.sources])

    def at(self, t: float, y: np.ndarray) -> Configuration:
        """The configuration with the parameters of the steps."""
        return Configuration(t, y, self.p)

    def near(self, configuration: Configuration, travels: np.ndarray) -> Contacts:
        """Gaps of all sources within reach of the displacements ``travels``."""
        parts = [source.near(configuration, travels) for source in self.sources]
        for number, part in enumerate(parts[1:], 1):
            owner, key = part.owner + self._first_elements[number], part.key + number * APART
            parts[number] = replace(part, owner=owner, key=key)
        return Contacts.joined(parts)

    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        """Gaps with some keys, at any distance."""
        gaps = selected_of(self.sources, APART, configuration, keys)
        if len(self.sources) == 1:
            return gaps
        return replace(gaps, owner=gaps.owner + self._first_elements[keys // APART])

    def following(
        self, configuration: Configuration, keys: np.ndarray, start: Configuration
    ) -> Contacts:
        """Gaps with some keys, at any distance, whose tangents follow those at ``start``.

        The tangents turn with the normal by the smallest angle, so that they do not spin about it.
        Components along them are those at ``start`` of the same velocity, whatever the axes of the
        model.
        """
        gaps = self.selected(configuration, keys)
        if not keys.size or self.groups[:1] != (2,):
            return gaps
        normals = (normals_of(self.sources, APART, at, keys) for at in (start, configuration))
        return with_tangents_of(gaps, *normals)

    def separating(self, start: Configuration, end: Configuration, keys: np.ndarray) -> np.ndarray:
        """Keys of gaps between the shapes of the gaps ``keys`` that separate them at ``start`` and
        are closed at ``end``."""
        return separating_of(self.sources, APART, start, end, keys, self.rounding)

    def leaving(self, start: Configuration, end: Configuration, keys: np.ndarray) -> np.ndarray:
        """(n,) mask of gaps whose features no longer face each other when they close, if bodies
        move on as from ``start`` to ``end``."""
        return leaving_of(self.sources, APART, start, end, keys)

    def pairs(self, keys: np.ndarray) -> np.ndarray:
        """(n,) numbers of the pairs of shapes of gaps with some keys."""
        return pairs_of(self.sources, APART, keys)

    @cached_property
    def _first_elements(self) -> np.ndarray:
        """Number of the first element of each source."""
        return np.cumsum([0, *(len(source.elements) for source in self.sources)])

    @property
    def names(self) -> list[str]:
        """Names of the owners of gaps."""
        return [element.name for source in self.sources for element in source.elements]

    def touching(self, configuration: Configuration) -> Contacts:
        """Gaps that are not open; those of the last call if the configuration is the same."""
        last = self._last.get("touching")
        if last is None or not configuration.equals(last[0]):
            gaps = self.near(configuration, np.zeros((self.model.equations.speed_count, 1)))
            last = self._last["touching"] = configuration.copy(), gaps
        return last[1]

    @cached_property
    def _last(self) -> dict[str, tuple[Configuration, Contacts]]:
        return {}

    @property
    def rounding(self) -> float:
        """Penetration that counts as rounding [m]."""
        return self.model.scales.gap_threshold(CLOSED)

    @property
    def length(self) -> float:
        """Length by which penetrations are judged: the size of the bodies, or, far from the origin,
        that of which ``rounding`` is the same share [m]."""
        return self.rounding / CLOSED

    @property
    def rounded_overlap(self) -> float:
        """Overlap at the start that counts as rounded input [m]."""
        return self.model.scales.gap_threshold(ROUNDED)
