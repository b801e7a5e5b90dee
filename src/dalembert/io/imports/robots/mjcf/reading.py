"""Import of MJCF: bodies, joints, equality constraints and actuators."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from dalembert.io.imports.imported import Imported
from dalembert.io.imports.robots.mjcf.actuators import MjcfActuators
from dalembert.io.imports.robots.mjcf.bodies import MjcfBodies
from dalembert.io.imports.robots.mjcf.equality import SOFT, MjcfEqualities
from dalembert.io.imports.robots.mjcf.keyframes import apply_keyframe
from dalembert.io.imports.robots.mjcf.source import MjcfSource
from dalembert.io.imports.robots.parts import Robot
from dalembert.io.imports.robots.reader import Omissions, imported_robot
from dalembert.io.imports.xml.resources import Resources

CONTACT = "contacts are not created; add a Collisions element"
LOOK = "colours, lights and cameras are not part of a model file"
SOLVER = "is an option of the solver of another program"
REASONS = {
    **dict.fromkeys(("solref", "solimp", "solreffriction", "solimpfriction"), SOFT),
    **dict.fromkeys(("solreflimit", "solimplimit", "margin", "torquescale"), SOFT),
    **dict.fromkeys(("contype", "conaffinity"), CONTACT),
    **dict.fromkeys(("friction", "condim", "priority", "gap", "solmix", "contact"), CONTACT),
    **dict.fromkeys(("rgba", "material", "texture", "skin", "visual", "light", "camera"), LOOK),
    **dict.fromkeys(("map", "quality", "global", "headlight", "statistic", "scale"), LOOK),
    **dict.fromkeys(("timestep", "integrator", "cone", "solver", "iterations", "size"), SOLVER),
    **dict.fromkeys(("tolerance", "flag", "jacobian", "impratio", "noslip_iterations"), SOLVER),
    "sensor": "measures need no sensors; use measures of bodies and joints",
    **dict.fromkeys(("fixed", "spatial"), "is converted only as the transmission of actuators"),
    "tendon": "tendons are not converted, except as the transmission of actuators",
    "keyframe": "select one with --keyframe NAME",
    "key": "select one with --keyframe NAME",
    "qvel": "initial speeds are not converted; give the bodies velocity and angular_velocity",
    "custom": "is data of another program",
    "springdamper": "depends on the inverse mass matrix; write stiffness and damping",
    "user": "is data of another program",
    "density": "forces of a fluid are not converted",
    "viscosity": "forces of a fluid are not converted",
    "wind": "forces of a fluid are not converted",
    "fluidshape": "forces of a fluid are not converted",
    "fluidcoef": "forces of a fluid are not converted",
    "hfield": "terrain is not created; add a HeightField",
    "deformable": "deformable bodies are not converted",
    "composite": "is not converted; write its bodies",
    "flexcomp": "is not converted; write its bodies",
    "attach": "is not converted; include the file",
}


def read_mjcf(
    path: Path,
    root: str | Path | None = None,
    packages: Mapping[str, str | Path] | None = None,
    keyframe: str | None = None,
    stops: float | None = None,
    repair_inertia: bool = False,
) -> Imported:
    """The model in an MJCF file.

    Parameters
    ----------
    path : of the file
    root : folder inside which all referenced files are; that of the file by default
    packages : name of a package → its folder
    keyframe : name of the keyframe that is the initial position; that of the file by default
    stops : stiffness of elastic stops at the limits of joints [N m/rad] or [N/m]; none by default
    repair_inertia : whether moments of inertia that no body has are raised, instead of refused

    Raises
    ------
    FileError, ModelError
        Names file, line, element, value and a fix.
    """
    omissions = Omissions(REASONS)
    source = MjcfSource(path, Resources(path, root, packages or {}), omissions)
    robot = Robot(source.root.text("model", path.stem), _gravity(source))
    bodies = MjcfBodies(source)
    equalities = MjcfEqualities(bodies)
    robot.links, robot.ground_shapes = bodies.links, bodies.ground_shapes
    robot.ground_frames = {n: pose for n, (link, pose) in bodies.sites.items() if link is None}
    robot.closures, robot.dependences = equalities.closures, equalities.dependences
    robot.actuators = MjcfActuators(bodies).actuators
    apply_keyframe(source, bodies, keyframe)
    return imported_robot(path, "MJCF", robot, omissions, source.files, stops, repair_inertia)


def _gravity(source: MjcfSource) -> np.ndarray:
    """Gravity; the usual one of the format by default."""
    gravity = np.array([0.0, 0.0, -9.81])
    for option in source.sections("option"):
        if option.has("gravity"):
            gravity = np.array(option.numbers("gravity", 3))
        for flag in option.all("flag"):
            if flag.optional("gravity") == "disable":
                return np.zeros(3)
    return gravity
