"""Copies of the nodes and finite elements of one model in another."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.fem.node import Node, RigidMotion
from dalembert.elements.fem.node_set import Nodes
from dalembert.errors import ModelError
from dalembert.model.supports_and_loads import SupportsAndLoads


@dataclass(frozen=True)
class Copied:
    """Copies of nodes and elements, by their names in the original.

    Attributes
    ----------
    nodes : name → node or set of nodes
    elements : name → element or set of elements
    """

    nodes: dict[str, Node | Nodes]
    elements: dict[str, StructuralElement | Elements]


def include(
    target: SupportsAndLoads, name: str, source: Any, velocity: Any, angular_velocity: Any
) -> Copied:
    """Add copies of nodes and elements under the names ``name_original``.

    Raises
    ------
    ModelError
        The source is no model of finite elements, or has supports, loads or parameters.
    """
    _check(name, source)
    motion = None
    if velocity is not None or angular_velocity is not None:
        motion = RigidMotion.of(name, source.dimension, velocity, angular_velocity)
    nodes: dict[str, Node | Nodes] = {}
    for old in source.nodes.values():
        label = f"{name}_{old.name}"
        if isinstance(old, Nodes):
            nodes[old.name] = target.add_nodes(label, old.points)
        else:
            nodes[old.name] = target.node(label, *old.position)
        nodes[old.name].motion = motion
    elements: dict[str, StructuralElement | Elements] = {}
    for part in source.elements.values():
        label = f"{name}_{part.name}"
        if isinstance(part, Elements):
            whole: Any = nodes[part.nodes.name]
            elements[part.name] = target.add_elements(
                label, part.cls, whole[part.nodes.index], part.cells, **part.numbers, **part.options
            )
        else:
            ties = {
                field.name: _tied(getattr(part, field.name), nodes)
                for field in dataclasses.fields(part)
                if not field.metadata and field.name != "name"
            }
            elements[part.name] = target.add(dataclasses.replace(part, name=label, **ties))
    return Copied(nodes, elements)


def _tied(ties: Any, nodes: dict[str, Any]) -> Any:
    """The copy of a node, or those of several."""
    return nodes[ties.name] if isinstance(ties, Nodal) else tuple(nodes[n.name] for n in ties)


def _check(name: str, source: Any) -> None:
    parts = source.elements.values() if isinstance(source, SupportsAndLoads) else ()
    if not parts or not all(isinstance(part, (StructuralElement, Elements)) for part in parts):
        raise ModelError(f"include() takes a model of finite elements; got {source!r}", name)
    own = {
        "supports": source.supports or source.fixed,
        "loads": source.loads or source.spread or source.temperatures,
        "initial conditions": any(source.initials.values()),
    }
    for kind, quantities in own.items():
        if quantities:
            raise ModelError(f"the included model has {kind}; give them to the copies", name)
    if source.parameters:
        raise ModelError(
            f"the included model has parameters of its own ({', '.join(source.parameters)}); "
            "declare them with parameter(...) of the model that includes it",
            name,
        )
