"""Supports and loads of nodes, built from joints, drivers and forces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from dalembert.elements import planar, spatial
from dalembert.elements.base import Constraint, ForceElement
from dalembert.elements.body import BodyElement
from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.fem.node import ROTATIONS, TRANSLATIONS
from dalembert.elements.planar.body import Ground
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

Nodes = NodeBody | Sequence[NodeBody]


def supports(ground: Ground, nodes: Nodes, displacements: dict[str, Any]) -> Iterator[Constraint]:
    """Constraints that prescribe displacements ``ux, uy, uz`` [m] and ``rz`` [rad] in the plane.

    In space, rotations are fixed all together, with all displacements, or not at all.

    Raises
    ------
    ModelError
        No node, or an unknown direction.
    """
    for node in as_list(nodes):
        name = f"{node.name.replace('.', '_')}_support"
        directions = _directions(node)
        _check(node, displacements, directions)
        values = {
            d: as_expression(value, f"support {node.name}.{d}", "rad" if d == "rz" else "m")
            for d, value in (displacements or dict.fromkeys(directions, 0.0)).items()
        }
        fixed = all(_is_zero(values.get(direction, 1.0)) for direction in directions)
        point = ground.point(*(Expression(node.natural[k]) for k in range(node.dimension)))
        rotations = [direction for direction in values if direction in ROTATIONS[node.dimension]]
        if fixed and node.dimension == 2:
            joint = planar.Weld if _body(node).rotates else planar.Revolute
            yield joint(name, point, _body(node).center)
        elif fixed and not _body(node).rotates:
            yield spatial.Spherical(name, point, _body(node).center)
        elif fixed:
            orientation = _body(node).initial[1]
            frame = ground.frame(tuple(point.local[k] for k in range(3)), rotation=orientation)
            yield spatial.Weld(name, frame, _body(node).frame())
        elif rotations and node.dimension == 3:
            raise ModelError(
                f"{node.name}: {rotations[0]} cannot be prescribed alone in space; hold all of "
                f"{', '.join(directions)} at zero, or use a joint or a RotationalDriver"
            )
        else:
            for direction, value in values.items():
                yield _driver(f"{name}_{direction}", ground, node, direction, value)


def _driver(name: str, ground: Ground, node: NodeBody, direction: str, value: Any) -> Constraint:
    """The constraint of one displacement to a value."""
    if direction == "rz":
        return planar.RotationalDriver(name, ground, _body(node), law=value)
    kind = planar if node.dimension == 2 else spatial
    k = TRANSLATIONS.index(direction)
    axis = tuple(float(i == k) for i in range(node.dimension))
    law = Expression(node.natural[k]) + value
    return kind.CoordinateDriver(name, _body(node).center, law=law, direction=axis)


def loads(nodes: Nodes, forces: dict[str, Any], number: int) -> Iterator[ForceElement]:
    """Forces ``fx, fy, fz`` [N] and moments ``mx, my, mz`` [N m] on each of the nodes.

    Axes are fixed. Planar nodes have one moment, points have none.

    Parameters
    ----------
    number : suffix that makes their names unique

    Raises
    ------
    ModelError
        No node, no load, or an unknown direction.
    """
    for node in as_list(nodes):
        named = {d.replace("u", "f").replace("r", "m"): d for d in _directions(node)}
        if not forces:
            raise ModelError(f"{node.name}: gets no load; give one of {', '.join(named)}")
        _check(node, forces, tuple(named))
        name = f"{node.name.replace('.', '_')}_load{number}"
        kind = planar if node.dimension == 2 else spatial
        vector = tuple(forces.get(f"f{axis}", 0.0) for axis in "xyz"[: node.dimension])
        if any(not _is_zero(component) for component in vector):
            yield kind.Force(name, _body(node).center, vector)
        moment = tuple(forces.get(f"m{axis}", 0.0) for axis in "xyz")
        if node.dimension == 2 and "mz" in forces:
            yield planar.Torque(f"{name}_mz", _body(node), forces["mz"])
        elif any(not _is_zero(component) for component in moment):
            yield spatial.Torque(f"{name}_moment", _body(node), moment)


def as_list(nodes: Nodes) -> list[NodeBody]:
    """A node or a sequence of nodes as a list.

    Raises
    ------
    ModelError
        Anything else.
    """
    listed = list(nodes) if isinstance(nodes, Sequence) else [nodes]
    for node in listed:
        if not isinstance(node, NodeBody):
            raise ModelError(
                f"expected nodes, as planar.Node or those of a mesh; got {node!r}; other bodies "
                "are held by joints and loaded by forces"
            )
    return listed


def _body(node: NodeBody) -> Any:
    """The node as a body."""
    assert isinstance(node, BodyElement)
    return node


def _directions(node: NodeBody) -> tuple[str, ...]:
    """Directions of the displacements of a node."""
    turns = ROTATIONS[node.dimension] if _body(node).rotates else ()
    return TRANSLATIONS[: node.dimension] + turns


def _check(node: NodeBody, values: dict[str, Any], directions: tuple[str, ...]) -> None:
    for direction in values:
        if direction not in directions:
            raise ModelError(
                f"{node.name}: unknown direction {direction!r}; known: {', '.join(directions)}"
            )


def _is_zero(value: Any) -> bool:
    expression = as_expression(value, "load") if isinstance(value, (str, Expression)) else value
    return (
        bool(expression.sx.is_zero())
        if isinstance(expression, Expression)
        else bool(expression == 0)
    )
