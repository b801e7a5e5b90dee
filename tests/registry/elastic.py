"""Beams, and elements of structures between bodies."""

from __future__ import annotations

import numpy as np
from twins import cross, direction, left, length, turn

from dalembert import planar, structures
from registry.cases import P, Q, case


def _beam(c):
    # one element of first order: strains in its middle, by the slopes of the straight line there
    along = (Q(c) - P(c)) / c.p.L
    first, second = c.a.phi + c.p.angle_i, c.b.phi + c.p.angle_j
    middle, bend = (first + second) / 2, (second - first) / c.p.L
    speed, spin = c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c)), (c.a.w + c.b.w) / 2
    arc = c.p.bend * c.p.L  # of the natural shape
    natural = turn(-arc / 2, np.array([np.sin(arc), 1 - np.cos(arc)]) / arc)
    strain = turn(-middle, along) - natural
    rate = turn(-middle, speed / c.p.L - spin * left(along))
    rigid = np.array([c.p.EA, c.p.GA])
    force = turn(middle, rigid * (strain + c.p.lead * rate))
    moment = c.p.EI * (bend - c.p.bend + c.p.lead * (c.b.w - c.a.w) / c.p.L)
    shear = c.p.L / 2 * cross(along, force)
    return [("a", force, P(c), moment + shear), ("b", -force, Q(c), -moment + shear)]


@case("beam", planar.Beam, loads=_beam)
def _(q):
    numbers = q.numbers(L=0.9, bend=0.3, EA=40.0, GA=25.0, EI=3.0, lead=0.1)
    length, bend, axial, shear, bending, lead = numbers
    angles = q.numbers(angle_i=0.3, angle_j=-0.2)
    q.add(
        planar.Beam(
            "F",
            *q.points(),
            length=length,
            curvature=bend,
            axial_rigidity=axial,
            shear_rigidity=shear,
            bending_rigidity=bending,
            damping=lead,
            angle_i=angles[0],
            angle_j=angles[1],
            elements=1,
            order=1,
        )
    )


def _line(c):
    """The beam, and a disc of the ground that its stations touch, with friction."""
    drum, forces = np.array([c.p.D_x, c.p.D_y]), _beam(c)
    ends = (("a", c.a, P(c)), ("b", c.b, Q(c)))
    for share in (0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)):
        shares = 1 - share, share
        center = sum(n * place for n, (_, _, place) in zip(shares, ends, strict=True))
        moved = sum(n * b.velocity_at(r) for n, (_, b, r) in zip(shares, ends, strict=True))
        spin = sum(n * b.w for n, (_, b, _) in zip(shares, ends, strict=True))
        normal = (center - drum) / length(center - drum)
        depth = c.p.drum + c.p.half - length(center - drum)
        if np.real(depth) <= 0:
            continue
        arm = -normal * (c.p.half - depth / 2)
        factor = 1 - c.p.d * (moved @ normal)
        press = c.p.k / 2 * depth**c.p.power * (factor if np.real(factor) > 0 else 0.0)
        slip = (moved + spin * left(arm)) @ -left(normal)
        x = np.sqrt((slip / c.p.transition) ** 2 + 1e-12)
        rub = press * c.p.dynamic * np.tanh(4 * x) * slip / c.p.transition / x
        force = press * normal + rub * left(normal)
        moment = cross(arm, force)
        forces += [
            (name, n * force, place, n * moment)
            for n, (name, _, place) in zip(shares, ends, strict=True)
        ]
    return forces


@case("beam on a disc", planar.Contact, loads=_line, objective=False)
def _(q):
    axial, shear, bending, lead = q.numbers(EA=40.0, GA=25.0, EI=3.0, lead=0.1)
    size, bend = q.numbers(L=0.9, bend=0.3)
    angles = q.numbers(angle_i=0.3, angle_j=-0.2)
    beam = q.add(
        planar.Beam(
            "B",
            *q.points(),
            length=size,
            curvature=bend,
            axial_rigidity=axial,
            shear_rigidity=shear,
            bending_rigidity=bending,
            damping=lead,
            angle_i=angles[0],
            angle_j=angles[1],
            elements=1,
            order=1,
        )
    )
    k, d, power = q.numbers(k=80.0, d=0.3, power=1.5)
    dynamic, transition = q.numbers(dynamic=0.3, transition=0.9)
    kit, drum = planar.contact, q.point(q.ground, "D", 0.8, 0.7)
    q.add(
        planar.Contact(
            "F",
            kit.Circle(drum, q.number("drum", 0.5)),
            kit.BeamLine(beam, q.number("half", 0.1), stations=2),
            law=kit.HuntCrossley(stiffness=k, damping=d, exponent=power),
            friction=kit.Coulomb(dynamic, slip_speed=transition),
        )
    )


def _chord(c):
    """Between two nodes: natural length, length, direction and turn."""
    before = np.array([c.p.b_x0 - c.p.a_x0, c.p.b_y0 - c.p.a_y0])
    now = c.b.r - c.a.r
    turned = direction(turn(-direction(before), now))
    return length(before), length(now), now / length(now), turned


def _truss(c):
    natural, stretched, along, _ = _chord(c)
    strain = stretched / natural - 1 - c.p.alpha * c.p.heat
    force = c.p.E * c.p.A * strain * along
    return [("a", force, c.a.r, 0.0), ("b", -force, c.b.r, 0.0)]


def _nodes(q, kind):
    return (
        q.body("a", (0.3, -0.2, 0.1), (0.5, -0.3, 0.7), kind=kind),
        q.body("b", (1.1, 0.5, -0.2), (-0.2, 0.4, -1.1), 0.8, 0.13, kind=kind),
    )


@case("truss", planar.PointNode, structures.Truss, loads=_truss)
def _(q):
    area, modulus, expansion, heat = q.numbers(A=0.02, E=8000.0, alpha=0.01, heat=2.0)
    numbers = {"area": area, "modulus": modulus, "expansion": expansion, "temperature": heat}
    q.add(structures.Truss("F", *_nodes(q, planar.PointNode), **numbers))


def _frame(c):
    natural, stretched, along, turned = _chord(c)
    first, second = c.a.phi - c.p.a_angle0 - turned, c.b.phi - c.p.b_angle0 - turned
    longer = natural * (2 * first**2 - first * second + 2 * second**2) / 30
    axial = c.p.E * c.p.A * (stretched - natural + longer) / natural
    bend = 2 * c.p.E * c.p.I / natural
    moment_a = bend * (2 * first + second) + axial * natural * (4 * first - second) / 30
    moment_b = bend * (first + 2 * second) + axial * natural * (4 * second - first) / 30
    force = axial * along - (moment_a + moment_b) / stretched * left(along)
    return [("a", force, c.a.r, -moment_a), ("b", -force, c.b.r, -moment_b)]


@case("plane frame", planar.Node, structures.Frame, loads=_frame)
def _(q):
    area, bending, modulus = q.numbers(A=0.02, I=2e-3, E=3000.0)
    numbers = {"area": area, "second_moment": bending, "modulus": modulus}
    q.add(structures.Frame("F", *_nodes(q, planar.Node), **numbers))
