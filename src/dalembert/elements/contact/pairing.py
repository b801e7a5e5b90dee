"""Which shapes meet, and where."""

from __future__ import annotations

from dalembert.elements.contact.meeting import Meeting
from dalembert.elements.contact.shapes import Shape
from dalembert.errors import ModelError


def meetings(shape_i: Shape, shape_j: Shape, owner: str) -> list[Meeting]:
    """Every place where two shapes may touch.

    Raises
    ------
    ModelError
        Nothing is known of how these two touch.
    """
    found: list[Meeting] = []
    if isinstance(shape_j, shape_i.feels):
        found += shape_i.meet(shape_j, owner)
    if isinstance(shape_i, shape_j.feels) and (not found or shape_i.mutual):
        found += [meeting.reversed() for meeting in shape_j.meet(shape_i, owner)]
    if not found:
        i, j = (type(shape).__name__ for shape in (shape_i, shape_j))
        known = ", ".join(known_pairs(shape_i.dimension))
        raise ModelError(f"no contact of {i} and {j} is known; there are {known}", owner)
    return found


def known_pairs(dimension: int) -> list[str]:
    """The pairs of shapes there are in the plane, or in space."""
    kinds = [kind for kind in _below(Shape) if kind.space in (0, dimension)]
    pairs = {
        frozenset((felt, other)): f"{felt.__name__}–{other.__name__}"
        for felt in kinds
        for other in kinds
        if issubclass(other, felt.feels)
    }
    return list(pairs.values())


def _below(kind: type[Shape]) -> list[type[Shape]]:
    """The classes made of a class that no others are made of."""
    found = [last for made in kind.__subclasses__() for last in _below(made)]
    return list(dict.fromkeys(found)) or [kind]
