"""Structures and flexible bodies that several tests share."""

import numpy as np

import dalembert as da
from dalembert import planar, spatial
from dalembert.structures import Frame, SpaceFrame, box_mesh, rectangle_mesh

KINDS = {2: planar, 3: spatial}
ENDS = {"root": "n0", "tip": "n4"}


def beam(
    dimension: int,
    count: int = 4,
    modulus: float = 2e9,
    clamped: bool = False,
    gravity: tuple[float, ...] = (),
):
    """A slender beam of a metre along x, a little bent, so that nothing is symmetric."""
    structure = da.Structure("beam")
    bow = [0.05 * s * (1 - s) for s in np.linspace(0, 1, count + 1)]
    places = [(k / count, bow[k], 0.3 * bow[k])[:dimension] for k in range(count + 1)]
    nodes = [structure.node(f"n{k}", *place) for k, place in enumerate(places)]
    beam = {"area": 1e-4, "modulus": structure.parameter("E", modulus), "density": 1000.0}
    kind = Frame
    if dimension == 3:
        kind, beam["orientation"] = SpaceFrame, (0.0, 1.0, 0.0)
        beam |= {"second_moment_y": 1e-8, "second_moment_z": 2e-8, "torsion_constant": 3e-8}
        beam["shear_modulus"] = 8e8
    else:
        beam["second_moment"] = 1e-8
    for k in range(count):
        structure.add(kind(f"e{k}", nodes[k], nodes[k + 1], **beam))
    if clamped:
        structure.support(nodes[0])
    if gravity:
        structure.gravity(*gravity)
    return structure.build()


def write_beam(folder, dimension: int) -> None:
    """The file of a structure, ``beam.toml``."""
    more = "second_moment = 1e-8"
    if dimension == 3:
        more = "second_moment_y = 1e-8\nsecond_moment_z = 1e-8\ntorsion_constant = 2e-8"
        more += "\nshear_modulus = 8e8\norientation = [0, 1, 0]"
    kind, zeros = ("Frame", "0") if dimension == 2 else ("SpaceFrame", "0, 0")
    text = f'''format = 1
kind = "structure"
[parameters]
E = 1e9
[nodes]
n0 = [0, {zeros}]
n1 = [1, {zeros}]
[elements.bar]
type = "{kind}"
connect = ["n0", "n1"]
area = 1e-4
modulus = "E"
density = 1000
{more}
'''
    (folder / "beam.toml").write_text(text, encoding="utf-8")


def block(dimension: int):
    """A block of solid elements, and its ends."""
    structure, size = da.Structure("block"), (1.0, 0.1, 0.15)[:dimension]
    source = rectangle_mesh(size, (6, 1)) if dimension == 2 else box_mesh(size, (4, 1, 1))
    solid = {"modulus": 1e7, "poisson": 0.3, "density": 1000.0}
    solid |= {"thickness": 0.1} if dimension == 2 else {}
    nodes = structure.add_mesh("m", source, **solid).nodes()
    return structure.build(), {"root": nodes.where(x=0.0), "tip": nodes.where(x=1.0)}


def flexible(dimension: int, structure=None, **options):
    """A body of it, held nowhere yet."""
    options = {"interface": ENDS, "modes": 1, "reference": "root"} | options
    return KINDS[dimension].FlexibleBody("rod", structure or beam(dimension), **options)


def tapered(dimension: int, count: int = 4):
    """A beam whose thickness, length, modulus and density are parameters; nothing is symmetric."""
    structure = da.Structure("beam")
    parameters = {"h": 0.03, "L": 1.0, "E": 2e9, "rho": 1000.0}
    h, length, modulus, density = (structure.parameter(*pair) for pair in parameters.items())
    nodes = []
    for k in range(count + 1):
        s = k / count
        place = (length * s, 0.05 * length * s * (1 - s), 0.02 * length * s)[:dimension]
        nodes.append(structure.node(f"n{k}", *place))
    for k in range(count):
        own = h * (1 - 0.1 * k)
        beam = {"area": 0.01 * own, "modulus": modulus, "density": density}
        kind, bending = Frame, 0.01 * own**3 / 12
        if dimension == 2:
            beam["second_moment"] = bending
        else:
            kind, beam["orientation"] = SpaceFrame, (0.0, 1.0, 0.0)
            beam |= {"second_moment_y": bending, "second_moment_z": 8e-8 * own / 12}
            beam |= {"torsion_constant": 0.01 * own**3 / 3, "shear_modulus": modulus / 2.6}
        structure.add(kind(f"e{k}", nodes[k], nodes[k + 1], **beam))
    return structure.build()
