"""Forces as tendons, joint attributes and actuators of MuJoCo."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import ForceElement
from dalembert.elements.joint_forces import JointActuator, JointFriction
from dalembert.elements.loads import Couple, Gravity, PointForce
from dalembert.elements.springs import Actuator, AngularSpring, Spring, SpringDamper
from dalembert.io.exports.mjcf.document import MjcfDocument
from dalembert.io.exports.mjcf.loops import actuate, effort_law

WORLD = "world"
"""Name of the site at the origin of the inertial frame."""
VARIES = "it varies with time or state: the control holds its value at the start; set it there"


@singledispatch
def add_force(force: ForceElement, document: MjcfDocument) -> None:
    """Add a force, or record why there is none."""
    document.omit(force, type(force).__name__, "MuJoCo has no such force")


@add_force.register
def _(force: Gravity, document: MjcfDocument) -> None:
    value = document.start.constant(force.vector.sx)
    if value is None:
        (value,) = document.start.values(force.vector.sx)
        document.omit(force, "varying gravity", "MuJoCo has a constant one, that of the start")
    document.sections["option"].set(
        "gravity", " ".join(repr(float(x)) for x in np.pad(value, (0, 3 - value.size)))
    )


def _coefficients(force: Any, document: MjcfDocument, *formulas: ca.SX) -> list[float] | None:
    """Numbers of formulas; None and an omission if one of them varies."""
    values = [document.start.constant(formula) for formula in formulas]
    if any(value is None for value in values):
        document.omit(force, "varying coefficients", "MuJoCo has constant ones")
        return None
    return [float(value[0]) for value in values if value is not None]


def _without_law(force: SpringDamper, document: MjcfDocument) -> None:
    if force.law is not None:
        document.omit(force, "nonlinear law", "springs of MuJoCo are linear; this part is left out")


@add_force.register
def _(force: Spring, document: MjcfDocument) -> None:
    formulas = (force.stiffness.sx, force.damping.sx, force.free_length.sx)
    numbers = _coefficients(force, document, *formulas)
    _without_law(force, document)
    if numbers is not None:
        stiffness, damping, length = numbers
        values = {"stiffness": stiffness, "damping": damping, "springlength": length}
        document.spatial_tendon(force.name, force.end_points, **values)


@add_force.register
def _(force: AngularSpring, document: MjcfDocument) -> None:
    formulas = (force.stiffness.sx, force.damping.sx, force.free_angle.sx)
    numbers, relation = (
        _coefficients(force, document, *formulas),
        document.affine(force.coordinate()),  # type: ignore[attr-defined]
    )
    _without_law(force, document)
    if numbers is None:
        return
    if relation is None:
        document.omit(force, "torsion spring", "its angle is no combination of joint coordinates")
        return
    stiffness, damping, free = numbers
    row, offset = relation.coefficients[0], float(relation.constant[0])
    indices = np.flatnonzero(row)
    if len(indices) == 1:
        ratio = float(row[indices[0]])
        values = {"stiffness": stiffness * ratio**2, "springref": (free - offset) / ratio}
        name = document.tree.motions[indices[0]].name
        document.accumulate(name, **values, damping=damping * ratio**2)
        return
    length, sign = free - offset, 1.0
    if length < 0:  # lengths of springs are not negative in MuJoCo
        length, sign = -length, -1.0
    entries = {"stiffness": stiffness, "damping": damping, "springlength": length}
    document.fixed_tendon(force.name, sign * row, **entries)


@add_force.register
def _(force: JointFriction, document: MjcfDocument) -> None:
    numbers = _coefficients(force, document, force.viscous.sx, force.coulomb.sx)
    relation = document.affine(force.free_coordinate)
    if numbers is None:
        return
    indices: Any = [] if relation is None else np.flatnonzero(relation.coefficients[0])
    if relation is None or len(indices) != 1:
        document.omit(force, "friction", "it acts along no joint of the tree")
        return
    viscous, coulomb = numbers
    ratio, name = abs(relation.coefficients[0][indices[0]]), document.tree.motions[indices[0]].name
    document.accumulate(name, damping=viscous * ratio**2)
    if coulomb:
        document.accumulate(name, frictionloss=coulomb * ratio)
        document.omit(
            force, "smooth transition of dry friction", "frictionloss of MuJoCo is dry friction"
        )


@add_force.register
def _(force: JointActuator, document: MjcfDocument) -> None:
    relation = document.affine(force.free_coordinate)
    if relation is None:
        document.omit(force, "actuator", "its coordinate is no combination of joint coordinates")
        return
    actuate(document, force.name, relation, _value(force, force.value.sx, document))


def _value(force: Any, formula: ca.SX, document: MjcfDocument) -> float | None:
    """The constant effort; None if it is a control, whose value at the start is recorded."""
    value = document.start.constant(formula)
    if value is not None:
        document.ctrl.append(0.0)
        return float(value[0])
    (start,) = document.start.values(formula)
    document.ctrl.append(float(start[0]))
    document.omit(force, "formula of its effort", VARIES)
    return None


@add_force.register
def _(force: Actuator, document: MjcfDocument) -> None:
    document.spatial_tendon(force.name, force.end_points)
    law = effort_law(_value(force, force.force.sx, document))
    document.add("actuator", "general", name=force.name, tendon=force.name, **law)


@add_force.register
def _(force: PointForce, document: MjcfDocument) -> None:
    axes = force.axes()
    if axes is not None and axes is not force.point.body:
        document.omit(force, "force in the axes of another body", "actuators of MuJoCo push on it")
        return
    _wrench(
        force,
        document,
        force.point.body,
        force.vector.sx,
        axes is not None,
        document.place(force.point),
        0,
    )


@add_force.register
def _(force: Couple, document: MjcfDocument) -> None:
    vector, follows = getattr(force, "vector", None), getattr(force, "follows", None)
    formula = force.components() if vector is None else vector.sx
    planar = formula.numel() == 1
    if follows is not None and (follows is not force.body or force.reaction_on is not None):
        document.omit(force, "moment in the axes of another body", "actuators of MuJoCo push on it")
        return
    column = ca.vertcat(0, 0, formula) if planar else formula
    for body, sign in ((force.body, 1), (force.reaction_on, -1)):
        if body is not None and body.name != "ground":
            place = document.start.bodies[body.name].position
            _wrench(force, document, body, sign * column, follows is not None, place, 3, sign < 0)


def _wrench(
    force: Any,
    document: MjcfDocument,
    body: Any,
    components: ca.SX,
    following: bool,
    place: np.ndarray,
    first: int,
    reaction: bool = False,
) -> None:
    """Actuators of a force (``first`` is 0) or moment (3) on a body."""
    if body.name == "ground":
        return
    axes = "xyz"
    name = f"{force.name}.reaction" if reaction else force.name
    site = document.site_at(body.name, place, f"{name}.site")
    sites = {"site": site}
    if not following:
        sites["refsite"] = document.site_at("ground", np.zeros(3), WORLD)
    constant = document.start.constant(components)
    if constant is not None:
        gear = np.zeros(6)
        gear[first : first + constant.size] = constant
        document.add("actuator", "general", name=name, **sites, gear=gear, **effort_law(1.0))
        document.ctrl.append(0.0)
        return
    values = document.start.values(components)[0]
    for k, value in enumerate(values):
        if components[k].is_zero():
            continue
        gear = np.zeros(6)
        gear[first + k] = 1.0
        document.add("actuator", "general", name=f"{name}.{axes[k]}", **sites, gear=gear)
        document.ctrl.append(float(value))
    document.omit(force, "formula of its effort", VARIES)
