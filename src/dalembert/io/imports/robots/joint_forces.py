"""Springs, friction and rotors of joints in a model file."""

from __future__ import annotations

from typing import Any

from dalembert.io.imports.robots.parts import BALL, TURNING, Actuator, Joint
from dalembert.io.imports.toml_text import number_text


def joint_forces(joint: Joint, name: str, ends: list[str]) -> dict[str, dict[str, Any]]:
    """Ending of a name → force element of a joint.

    Parameters
    ----------
    joint : Joint
    name : of the joint in the model file
    ends : references to its frames
    """
    forces: dict[str, dict[str, Any]] = {}
    if joint.kind == BALL and joint.damping:
        return {"damper": _ball_damper(joint, *(end.partition(".")[0] for end in ends))}
    if not joint.has_angle:
        return forces
    turns = joint.kind == TURNING
    if joint.stiffness and turns:
        spring = {"type": "TorsionSpring", "connect": ends, "stiffness": joint.stiffness}
        forces["spring"] = spring | ({"free_angle": joint.rest} if joint.rest else {})
    elif joint.stiffness:
        extension = f"{name}.displacement"
        if joint.rest:
            extension = f"({extension} - {number_text(joint.rest)})"
        value = f"-{number_text(joint.stiffness)}*{extension}"
        forces["spring"] = {"type": "JointActuator", "joint": name, "value": value}
    if joint.damping or joint.friction:
        friction = {"coulomb": joint.friction, "viscous": joint.damping}
        forces["friction"] = {
            "type": "JointFriction",
            "joint": name,
            **{key: value for key, value in friction.items() if value},
        }
    if joint.inertia:
        forces["rotor"] = {
            "type": "JointActuator",
            "joint": name,
            "value": 0.0,
            "inertia": joint.inertia,
        }
    return forces


def free_damper(joint: Joint, body: str) -> dict[str, dict[str, Any]]:
    """Ending of a name → force or torque against the velocities of a free body.

    Parameters
    ----------
    joint : of kind ``FREE``
    body : name in the model file
    """
    factor = number_text(-joint.damping)
    velocity, spin = (
        [f"{factor}*{body}.{name}.{axis}" for axis in "xyz"]
        for name in ("velocity", "angular_velocity")
    )
    origin = {"body": body, "at": [0.0, 0.0, 0.0]}
    return {
        "damper": {"type": "Force", "connect": [origin], "vector": velocity},
        "rotational_damper": {"type": "Torque", "connect": [body], "vector": spin},
    }


def _ball_damper(joint: Joint, base: str, body: str) -> dict[str, Any]:
    """Moment against the relative angular velocity of two bodies."""
    factor = number_text(-joint.damping)
    spins = [f"{body}.angular_velocity.{axis}" for axis in "xyz"]
    torque: dict[str, Any] = {"type": "Torque", "connect": [body]}
    if base == "ground":
        return torque | {"vector": [f"{factor}*{spin}" for spin in spins]}
    relative = [f"({spin} - {base}.angular_velocity.{spin[-1]})" for spin in spins]
    return torque | {"vector": [f"{factor}*{spin}" for spin in relative], "reaction_on": base}


def actuator_formula(actuator: Actuator, control: str, coordinates: list[str]) -> str:
    """The force of an actuator along its length, a formula of the control and of measures.

    Parameters
    ----------
    control : name of the input
    coordinates : measures of the coordinates of its joints
    """
    coefficients = [coefficient for _, coefficient in actuator.joints]
    length = _sum([actuator.offset, *coefficients], ["", *coordinates])
    speed = _sum(coefficients, [f"{coordinate}_rate" for coordinate in coordinates])
    gain = _sum(actuator.gain, ["", length, speed])
    controlled = float(gain != "0.0")
    terms = [controlled, *actuator.bias], [_product(gain, control), "", length, speed]
    return within(_sum(*terms), actuator.force_range)


def within(formula: str, limits: tuple[float, float] | None) -> str:
    """A formula between two limits."""
    if limits is None:
        return formula
    lower, upper = map(number_text, limits)
    return f"min(max({formula}, {lower}), {upper})"


def sum_of(formulas: list[str]) -> str:
    """The sum of formulas."""
    return _sum([1.0] * len(formulas), formulas)


def scaled(coefficient: float, formula: str) -> str:
    """A formula times a number."""
    return _sum([coefficient], [formula])


def _sum(coefficients: list[float], factors: list[str]) -> str:
    """``2.0*a - b + 3.0``, without terms that are zero."""
    text = ""
    for coefficient, factor in zip(coefficients, factors, strict=True):
        if not coefficient:
            continue
        size, sign = number_text(abs(coefficient)), "-" if coefficient < 0 else "+"
        term = _product(size, factor) if factor else size
        if size == "1.0" and sign == "-" and _is_sum(factor):
            term = f"({factor})"
        text += f" {sign} {term}" if text else f"{'-' if sign == '-' else ''}{term}"
    return text or "0.0"


def _product(first: str, second: str) -> str:
    if first == "1.0":
        return second
    return "*".join(f"({part})" if _is_sum(part) else part for part in (first, second))


def _is_sum(text: str) -> bool:
    return " " in text or text.startswith("-")
