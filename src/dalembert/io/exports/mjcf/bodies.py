"""Bodies and joints of an MJCF file."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as xml

import numpy as np
from scipy.spatial.transform import Rotation

from dalembert.errors import UnsupportedError
from dalembert.io.exports.mjcf.document import MjcfDocument, texts
from dalembert.io.exports.rigid.start import RigidBody
from dalembert.io.exports.rigid.tree import Motion, TreeBody

SMALLEST = 1e-14
"""Lower limit of masses and moments of inertia of moving bodies in MuJoCo [kg], [kg m²]."""


def add_body(document: MjcfDocument, body: TreeBody, share: float = 1.0) -> None:
    """Add a body with its joints to its carrier.

    Parameters
    ----------
    share : of its mass; the rest belongs to copies that close loops

    Raises
    ------
    UnsupportedError
        A moving body without mass.
    """
    quaternion = None if np.allclose(body.axes, np.eye(3), atol=1e-15) else euler(body.axes)
    attributes = texts({"name": body.name, "pos": body.position, "quat": quaternion})
    element = xml.SubElement(document.bodies[body.parent], "body", attributes)
    document.bodies[body.name] = element
    if body.motions and not body.body.mass > SMALLEST:
        raise UnsupportedError(
            f"MuJoCo has no moving bodies without mass: give {body.name!r} a mass and an inertia"
        )
    xml.SubElement(element, "inertial", _inertial(body.body, share))
    for motion in body.motions:
        xml.SubElement(element, *_joint(motion))


def euler(axes: np.ndarray) -> np.ndarray:
    """(4,) Euler parameters of axes."""
    return np.asarray(Rotation.from_matrix(axes).as_quat(scalar_first=True))


def _inertial(body: RigidBody, share: float) -> dict[str, str]:
    """Mass, mass centre and principal moments of inertia."""
    inertia, axes = body.inertia * share, None
    if np.any(inertia != np.diag(inertia.diagonal())):
        moments, directions = np.linalg.eigh(inertia)
        directions[:, 2] *= np.sign(np.linalg.det(directions))
        axes = euler(directions)
    else:
        moments = inertia.diagonal()
    return texts(
        {
            "pos": body.center,
            "quat": axes,
            "mass": body.mass * share,
            "diaginertia": np.maximum(moments, SMALLEST),
        }
    )


def _joint(motion: Motion) -> tuple[str, dict[str, str]]:
    """Tag and attributes of a joint."""
    if motion.kind == "free":
        return "freejoint", {"name": motion.name}
    attributes: dict[str, Any] = {"name": motion.name, "type": motion.kind}
    if motion.kind != "slide":
        attributes["pos"] = motion.anchor
    if motion.kind != "ball":
        attributes |= {"axis": motion.axis, "ref": motion.value}
    return "joint", texts(attributes)
