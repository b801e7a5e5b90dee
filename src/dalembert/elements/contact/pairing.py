"""Contact points of pairs of shapes."""

from __future__ import annotations

from dalembert.elements.contact.meeting import ContactPoint
from dalembert.elements.contact.shapes import Shape
from dalembert.errors import ModelError


def contact_points(shape_i: Shape, shape_j: Shape, owner: str) -> list[ContactPoint]:
    """All potential contact points of two shapes.

    Raises
    ------
    ModelError
        The contact of these two shapes is not implemented.
    """
    points: list[ContactPoint] = []
    if isinstance(shape_j, shape_i.feels):
        points += shape_i.contact_points(shape_j, owner)
    if isinstance(shape_i, shape_j.feels) and (not points or shape_i.mutual):
        points += [point.reversed() for point in shape_j.contact_points(shape_i, owner)]
    if not points:
        i, j = (type(shape).__name__ for shape in (shape_i, shape_j))
        pairs = ", ".join(supported_pairs(shape_i.dimension))
        raise ModelError(f"no contact of {i} and {j} is known; there are {pairs}", owner)
    return points


def supported_pairs(dimension: int) -> list[str]:
    """The pairs of shapes whose contact is implemented, planar or spatial."""
    kinds = [kind for kind in _final_classes(Shape) if kind.space in (0, dimension)]
    pairs = {
        frozenset((surface, other)): f"{surface.__name__}–{other.__name__}"
        for surface in kinds
        for other in kinds
        if issubclass(other, surface.feels)
    }
    return list(pairs.values())


def _final_classes(kind: type[Shape]) -> list[type[Shape]]:
    """The subclasses of a class that have no subclasses."""
    final = [last for subclass in kind.__subclasses__() for last in _final_classes(subclass)]
    return list(dict.fromkeys(final)) or [kind]
