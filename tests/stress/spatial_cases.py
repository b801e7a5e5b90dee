"""Spatial trees and loops: SciPy integrates a twin; random strategies and the default agree."""

from __future__ import annotations

import itertools

import numpy as np
from spatial_tree_twin import SpatialTreeTwin
from spatial_trees import KINDS, SpatialTree

import dalembert as da
from stress.agreement import PRECISE, USUAL, apart, precise_motion

DURATION = 0.15
PARTS = ("position", "euler_parameters", "velocity", "angular_velocity")


def random_tree(seed: int) -> tuple[str, SpatialTree]:
    """A tree, a ring or a chain between the ground and itself; springs as well."""
    rng = np.random.default_rng([seed, 2])
    gravity = None if rng.random() < 0.2 else tuple(rng.uniform(-6, 6, 3))
    tree, pick = SpatialTree(seed, gravity=gravity), rng.random()
    if pick < 0.5:
        tree.grow(int(rng.integers(1, 5)), list(KINDS), floating=bool(rng.random() < 0.2))
        name = "tree"
    else:
        bodies = [*([0] if pick < 0.8 else []), *(tree.body() for _ in range(rng.integers(3, 5)))]
        for i, j in itertools.pairwise(bodies):
            tree.joint(str(rng.choice(list(KINDS))), i, j)
        last = str(rng.choice(["Spherical", "Universal", "Cylindrical", "Revolute", "Planar"]))
        tree.joint(last, bodies[-1], bodies[0])
        name = "loop"
    tree.springs(int(rng.integers(0, 3)))
    return f"{name} {[joint[0] for joint in tree.joined]}", tree


def judge(seed: int) -> tuple[str, str, str]:
    """Poses and velocities at the end by the twin and by two runs."""
    case, tree = random_tree(seed)
    rng = np.random.default_rng([seed, 3])
    try:
        model = tree.system.build()
        precise, choices = precise_motion(model, DURATION, rng)
        case = f"{case} {choices}"
        default = da.solve_dynamics(model, DURATION, outputs=2)
    except da.DalembertError as error:
        return "refused", case, str(error)
    for run in (precise, default):
        if not run.status.success:
            return "ended", case, str(run.status)
    twin = SpatialTreeTwin(tree)
    start = [precise.data[part].values[0] for part in PARTS]
    if open_by := violation(twin, start):
        return "false success", case, open_by
    end = twin.motion(*start, DURATION)
    for run, limit, name in ((precise, PRECISE, "precise"), (default, USUAL, "default")):
        far = distance(run, end)
        if far > limit and not (run is default and run.warnings):
            return "false success", case, f"the {name} run is {far:.2g} off the twin"
    return "completed", case, ""


def violation(twin: SpatialTreeTwin, start: list[np.ndarray], limit: float = 1e-8) -> str:
    """What the twin's joints say against the assembled start."""
    position, euler, velocity, spin = start
    _, _, speeds, places = twin.constraints_at(position, euler, velocity, spin)
    for name, values in (("positions", places), ("velocities", speeds)):
        if (far := np.abs(values).max(initial=0.0)) > limit:
            return f"the start violates the twin's joints: {name} by {far:.2g}"
    return ""


def distance(run, end: np.ndarray) -> float:
    """Of poses and of velocities, each relative to its size."""
    computed = np.hstack([run.data[part].values[-1] for part in PARTS])
    sign = np.sign(np.sum(computed[:, 3:7] * end[:, 3:7], axis=1))[:, None]
    computed[:, 3:7] *= sign  # both signs are the same rotation
    return max(apart(computed[:, k], end[:, k]) for k in (slice(0, 7), slice(7, 13)))
