"""Rigid contact of two shapes of ``Collisions``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.contact import Contact
from dalembert.elements.contact.friction import Coulomb
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.elements.contact.laws import Restitution
from dalembert.elements.contact.pairs import APART, COEFFICIENTS
from dalembert.elements.contact.shapes import Flat, Shape
from dalembert.elements.contact.unilateral import Gap, Impact
from dalembert.errors import ModelError, UnsupportedError
from dalembert.symbolic.formulas.expression import Expression

DEPTH = 3
"""Depth of formulas up to which their equality is recognised."""
INSTEAD = "use solve_nonsmooth, which has it"


class PairContact(Contact):
    """Contact of two shapes with the coefficients of their ``Collisions``.

    Parameters
    ----------
    name : of the contact
    shapes : the two shapes
    coefficients : ``COEFFICIENTS`` by name
    poisson : whether restitution is that of Poisson's law
    """

    def __init__(
        self,
        name: str,
        shapes: tuple[Shape, Shape],
        coefficients: dict[str, Expression],
        poisson: bool,
    ):
        self._poisson = poisson
        law = Restitution(coefficients["restitution"], coefficients["tangential"])
        friction = coefficients["friction"]
        rubs = not friction.sx.is_zero() or not law.tangential.sx.is_zero()
        rub, (shape_i, shape_j) = Coulomb(friction) if rubs else None, shapes
        super().__init__(name, shape_i=shape_i, shape_j=shape_j, law=law, friction=rub)

    def impact(self) -> Impact:
        impact = super().impact()
        assert impact is not None
        return Impact(impact.restitution, impact.tangential, impact.friction, self._poisson)

    def gaps(self, rate) -> list[Gap]:
        gaps = super().gaps(rate)
        if self.friction is None:  # nothing acts along the surface
            return [Gap(gap.distance, ca.SX(0, 1)) for gap in gaps]
        return gaps

    def look(self) -> list[Look]:
        return []  # the shapes are drawn by the collisions

    def conditions(self) -> list:
        return []  # those of the collisions

    def checked_quantities(self) -> list:
        return []


def pair_contacts(element: Collisions) -> list[PairContact]:
    """Contacts of all pairs of shapes of different bodies that touch each other.

    Raises
    ------
    UnsupportedError
        Laws without located impacts, or a pair of shapes that has no contact.
    """
    _refuse_laws(element)
    numbers = element.group_of(list(element.members))
    labels, contacts = _labels(element.members), []
    for i, j in _candidates(element.members):
        law = element.laws[numbers[i], numbers[j]]
        if law == APART:
            continue
        shapes = element.members[i], element.members[j]
        name = f"{element.name}_{labels[i]}_{labels[j]}"
        column = element.coefficients[:, int(law)]
        values = {c: Expression(column[k]) for k, c in enumerate(COEFFICIENTS)}
        poisson = element.impact_laws[law] is ImpactLaw.POISSON
        try:
            contacts.append(PairContact(name, shapes, values, poisson))
        except ModelError as error:
            raise UnsupportedError(
                f"{element.name}: {error.message}, so that their impacts are not located; use "
                "solve_nonsmooth"
            ) from None
    return contacts


def _candidates(shapes: Sequence[Shape]) -> Iterator[tuple[int, int]]:
    """Pairs of shapes of different bodies, except of two walls."""
    for i, j in combinations(range(len(shapes)), 2):
        first, second = shapes[i], shapes[j]
        walls = isinstance(first, Flat) and isinstance(second, Flat)
        same = [b.owner for b in first.bodies] == [b.owner for b in second.bodies]
        if not walls and not same and first.carrier.name != second.carrier.name:
            yield i, j


def _labels(shapes: Sequence[Shape]) -> list[str]:
    """Names of the bodies of the shapes, numbered where a body has several."""
    names = [shape.carrier.name for shape in shapes]
    return [
        f"{name}{names[:k].count(name) + 1}" if names.count(name) > 1 else name
        for k, name in enumerate(names)
    ]


def _refuse_laws(element: Collisions) -> None:
    """Refuse laws without located impacts.

    Raises
    ------
    UnsupportedError
        Names the law.
    """
    if any(element.force_laws):
        raise UnsupportedError(
            f"{element.name}: its force law has no impacts to be located among many shapes; use "
            "solve_nonsmooth, or a Contact with this law for each pair"
        )
    if ImpactLaw.ENERGETIC in element.impact_laws:
        text = "impact_law='energetic' has no located impacts"
        raise UnsupportedError(f"{element.name}: {text}; {INSTEAD}, or 'newton' or 'poisson'")
    rows = {name: element.coefficients[k, :] for k, name in enumerate(COEFFICIENTS)}
    for name in ("rolling", "spinning"):
        if not rows[name].is_zero():
            text = f"{name}= has no located impacts"
            raise UnsupportedError(f"{element.name}: {text}; {INSTEAD}, or leave it out")
    laws = zip(*(ca.horzsplit(rows[name]) for name in ("static_friction", "friction")), strict=True)
    if not all(ca.is_equal(static, sliding, DEPTH) for static, sliding in laws):
        text = "static_friction= has no located impacts"
        raise UnsupportedError(f"{element.name}: {text}; {INSTEAD}, or leave it out")
