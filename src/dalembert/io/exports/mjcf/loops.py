"""Constraints outside of the tree as equalities of MuJoCo."""

from __future__ import annotations

from collections import Counter
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements import planar, spatial
from dalembert.elements.driver import Driver
from dalembert.elements.pair import ConstantDistance
from dalembert.io.exports.mjcf.bodies import add_body
from dalembert.io.exports.mjcf.document import STIFF, MjcfDocument
from dalembert.io.exports.rigid.joints import CLOSED_BY_POINTS, relation_of, sequence_of
from dalembert.io.exports.rigid.kinematics import Affine
from dalembert.io.exports.rigid.tree import TreeBody, carried
from dalembert.symbolic.formulas.expression import stack

WELDS = (planar.Weld, spatial.Weld)
DISTANCES = (ConstantDistance, planar.DistanceDriver, spatial.DistanceDriver)


def split_bodies(document: MjcfDocument) -> dict[str, str]:
    """Joint in a loop → body that is split, half of it carried by the joint.

    Joints that slide have no equality of their own in MuJoCo.
    """
    halves, bodies = {}, document.start.bodies
    for joint in document.tree.loops:
        if sequence_of(joint) is None or isinstance(joint, CLOSED_BY_POINTS):
            continue
        if relation_of(joint) is not None:
            continue
        ends = [body.name for body in joint.ends()[::-1]]
        massive = [name for name in ends if name != "ground" and bodies[name].mass > 0]
        if massive:
            halves[joint.name] = massive[0]
    return halves


def shares_of_mass(halves: dict[str, str]) -> dict[str, float]:
    """Split body → share of its mass in each of its parts."""
    return {name: 1 / (count + 1) for name, count in Counter(halves.values()).items()}


def add_halves(document: MjcfDocument, halves: dict[str, str]) -> list[TreeBody]:
    """Add the halves of bodies to the tree and weld them to the others."""
    shares, added = shares_of_mass(halves), []
    for joint in document.tree.loops:
        if joint.name not in halves:
            continue
        name = halves[joint.name]
        carrier = next(body.name for body in joint.ends() if body.name != name)
        half, _ = carried(document.start, name, carrier, joint, document.tree.spins)
        label = f"{name}.{joint.name}"
        half = TreeBody(
            label, half.parent, joint.name, half.position, half.axes, half.motions, half.body
        )
        add_body(document, half, shares[name])
        added.append(half)
        kind, entries = "weld", {}
        if not half.body.rotates:
            kind, entries = "connect", {"anchor": np.zeros(3)}
        document.add("equality", kind, name=joint.name, body1=name, body2=label, **entries, **STIFF)
    return added


def add_equality(document: MjcfDocument, constraint: Any) -> None:
    """Add a constraint as equalities, or record why there is none."""
    if isinstance(constraint, CLOSED_BY_POINTS):
        _close(document, constraint)
    elif isinstance(constraint, DISTANCES) and _is_constant(document, constraint):
        document.spatial_tendon(constraint.name, constraint.end_points)
        document.add("equality", "tendon", name=constraint.name, tendon1=constraint.name, **STIFF)
    elif constraint.slip.numel():
        document.omit(
            constraint, "rolling or sliding without slip", "MuJoCo has no nonholonomic constraints"
        )
    elif isinstance(constraint, Driver) and not _is_constant(document, constraint):
        _drive(document, constraint)
    else:
        _affine(document, constraint, constraint.equations)


def _is_constant(document: MjcfDocument, constraint: Any) -> bool:
    """Whether a prescribed length or angle is a number."""
    pair = constraint.measured_and_target()
    return pair is not None and document.start.constant(pair[1]) is not None


def _close(document: MjcfDocument, joint: Any) -> None:
    """Close a loop by coincident points."""
    ends, sequence = list(joint.ends()), sequence_of(joint)
    assert sequence is not None
    first, second = ends if ends[0].name != "ground" else ends[::-1]
    bodies = {"body1": first.name, "body2": document.body_name(second)}
    if isinstance(joint, WELDS) and all(body.rotates for body in ends):
        document.add("equality", "weld", name=joint.name, **bodies, **STIFF)
        return
    place, body = document.place(sequence.anchor), document.start.bodies[first.name]
    places = [place]
    if isinstance(joint, spatial.Revolute):
        (axis,) = document.start.values(joint.frame_i.axis)
        places.append(place + document.size * axis)
    for k, anchor in enumerate(places):
        name = joint.name if k == 0 else f"{joint.name}.axis"
        local = body.local(anchor)
        document.add("equality", "connect", name=name, **bodies, anchor=local, **STIFF)


def add_relations(document: MjcfDocument) -> None:
    """Relations between the motions of joints in the tree, such as the pitch of a screw."""
    joints = {joint.name: joint for joint in document.model.constraints}
    for body in document.tree.bodies:
        relation = relation_of(joints[body.joint]) if body.joint else None
        if relation is not None:
            _affine(document, joints[body.joint], relation)


def _affine(document: MjcfDocument, constraint: Any, equations: ca.SX) -> None:
    """A linear relation of coordinates, such as that of gears."""
    others = stack(group.pose for group in constraint.own_coordinates())
    relation = document.kinematics.affine(equations, others)
    if relation is None:
        document.omit(
            constraint,
            f"constraint {type(constraint).__name__}",
            "MuJoCo has no such equality; the file has more degrees of freedom",
        )
        return
    rows = [row for row in independent(relation.coefficients) if np.any(row)]
    for k, row in enumerate(rows):
        name = constraint.name if k == 0 else f"{constraint.name}.{k}"
        add_relation(document, name, row)


def independent(table: np.ndarray) -> np.ndarray:
    """Independent rows that span those of a table."""
    if not table.size:
        return table
    _, sizes, right = np.linalg.svd(table)
    rank = int((sizes > 1e-9 * sizes.max(initial=0.0)).sum())
    return table if rank == len(table) else right[:rank]


def add_relation(document: MjcfDocument, name: str, row: np.ndarray) -> None:
    """``Σ c (q − q_start) = 0``, which holds at the start."""
    indices, motions = np.flatnonzero(row), document.tree.motions
    if len(indices) > 2:
        document.fixed_tendon(name, row)
        document.add("equality", "tendon", name=name, tendon1=name, **STIFF)
        return
    first = max(indices, key=lambda k: abs(row[k]))
    other = next((k for k in indices if k != first), None)
    ratio = 0.0 if other is None else -row[other] / row[first]
    names = {"joint1": motions[first].name}
    names |= {} if other is None else {"joint2": motions[other].name}
    polynomial = [0.0, ratio, 0.0, 0.0, 0.0]
    document.add("equality", "joint", name=name, **names, polycoef=polynomial, **STIFF)


def _drive(document: MjcfDocument, driver: Driver) -> None:
    """An actuator in place of a prescribed motion."""
    reason = "MuJoCo integrates forces and has no prescribed motions"
    relation = document.affine(driver.coordinate())
    if isinstance(driver, DISTANCES):
        document.spatial_tendon(driver.name, driver.end_points)
        document.add("actuator", "general", name=driver.name, tendon=driver.name)
    elif relation is not None:
        actuate(document, driver.name, relation)
    else:
        document.omit(driver, "prescribed motion", reason)
        return
    document.ctrl.append(0.0)
    document.omit(
        driver,
        "prescribed motion",
        f"{reason}; its effort is the control of actuator {driver.name!r}",
    )


def actuate(
    document: MjcfDocument, name: str, relation: Affine, law: dict[str, Any] | None = None
) -> None:
    """Add an actuator along an affine coordinate.

    Parameters
    ----------
    law : attributes of its effort; None for one that is the control
    """
    row = relation.coefficients[0]
    indices = np.flatnonzero(row)
    law = law or {}
    if len(indices) == 1:
        joint = document.tree.motions[indices[0]].name
        document.add("actuator", "general", name=name, joint=joint, gear=row[indices[0]], **law)
    else:
        document.fixed_tendon(name, row)
        document.add("actuator", "general", name=name, tendon=name, **law)


def effort_law(value: float | None) -> dict[str, Any]:
    """Attributes of an actuator with a constant effort, or with its control as the effort."""
    if value is None:
        return {}
    return {"gainprm": 0.0, "biastype": "affine", "biasprm": [value, 0.0, 0.0]}
