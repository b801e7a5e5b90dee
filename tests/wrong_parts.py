"""Wrong beams, contacts, cables, gaps and flexible bodies in model files, as wrong_models."""

from __future__ import annotations

from good_model import added


def beam(**keys: str) -> str:
    rigid = {"axial_rigidity": "1e4", "shear_rigidity": "1e4", "bending_rigidity": "1"}
    good = {"length": "0.5", "frame_i": '"ground.O2"', "mass_per_length": "0.1"}
    return added("[beams.leaf]", **(rigid | good | keys))


def contact(**keys: str) -> str:
    good = {
        "shape_i": '{ type = "Circle", point = "disc", radius = 0.1 }',
        "shape_j": '{ type = "HalfPlane", point = "ground.O2", normal = [0, 1] }',
        "law": '{ type = "Hertz", stiffness = 1e5 }',
    }
    return added('[forces.touch]\ntype = "Contact"', **(good | keys))


def floor(**keys: str) -> str:
    good = {"distance": '"disc.y + 9"', "restitution": "0.5"}
    return added('[forces.floor]\ntype = "UnilateralConstraint"', **(good | keys))


def flexible(**keys: str) -> str:
    good = {"type": '"FlexibleBody"', "structure": '"arm.toml"', "interface": '{ pin = "n0" }'}
    return added("[bodies.arm]", **(good | keys))


PARTS: dict[str, tuple[str, list[str]]] = {
    "beam without length": (beam(length=""), ["beams.leaf.length", "missing"]),
    "beam of no length": (beam(length="0"), ["beams.leaf.length", "0 m", "above 0"]),
    "beam of no elements": (beam(elements="0"), ["beams.leaf", "elements is 0", "from 1"]),
    "beam of too many elements": (
        beam(elements="1000000"),
        ["beams.leaf", "elements = 1000000", "memory", "fewer"],
    ),
    "beam of unknown order": (beam(order="7"), ["beams.leaf", "order is 7", "1, 2, 3 or 4"]),
    "beam to itself": (beam(frame_i='"leaf.end"'), ["beams.leaf.frame_i", "leaf", "before it"]),
    "beam clamped and placed": (beam(angle="1"), ["beams.leaf", "angle", "frame_i", "leave one"]),
    "beam of a taken name": (
        beam().replace("[beams.leaf]", "[beams.crank]"),
        ["beams.crank", "already used by bodies.crank"],
    ),
    "contact without law": (contact(law=""), ["forces.touch.law", "missing"]),
    "contact of an unknown law": (
        contact(law='{ type = "Herz", stiffness = 1 }'),
        ["forces.touch.law", "'Herz'", "did you mean 'Hertz'"],
    ),
    "contact that gives energy": (
        contact(law='{ type = "Restitution", e = 2 }'),
        ["forces.touch", "e is above 1: 2", "give 0 to 1"],
    ),
    "contact of unknown shapes": (
        contact(shape_i='{ type = "HalfPlane", point = "disc", normal = [0, 1] }'),
        ["forces.touch", "HalfPlane and HalfPlane", "Circle–Circle"],
    ),
    "contact of a dented polygon": (
        contact(
            shape_i='{ type = "Polygon", body = "disc", vertices = [[0,0],[2,0],[1,0.1],[0,2]] }'
        ),
        ["forces.touch", "dent", "several convex polygons"],
    ),
    "contact with itself": (
        contact(shape_j='{ type = "Circle", point = "disc.P", radius = 0.1 }'),
        ["forces.touch", "ties disc to itself"],
    ),
    "friction that grows": (
        contact(friction='{ type = "Coulomb", dynamic = 0.4, static = 0.2 }'),
        ["forces.touch", "0.2", "below dynamic=", "0.4"],
    ),
    "cable of one point": (
        added('[forces.rope]\ntype = "Cable"', points='["disc"]', length="1", stiffness="1"),
        ["forces.rope", "at least two, got 1"],
    ),
    "cable to where it is": (
        added(
            '[forces.rope]\ntype = "Cable"',
            points='["disc.P", "disc.P", "crank.end"]',
            length="1",
            stiffness="1",
        ),
        ["forces.rope", "points[0] and points[1]", "give it once"],
    ),
    "gap that nothing moves": (
        floor(distance="1.0"),
        ["forces.floor", "does not depend on any position", "a body's y"],
    ),
    "slip of no speed": (
        floor(slip='"disc.x"'),
        ["forces.floor", "does not depend on any speed", "a body's vx"],
    ),
    "friction of no slip": (floor(friction="0.3"), ["forces.floor", "friction is 0.3", "slip="]),
    "gap of a speed": (floor(distance='"disc.vy"'), ["forces.floor", "disc.vy", "positions"]),
    "no structure": (
        flexible(structure='"wrong.toml"'),
        ["bodies.arm.structure", "wrong.toml is no structure", 'kind = "structure"'],
    ),
    "structure that is not there": (
        flexible(),
        ["bodies.arm.structure", "arm.toml", "no such file"],
    ),
    "no interface": (flexible(interface="{}"), ["bodies.arm.interface", "got none"]),
}
