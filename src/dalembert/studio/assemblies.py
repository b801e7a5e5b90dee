"""The other assembly configurations of a mechanism, as poses of its bodies."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from dalembert.analysis.assembly import solve_assembly
from dalembert.errors import DalembertError
from dalembert.io.model_file import check_model_data
from dalembert.io.reading import parse_document
from dalembert.model.assembled.model import StructuralModel
from dalembert.studio.pictures import Picture
from dalembert.studio.problems import problems_of

SEED = 0
"""Of the random starts, so that a text has the same configurations each time."""
SAME = 1e-6
"""Threshold for the difference of equal coordinates [m, rad]."""
MOST = 32
"""Upper limit of configurations."""


def assemblies_of(text: str, path: Path) -> Picture:
    """Configurations of a planar mechanism at the start, other than the drawn one.

    Parameters
    ----------
    text, path : of the model file

    Returns
    -------
    A picture without a page; its ``facts`` have ``assemblies``, each body → (x, y, angle), and a
    ``note`` about the search
    """
    try:
        model = check_model_data(parse_document(path, text), path).model()
        if isinstance(model, StructuralModel) or any(b.dimension == 3 for b in model.bodies):
            note = "configurations are searched for planar mechanisms"
            return Picture(facts={"assemblies": [], "note": note})
        found = solve_assembly(model, all=True, rng=SEED)
    except DalembertError as error:
        return Picture(problems=tuple(problems_of(error, text, path)))
    own = 0 if found.note else 1  # without an assembly of the drawn position, all are others
    poses = [_poses(assembly) for assembly in found]
    new = [k for k in range(own, len(poses)) if not any(_same(poses[k], p) for p in poses[:k])]
    others = [poses[k] for k in new[:MOST]]
    count = len(others)
    note = f"{count} other configuration{'' if count == 1 else 's'}"
    missing = round(found.completeness.missing)
    if missing:
        note += f"; about {missing} more are estimated"
    return Picture(facts={"assemblies": others, "note": note})


def _same(one: dict[str, list[float]], other: dict[str, list[float]]) -> bool:
    """Whether bodies are at the same places; only what is not drawn differs."""
    return all(
        abs(a - b) < SAME or (k == 2 and abs(math.remainder(a - b, 2 * math.pi)) < SAME)
        for body, pose in one.items()
        for k, (a, b) in enumerate(zip(pose, other[body], strict=True))
    )


def _poses(assembly: Any) -> dict[str, list[float]]:
    """Body → coordinates x, y and angle, where it has them."""
    poses = {}
    for body in assembly.model.bodies:
        try:
            pose = assembly.pose(body.name)
        except KeyError:
            continue
        poses[body.name] = [
            round(pose[key], 12) + 0.0 for key in ("x", "y", "angle") if key in pose
        ]
    return poses
