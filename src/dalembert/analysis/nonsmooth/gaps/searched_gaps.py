"""Gaps of shapes at the last position, which a step evaluates several times."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature, gap_function
from dalembert.analysis.nonsmooth.gaps.gap_source import GapKind, GapSource
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.analysis.nonsmooth.gaps.recent_positions import AHEAD, RecentPositions
from dalembert.analysis.nonsmooth.gaps.shape_velocities import TWIST
from dalembert.elements.contact.collisions import Collisions
from dalembert.integrators.contact.contact_laws import FIRST, ContactLaws
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.mapped_kernel import MappedKernel


class EvaluatedGaps(NamedTuple):
    """Gaps of pairs of shapes.

    Attributes
    ----------
    first, second : (n,) numbers of the shapes
    distance : (n,)
    blocks : (n, k, 12) derivatives of gap velocities by both twists
    key : (n,)
    """

    first: np.ndarray
    second: np.ndarray
    distance: np.ndarray
    blocks: np.ndarray
    key: np.ndarray

    def some(self, selected: np.ndarray) -> EvaluatedGaps:
        """The selected gaps."""
        if selected.all():
            return self
        return EvaluatedGaps(*(column[selected] for column in self))

    @classmethod
    def joined(cls, parts: list[EvaluatedGaps]) -> EvaluatedGaps:
        """Gaps of several kinds."""
        if len(parts) == 1:
            return parts[0]
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))


@dataclass(eq=False)
class LastPosition:
    """Gaps at one position.

    Attributes
    ----------
    geometry : of the shapes
    configuration : of the position
    at : positions of the shapes
    reach : distance within which gaps are evaluated; at first that of the position before
    requested : largest distance of a request
    gaps : those within ``reach``; None before the first request
    """

    geometry: HullGeometry
    configuration: Configuration
    at: Positions
    reach: float
    requested: float = 0.0
    gaps: EvaluatedGaps | None = None

    @cached_property
    def velocities(self) -> np.ndarray:
        """Derivatives of the twists of the shapes by speeds."""
        return self.geometry.velocities(*self.configuration)


class SearchedGaps(GapSource):
    """Gaps of one ``Collisions`` element that a numerical search selects.

    A subclass evaluates all gaps within reach at a position.

    Parameters
    ----------
    model : Model
    element : Collisions
    """

    def __init__(self, model: Model, element: Collisions):
        self.elements, self.groups = [element], element.friction_groups
        self.dimension: int = element.dimension
        self.geometry = HullGeometry(model, element)
        self.speeds = model.all_equations.speed_count
        self._recent = RecentPositions[LastPosition]()
        self._kernels: dict[Feature, MappedKernel] = {}

    @abstractmethod
    def within(self, last: LastPosition) -> list[EvaluatedGaps]:
        """All gaps within ``last.reach``."""

    @abstractmethod
    def shapes_of(self, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Numbers of the first and second shape of gaps with some keys."""

    def pairs(self, keys: np.ndarray) -> np.ndarray:
        first, second = np.sort(np.stack(self.shapes_of(keys)), axis=0)
        numbers: np.ndarray = first * len(self.geometry.shapes) + second
        return numbers

    def bodies(self, keys: np.ndarray) -> np.ndarray:
        names = np.array([shape.carrier.name for shape in self.geometry.shapes], dtype=object)
        named: np.ndarray = names[np.stack(self.shapes_of(keys), axis=1)]
        return named

    def arms(self, at: Positions) -> np.ndarray:
        """(s,) largest distances of points of the shapes from the origins of their bodies."""
        return self.geometry.arms(at)

    def near(self, configuration: Configuration, travels: np.ndarray) -> Contacts:
        last = self._recent.use(self.position(configuration))
        moved = self.geometry.velocities.displacements(last.velocities, travels)
        reach = self.geometry.reach(self.arms(last.at), moved)
        gaps = self._searched(last, reach)
        near = gaps.distance <= reach
        return self.contacts(last, gaps.some(near)) if near.any() else self.none()

    def deepest(self, configuration: Configuration) -> float:
        last = self._recent.use(self.position(configuration))
        return float(self._searched(last, 0.0).distance.min(initial=0.0))

    def _searched(self, last: LastPosition, reach: float) -> EvaluatedGaps:
        """Gaps at a position, which include all within reach."""
        if last.gaps is None or reach > last.reach:
            last.reach = max(last.reach, reach)
            last.gaps = EvaluatedGaps.joined(self.within(last) or [self._no_gaps])
        last.requested = max(last.requested, reach)
        return last.gaps

    def position(self, configuration: Configuration) -> LastPosition:
        """One of the last positions if it is this one, else a new one."""
        if (recent := self._recent.find(configuration)) is not None:
            return recent
        last = self._recent.last
        at = self.geometry.positions(configuration)
        ahead = 0.0
        if last is not None:
            ahead = AHEAD * last.requested or last.reach
        return LastPosition(self.geometry, configuration.copy(), at, ahead)

    def evaluate(
        self, feature: Feature, columns: Sequence[np.ndarray | list[np.ndarray]]
    ) -> list[np.ndarray]:
        """(n,) distances, (n, k, 12) derivatives of gap velocities by twists, (n, 3) places and
        (n, 3, k) directions of n pairs of features."""
        if feature not in self._kernels:
            self._kernels[feature] = MappedKernel(self.function(feature))
        distance, blocks, place, directions = self._kernels[feature](*columns)
        return [distance.ravel(), blocks, place[..., 0], directions]

    def contacts(self, last: LastPosition, gaps: EvaluatedGaps) -> Contacts:
        """Contacts of evaluated gaps."""
        first, second, distance, blocks, key = gaps
        number = self.geometry.law(first, second)
        derivatives = self.geometry.velocities.gap_derivatives(
            blocks, first, second, last.velocities
        )
        count = distance.size
        return Contacts(
            distance,
            derivatives.rows(),
            np.zeros((count, 1 + sum(self.groups))),
            ContactLaws.of(last.at.coefficients[:, number], self.groups, number),
            self.groups,
            key,
            np.zeros(count, dtype=int),
            moved=derivatives.moved(),
        )

    def kind(
        self,
        function: ca.Function,
        rows: np.ndarray,
        entries: list[np.ndarray],
        first: np.ndarray,
        second: np.ndarray,
    ) -> GapKind:
        """Gaps of pairs of shapes with one function."""
        shapes = np.stack([first, second], axis=1)[..., None]
        velocities = (TWIST * shapes + np.arange(TWIST)).reshape(rows.size, -1)
        geometry = self.geometry
        laws = geometry.numbers.laws(geometry.law(first, second), FIRST + len(self.groups))
        return GapKind(function, rows, entries, velocities, laws)

    def function(self, feature: Feature) -> ca.Function:
        """The gap function of a pair of features."""
        return gap_function(feature, self.dimension, self._turns)

    @property
    def _turns(self) -> bool:
        """Whether there is friction of rotations."""
        return len(self.groups) > 1

    @cached_property
    def _no_gaps(self) -> EvaluatedGaps:
        none, blocks = np.zeros(0, dtype=int), np.zeros((0, 1 + sum(self.groups), 2 * TWIST))
        return EvaluatedGaps(none, none, np.zeros(0), blocks, none)

    def none(self) -> Contacts:
        """No contacts."""
        empty, numbers = np.zeros(0), np.zeros(0, dtype=int)
        rows = np.zeros((0, self.speeds)), np.zeros((0, 1 + sum(self.groups)))
        laws = ContactLaws.of(np.zeros((FIRST + len(self.groups), 0)), self.groups)
        return Contacts(empty, *rows, laws, self.groups, numbers, numbers)
