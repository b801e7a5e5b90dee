"""Guesses of all coordinates: what is given, and where joints put what is missing."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.coordinates import Coordinates
from dalembert.model.assembly.guesses import Guesses
from dalembert.model.assembly.planar_placement import planar_poses
from dalembert.model.assembly.spatial_placement import spatial_poses
from dalembert.model.description import Description


def placed_guesses(d: Description) -> ca.SX:
    """(n,) guesses of all coordinates, as formulas of parameters.

    What is not given and hangs on nothing that is stays at rest.
    """
    placed = planar_poses(d) | spatial_poses(d)
    return ca.vertcat(*(placed[g.name] if g.name in placed else _given(g) for g in d.coordinates))


def curve_searches(
    d: Description, guesses: Guesses
) -> list[tuple[int, list[int], tuple[float, float]]]:
    """Curve parameters without a guess: coordinate, equations, range."""
    owners, found = d.rows, []
    for constraint in d.constraints:
        for part in constraint.own_coordinates():
            if part.guesses()[0][0] is None:
                index = guesses.pose_owners.index(part.name)
                rows = [k for k, (c, _) in enumerate(owners) if c is constraint]
                found.append((index, rows, part.interval))
    return found


def loosely_facing(d: Description) -> list[ca.SX]:
    """Directions of joints that the given poses do not settle."""
    return [
        constraint.assembly_conditions()
        for constraint in d.constraints
        if not all(all(p.specified()) for p in constraint.parts() if p.name != "ground")
    ]


def _given(group: Coordinates) -> ca.SX:
    given, rest = group.guesses()[0], group.rest
    known = (ca.SX(r) if g is None else g for g, r in zip(given, rest, strict=True))
    return ca.vertcat(*known)
