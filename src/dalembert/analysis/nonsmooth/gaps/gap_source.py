"""Gaps of rigid contacts: the interface of their sources, and gaps stated by formulas."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.elements.base import Element, Rate
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.elements.contact.unilateral import Unilateral
from dalembert.elements.coordinates import rate_of
from dalembert.elements.states import foreign_states
from dalembert.errors import ModelError
from dalembert.integrators.contact.contact_laws import FIRST, ContactLaws
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel, Patterned, dense_array
from dalembert.symbolic.formulas.expression import t


@dataclass(frozen=True, eq=False)
class GapFormulas:
    """Formulas on which the gaps of a source depend, of the model's ``t``, ``y``, ``v``, ``p``, the
    ground at rest.

    Attributes
    ----------
    geometry : positions, sizes and coefficients; free of ``v``
    velocities : linear in ``v``
    """

    geometry: ca.SX
    velocities: ca.SX


@dataclass(frozen=True, eq=False)
class GapKind:
    """Gaps with one function, by numbers of entries of ``GapFormulas``.

    Attributes
    ----------
    function : ``arguments → g, ∂u/∂velocities``, and more results
    row : (n,) positions of the gaps in the list of keys
    arguments : entries of the geometry, (n, m) for each argument of the function
    velocities : (n, w) entries of the velocities
    laws : (n, c) entries of the geometry: ``FIRST`` coefficients, and friction of each group
    """

    function: ca.Function
    row: np.ndarray
    arguments: list[np.ndarray]
    velocities: np.ndarray
    laws: np.ndarray


class GapSource(ABC):
    """Source of the gaps of some elements; finds those within reach.

    Attributes
    ----------
    elements : owners of the gaps
    groups : widths of the groups of tangential components of the relative velocity at a gap
    speeds : number of speeds of the model
    formulas : GapFormulas of all shapes, from which derivatives follow
    """

    elements: list[Element]
    groups: tuple[int, ...]
    speeds: int
    formulas: GapFormulas

    @property
    def linear(self) -> int:
        """Number of components of the relative velocity that are not rotations."""
        return 1 + sum(self.groups[:1])

    def impact_laws(self) -> list[tuple[Element, ImpactLaw]]:
        """Elements with their laws of impact."""
        return [
            (element, law)
            for element in self.elements
            if isinstance(element, Collisions)
            for law in element.impact_laws
        ]

    @abstractmethod
    def near(self, configuration: Configuration, travels: np.ndarray) -> Contacts:
        """Gaps no wider than the largest motion by the displacements ``travels`` (n_v, m)."""

    @abstractmethod
    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        """The gaps with some keys, at any distance, in the order of the keys."""

    def separating(
        self, start: Configuration, end: Configuration, keys: np.ndarray, rounding: float
    ) -> np.ndarray:
        """Keys of gaps between the shapes of the gaps ``keys`` that separate them at the start of
        a step, up to ``rounding``, and are closed at its end; none by default."""
        return keys[:0]

    def leaving(self, start: Configuration, end: Configuration, keys: np.ndarray) -> np.ndarray:
        """(n,) mask of gaps whose features no longer face each other when they close, if bodies
        move on as from ``start`` to ``end``; none by default."""
        return np.zeros(keys.size, dtype=bool)

    @abstractmethod
    def kinds(self, keys: np.ndarray) -> list[GapKind]:
        """The gaps with some keys, by functions."""

    def points(
        self, configuration: Configuration, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n, 3) contact points and (n, 3, linear) directions of velocities at gaps with some keys.

        Gaps stated by formulas have no position, which is NaN.
        """
        return np.full((keys.size, 3), np.nan), np.zeros((keys.size, 3, self.linear))

    def normals(self, configuration: Configuration, keys: np.ndarray) -> np.ndarray:
        """(n, 3) unit vectors from the first body to the second at gaps with some keys; zero for
        gaps stated by formulas."""
        return self.points(configuration, keys)[1][:, :, 0]

    def pairs(self, keys: np.ndarray) -> np.ndarray:
        """(n,) numbers of the pairs of shapes of gaps with some keys; of their own by default."""
        return keys

    def bodies(self, keys: np.ndarray) -> np.ndarray:
        """(n, 2) names of the first and second body of gaps with some keys.

        Gaps stated by formulas have none, which are empty.
        """
        return np.full((keys.size, 2), "", dtype=object)

    def deepest(self, configuration: Configuration) -> float:
        """The smallest gap if it is negative, else 0 [m]."""
        closed = self.near(configuration, np.zeros((self.speeds, 1)))
        return float(closed.distance.min(initial=0.0))


class FormulaGaps(GapSource):
    """Gaps of elements that state them as formulas, evaluated in one function.

    Parameters
    ----------
    model : Model
    elements : its rigid ``Unilateral`` elements
    """

    def __init__(self, model: Model, elements: list[Unilateral]):
        self.elements = list(elements)
        e = model.all_equations
        gaps = [
            (k, gap)
            for k, element in enumerate(elements)
            for gap in element.gaps(_rate(model, element))
        ]
        slips = max(gap.slip.numel() for _, gap in gaps)
        self.groups, self.speeds = (slips,) if slips else (), e.speed_count
        self.owner = np.array([k for k, _ in gaps])
        velocities = []
        for k, gap in gaps:
            padding = ca.SX.zeros(slips - gap.slip.numel())
            velocities.append(
                ca.vertcat(_rate(model, elements[k])(gap.distance), gap.slip, padding)
            )
        speeds = model.at_ground(ca.vertcat(*velocities))
        directions = ca.jacobian(speeds, e.v)
        if ca.depends_on(directions, e.v):
            raise ModelError("velocities of a gap must be linear in speeds", elements[0].name)
        drift = ca.substitute(speeds, e.v, ca.SX.zeros(e.speed_count))
        distances = model.at_ground(ca.vertcat(*(gap.distance for _, gap in gaps)))
        laws = [law for element in elements if (law := element.impact())]
        self._impact_laws = [law.law for law in laws]
        coefficients = ca.horzcat(
            *(
                ca.vertcat(
                    *(law.restitution, law.tangential, law.law.number),
                    *(law.friction, law.friction),
                )
                for law in laws
            )
        )
        coefficients = model.at_ground(ca.densify(coefficients))
        self._law_size = coefficients.shape[0]
        self.formulas = GapFormulas(ca.vertcat(distances, ca.vec(coefficients)), speeds)
        inputs = [e.t, e.y, e.p]
        outputs = [distances, directions, drift]
        self._gaps = Patterned("gaps", inputs, outputs)
        self._laws = Kernel(ca.Function("laws", inputs, [coefficients]))

    def impact_laws(self) -> list[tuple[Element, ImpactLaw]]:
        return list(zip(self.elements, self._impact_laws, strict=True))

    def near(self, configuration: Configuration, travels: np.ndarray) -> Contacts:
        gaps = self._all(configuration)
        reach = np.abs(gaps.directions @ travels).max(initial=0.0)
        return gaps.some(gaps.distance <= reach)

    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        return self._all(configuration).some(keys)

    def _all(self, configuration: Configuration) -> Contacts:
        distance, directions, drift = self._gaps(*configuration)
        count = self.owner.size
        coefficients = self._laws(*configuration)[0][:, self.owner]
        return Contacts(
            distance,
            dense_array(directions),
            drift.reshape(count, self.linear),
            ContactLaws.of(coefficients, self.groups),
            self.groups,
            np.arange(count),
            self.owner,
        )

    def kinds(self, keys: np.ndarray) -> list[GapKind]:
        velocities = keys[:, None] * self.linear + np.arange(self.linear)
        laws = np.arange(FIRST + len(self.groups))
        entries = self.owner.size + self.owner[keys][:, None] * self._law_size + laws
        rows = np.arange(keys.size)
        kind = GapKind(_stated_gap(self.linear), rows, [keys[:, None]], velocities, entries)
        return [kind] if keys.size else []


@cache
def _stated_gap(width: int) -> ca.Function:
    """``g → g, ∂u/∂u``."""
    distance = ca.SX.sym("g")
    return ca.Function("gap", [distance], [distance, ca.densify(ca.SX.eye(width))])


def _rate(model: Model, element: Unilateral) -> Rate:
    owners = element.parts() or model.coordinates

    def rate(s: ca.SX) -> ca.SX:
        others = foreign_states(s, owners, model.coordinates)
        return rate_of(s, [*owners, *others], t.sx)

    return rate
