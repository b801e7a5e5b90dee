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
from dalembert.io.exports.rigid.kinematics import Affine
from dalembert.symbolic.formulas.inputs import Input

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
        reason = "its coordinate is no combination of joint coordinates"
        document.omit(force, "actuator", reason)
        if not force.rotor.is_zero():
            document.omit(force, "inertia of the rotor", reason)
        return
    _add_rotor(force, relation, document)
    actuate(document, force.name, relation, _law(force, force.value.sx, document))


def _add_rotor(force: JointActuator, relation: Affine, document: MjcfDocument) -> None:
    """The inertia of a rotor as the armature of its joint."""
    if force.rotor.is_zero():
        return
    numbers = _coefficients(force, document, force.rotor)
    indices = np.flatnonzero(relation.coefficients[0])
    if numbers is None or len(indices) != 1:
        if numbers is not None:
            document.omit(force, "inertia of the rotor", "it turns with several joints of the tree")
        return
    ratio = float(relation.coefficients[0][indices[0]])
    document.accumulate(document.tree.motions[indices[0]].name, armature=numbers[0] * ratio**2)


def _law(force: Any, formula: ca.SX, document: MjcfDocument) -> dict[str, Any]:
    """Attributes of an actuator: a control per input, a constant effort, or the effort itself.

    An effort that is affine in one input of the model has this input as its control.
    """
    for name, entry in document.start.model.inputs.items():
        if ca.depends_on(formula, entry.signal.sx):
            law = _controlled(formula, name, entry, document)
            if law is not None:
                return law
    value = document.start.constant(formula)
    if value is not None:
        document.ctrl.append(0.0)
        return effort_law(float(value[0]))
    (start,) = document.start.values(formula)
    document.ctrl.append(float(start[0]))
    document.omit(force, "formula of its effort", VARIES)
    return {}


def _controlled(
    formula: ca.SX, name: str, entry: Input, document: MjcfDocument
) -> dict[str, Any] | None:
    """Attributes of an actuator ``b + g u`` with the input ``u`` as control; None for another."""
    signal = entry.signal.sx
    if not signal.is_symbolic():  # a formula of time
        return None
    slope = ca.jacobian(formula, signal)
    others = [i.signal.sx for n, i in document.start.model.inputs.items() if n != name]
    rest = ca.substitute(formula, signal, ca.SX(0))
    if ca.depends_on(slope, signal) or any(ca.depends_on(formula, other) for other in others):
        return None
    gain, bias = document.start.constant(slope), document.start.constant(rest)
    if gain is None or bias is None:
        return None
    (start,) = document.start.values(signal)
    document.ctrl.append(float(start[0]))
    law: dict[str, Any] = {"gainprm": float(gain[0])}
    if bias[0]:
        law |= {"biastype": "affine", "biasprm": [float(bias[0]), 0.0, 0.0]}
    low, high = entry.bounds or (-np.inf, np.inf)
    if np.isfinite(low) and np.isfinite(high):
        law |= {"ctrllimited": "true", "ctrlrange": [float(low), float(high)]}
    return law


@add_force.register
def _(force: Actuator, document: MjcfDocument) -> None:
    document.spatial_tendon(force.name, force.end_points)
    law = _law(force, force.force.sx, document)
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
