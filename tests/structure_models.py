"""Small structures in general position, one for every kind of element, every number a parameter."""

from __future__ import annotations

import functools

import numpy as np

import dalembert as da
from dalembert import structures
from dalembert.elements.fem.continuum import Continuum
from dalembert.elements.fem.registry import SHAPES
from dalembert.model.assembled.model import StructuralModel


def triangle(kind: type, dimension: int, numbers: dict[str, float]) -> StructuralModel:
    """Lines between all nodes in general position, held as little as can be, pushed at all."""
    structure, rng = da.Structure(kind.__name__), np.random.default_rng(dimension)
    count = max(dimension + 1, 3)
    corners = np.vstack([np.zeros(dimension), np.eye(dimension), 2 * np.eye(dimension)])[:count]
    nodes = []
    for k, place in enumerate(corners + rng.uniform(-0.2, 0.2, corners.shape)):
        coordinates = (structure.parameter(f"x{k}{i}", float(c)) for i, c in enumerate(place))
        nodes.append(structure.node(f"n{k}", *coordinates))
    for i in range(count):
        for j in range(i):
            factor = 1.0 + 0.2 * len(structure.elements)
            arguments = {
                name: structure.parameter(f"{name}{j}{i}", factor * value)
                for name, value in numbers.items()
            }
            structure.add(kind(f"e{j}{i}", nodes[j], nodes[i], **arguments))
    structure.support(nodes[0])
    for k, node in enumerate(nodes[1:dimension], 1):
        structure.support(node, **{f"u{'xyz'[i]}": 0.0 for i in range(k, dimension)})
    for node in nodes[1:]:
        for i, c in enumerate("xyz"[:dimension]):
            if (node.name, f"u{c}") not in structure.supports:
                force = structure.parameter(f"F{c}_{node.name}", -0.01 - 0.003 * i)
                structure.load(node, case="push", **{f"f{c}": force})
    return structure.build()


def cell(kind: type) -> StructuralModel:
    """One cell, stretched, sheared and bent a little, held at one face and pressed at another."""
    structure = da.Structure(kind.__name__)
    stretch, shear = structure.parameter("stretch", 1.3), structure.parameter("shear", 0.2)
    rng, places = np.random.default_rng(1), np.array(kind.cell.nodes, dtype=float)
    places += rng.uniform(-0.05, 0.05, places.shape)
    nodes = [
        structure.node(f"n{k}", stretch * place[0] + shear * place[1], *map(float, place[1:]))
        for k, place in enumerate(places)
    ]
    inputs = {"modulus": 3.0, "poisson": 0.3, "density": 2.0}
    if kind.cell.dimension == 2:
        inputs["thickness"] = 0.4
    numbers = {name: structure.parameter(name, value) for name, value in inputs.items()}
    structure.add(kind("cell", nodes, **numbers))
    natural = np.array(kind.cell.nodes)
    low, high = (natural[:, 0] == end for end in (natural[:, 0].min(), natural[:, 0].max()))
    force = structure.parameter("F", -0.01)
    for k, node in enumerate(nodes):
        if low[k]:
            structure.support(node)
        elif high[k]:
            structure.load(node, case="push", fx=force, fy=0.3 * force)
            last = node
    spring = {"stiffness_x": structure.parameter("k", 0.1), "stiffness_y": 0.2}
    structure.add(structures.GroundSpring("spring", last, **spring))  # no symmetry
    return structure.build()


def corner(kind: type, **more) -> StructuralModel:
    """Two beams of space round a corner."""
    structure = da.Structure(kind.__name__)
    inputs = {
        "area": 0.5,
        "second_moment_y": 0.03,
        "second_moment_z": 0.05,
        "torsion_constant": 0.06,
        "modulus": 3.0,
        "shear_modulus": 1.2,
        "density": 2.0,
    } | more
    numbers = {name: structure.parameter(name, value) for name, value in inputs.items()}
    length = structure.parameter("L", 1.4)
    nodes = [
        structure.node(f"n{k}", *place)
        for k, place in enumerate([(0, 0, 0), (length, 0.2, 0.1), (length, 0.3, 1.2)])
    ]
    for k in range(2):
        structure.add(kind(f"e{k}", nodes[k], nodes[k + 1], **numbers))
    structure.support(nodes[0])
    force = structure.parameter("F", -0.01)
    structure.load(nodes[2], case="push", fx=force, fy=0.5 * force, fz=2 * force)
    return structure.build()


def attached() -> StructuralModel:
    """A frame with a mass and its inertia at its end, on springs."""
    structure = da.Structure("attached")
    length = structure.parameter("L", 1.4)
    nodes = [structure.node("n0", 0, 0), structure.node("n1", length, 0.3)]
    arguments = {"area": 0.5, "second_moment": 0.04, "modulus": 3.0}
    structure.add(structures.Frame("e", *nodes, **arguments))
    tip = nodes[1]
    stiffness = {"stiffness_x": structure.parameter("k", 0.2), "stiffness_y": 0.1}
    structure.add(structures.GroundSpring("spring", tip, **stiffness))
    structure.add(structures.PointMass("mass", tip, mass=structure.parameter("m", 3.0)))
    turning = structure.parameter("J", 0.4)
    structure.add(structures.PointInertia("inertia", tip, inertia_z=turning))
    structure.support(nodes[0])
    force = structure.parameter("F", -0.01)
    structure.load(tip, case="push", fx=force, fy=0.4 * force)
    return structure.build()


BAR = {"area": 0.5, "modulus": 3.0, "density": 2.0}
SHEAR = {"shear_modulus": 1.3, "shear_area": 0.3}
CELLS = {cls.__name__: functools.partial(cell, cls) for cls in SHAPES if issubclass(cls, Continuum)}
LINES = {
    f"{cls.__name__} {dimension}-D": functools.partial(triangle, cls, dimension, numbers)
    for cls, dimensions, numbers in (
        (structures.AxialSpring, (2, 3), {"stiffness": 2.0}),
        (structures.Truss, (1, 2, 3), BAR),
        (structures.Frame, (2,), BAR | {"second_moment": 0.04}),
        (structures.TimoshenkoFrame, (2,), BAR | {"second_moment": 0.04} | SHEAR),
    )
    for dimension in dimensions
}
MODELS = (
    LINES
    | CELLS
    | {
        "SpaceFrame": functools.partial(corner, structures.SpaceFrame),
        "TimoshenkoSpaceFrame": functools.partial(
            corner, structures.TimoshenkoSpaceFrame, shear_area_y=0.3, shear_area_z=0.35
        ),
        "attached": attached,
    }
)
MASSIVE = [name for name in MODELS if not name.startswith("AxialSpring")]
COMPRESSED = [name for name in MODELS if not name.endswith("1-D")]


@functools.cache
def model_of(name: str) -> StructuralModel:
    """The one of this name."""
    return MODELS[name]()


def floating(count: int = 4) -> da.Structure:
    structure = da.Structure("floating beam")
    rho = structure.parameter("rho", 2.0)
    length = structure.parameter("L", 3.0)
    nodes = [structure.node(f"n{k}", length * k / count, 0.0) for k in range(count + 1)]
    for k in range(count):
        arguments = {"area": 0.5, "second_moment": 0.04, "modulus": 3.0, "density": rho}
        structure.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **arguments))
    return structure
