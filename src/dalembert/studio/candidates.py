"""Candidates of a synthesis as moving cards, and as entries of a model file."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.synthesis_result import Solution
from dalembert.studio.inserted_linkages import linkage_operations, mechanism_operations

FRAMES = 60
"""Instants of a card."""
MAX_CARDS = 24
"""Upper limit of cards."""
LEAST_TRANSMISSION = math.radians(40)
"""Transmission angle below which a card has a mark [rad]."""


def cards(result: Any, is_own: bool = False) -> Iterator[dict[str, Any]]:
    """Cards of the candidates of a synthesis, sorted by their errors.

    Parameters
    ----------
    result : of ``synthesize`` or ``synthesize_mechanism``
    is_own : whether the mechanism is that of the file, so that candidates are its parameters

    Returns
    -------
    Tables with ``error``, ``distance`` (the largest), ``dimensions``, ``marks``, ``curve``,
    ``lines`` (each a list of places over the instants), ``target``, and ``operations`` that insert
    the candidate into a file, or ``parameters`` of its mechanism.
    """
    target = result.target.points
    for solution in result.solutions[:MAX_CARDS]:
        card = {
            "error": float(solution.error),
            "distance": float(np.max(solution.distances, initial=0.0)),
            "dimensions": {name: float(value) for name, value in solution.numbers.items()},
            "marks": list(_marks(solution)),
            "target": [] if target is None else target.tolist(),
            "curve": [],
            "lines": [],
        }
        if isinstance(solution, Solution):
            card |= _linkage_card(solution)
        else:
            card |= _mechanism_card(solution, is_own)
        yield card


def _marks(solution: Any) -> Iterator[str]:
    """Properties of a candidate that limit its use."""
    if not solution.properties()["crank_turns"]:
        yield "the crank does not turn fully"
    transmission = solution.criteria().get("transmission")
    if transmission is not None and transmission[1] < math.degrees(LEAST_TRANSMISSION):
        yield f"transmission angle {transmission[1]:.3g}°"  # 39.7° is not 40°
    if isinstance(solution, Solution) and _on_two_circuits(solution):
        yield "circuit defect"
    steps = np.diff(np.asarray(solution.crank_angles, dtype=float))
    if len(steps) > 1:
        turns = np.mod(steps, 2 * math.pi)
        if np.any(steps * steps[0] <= 0) and not (
            np.all(turns > 0) and np.sum(turns) < 2 * math.pi
        ):
            yield "order of the entries"


def _on_two_circuits(solution: Solution) -> bool:
    """Whether the linkage cannot move from one entry to another without being taken apart."""
    linkage, theta = solution.linkage, np.asarray(solution.crank_angles, dtype=float)
    phi, output = linkage.loop(linkage.numbers, linkage.branch, theta)
    circuits = type(linkage).circuits(linkage.numbers, theta, phi, output)
    finite = circuits[np.isfinite(circuits)]
    return bool(finite.size) and bool(np.ptp(finite))


def _linkage_card(solution: Solution) -> dict[str, Any]:
    linkage = solution.linkage
    if linkage.crank_turns:
        angles = np.linspace(0, 2 * math.pi, FRAMES, endpoint=False) + linkage.angle
    else:
        ends = np.sort(np.asarray(solution.crank_angles, dtype=float))[[0, -1]]
        phase = np.linspace(0, 2 * math.pi, FRAMES, endpoint=False)
        angles = np.mean(ends) - 0.5 * np.ptp(ends) * np.cos(phase)
    joints = np.array([linkage.joints(float(angle)) for angle in angles])
    point = linkage.path(angles)
    chain = joints[:, [0, 1, 3, 2] if isinstance(linkage, FourBar) else [0, 1, 2]]
    end = joints[:, 3 if isinstance(linkage, FourBar) else 2]
    plate = np.column_stack([joints[:, 1], point @ [1, 1j], end])
    return {
        "curve": _rounded(solution.curve()),
        "lines": [_rounded(np.stack([z.real, z.imag], axis=-1)) for z in (chain, plate)],
        "operations": list(linkage_operations(linkage, float(angles[0]))),
    }


def _mechanism_card(solution: Any, is_own: bool) -> dict[str, Any]:
    """Card of a mechanism whose dimensions are parameters."""
    motion = solution.motion
    steps = np.linspace(0, len(motion.time) - 1, FRAMES).astype(int)
    lines = []
    for body in motion.model.bodies:
        names = [point.name for point in body.points.values()]
        places = [
            np.column_stack([motion.values(f"{name}.{axis}")[steps] for axis in "xy"])
            for name in names
        ]
        if len(places) > 1:
            lines.append(_rounded(np.array(places).transpose(1, 0, 2)))
    curve = _rounded(solution.curve()) if "x" in solution.measures else []
    card: dict[str, Any] = {"curve": curve, "lines": lines}
    if is_own:
        return card | {"parameters": dict(solution.parameters)}
    operations = mechanism_operations(motion)
    return card | ({"operations": operations} if operations is not None else {})


def _rounded(values: np.ndarray) -> list[Any]:
    return [
        [float(f"{v:.5g}") for v in row] if np.ndim(row) == 1 else _rounded(row) for row in values
    ]
