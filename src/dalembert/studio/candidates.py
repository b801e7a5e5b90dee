"""Candidates of a synthesis as moving cards, and as entries of a model file."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from dalembert.design.synthesis.four_bar import FourBar
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.slider_crank import SliderCrank
from dalembert.design.synthesis.synthesis_result import Solution

FRAMES = 60
"""Instants of a card."""
MAX_CARDS = 24
"""Upper limit of cards."""
LEAST_TRANSMISSION = math.radians(40)
"""Transmission angle below which a card has a mark [rad]."""


def cards(result: Any) -> Iterator[dict[str, Any]]:
    """Cards of the candidates of a synthesis, sorted by their errors.

    Parameters
    ----------
    result : of ``synthesize`` or ``synthesize_mechanism``

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
            card |= _mechanism_card(solution)
        yield card


def _marks(solution: Any) -> Iterator[str]:
    """Properties of a candidate that limit its use."""
    if not solution.properties()["crank_turns"]:
        yield "the crank does not turn fully"
    transmission = solution.criteria().get("transmission")
    if transmission is not None and transmission[1] < math.degrees(LEAST_TRANSMISSION):
        yield f"transmission angle {transmission[1]:.0f}°"
    steps = np.diff(np.asarray(solution.crank_angles, dtype=float))
    if len(steps) > 1:
        turns = np.mod(steps, 2 * math.pi)
        if np.any(steps * steps[0] <= 0) and not (
            np.all(turns > 0) and np.sum(turns) < 2 * math.pi
        ):
            yield "order of the entries"


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


def _mechanism_card(solution: Any) -> dict[str, Any]:
    """Card of a mechanism of the file, whose dimensions are parameters."""
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
    return {"curve": curve, "lines": lines, "parameters": dict(solution.parameters)}


def _rounded(values: np.ndarray) -> list[Any]:
    return [
        [float(f"{v:.5g}") for v in row] if np.ndim(row) == 1 else _rounded(row) for row in values
    ]


def linkage_operations(linkage: Linkage, start: float) -> Iterator[dict[str, Any]]:
    """Operations that add a linkage to a model file, as ``drawing_edits`` carries them out.

    Parameters
    ----------
    linkage : four-bar or slider-crank
    start : angle of its crank [rad]
    """
    q = linkage.numbers
    phi, output = (float(value) for value in linkage.loop(q, linkage.branch, np.array(start)))

    def add(section: str, name: str, **fields: Any) -> dict[str, Any]:
        entry = {"op": "add", "section": section, "base": name, "as": f"${name}"}
        return entry | {"fields": fields}

    def bar(name: str, length: float, angle: float, **fields: Any) -> dict[str, Any]:
        sizes = {"length": _short(length), "mass": _short(length), "angle": _short(angle)}
        return add("bodies", name, type="Bar", **sizes, **fields)

    def revolute(name: str, *ends: Any) -> dict[str, Any]:
        return add("joints", name, type="Revolute", connect=list(ends))

    yield bar("crank", q["crank"], start)
    point = [_short(q["u"] - q["coupler"] / 2), _short(q["v"])]
    yield bar("coupler", q["coupler"], phi, points={"P": point})
    if isinstance(linkage, FourBar):
        pivot = complex(q["x"], q["y"]) + q["ground"] * np.exp(1j * q["angle"])
        yield bar("follower", q["follower"], output)
        yield revolute("O", _ground(q["x"], q["y"]), "$crank.start")
        yield revolute("A", "$crank.end", "$coupler.start")
        yield revolute("B", "$coupler.end", "$follower.end")
        yield revolute("C", _ground(pivot.real, pivot.imag), "$follower.start")
    elif isinstance(linkage, SliderCrank):
        direction = np.exp(1j * q["angle"])
        place = complex(q["x"], q["y"]) + complex(output, q["offset"]) * direction
        rail = complex(q["x"], q["y"]) + 1j * q["offset"] * direction
        at = [_short(place.real), _short(place.imag)]
        angle = _short(q["angle"])
        yield add("bodies", "slider", mass=1.0, inertia=1.0, position=at, angle=angle)
        yield revolute("O", _ground(q["x"], q["y"]), "$crank.start")
        yield revolute("A", "$crank.end", "$coupler.start")
        yield revolute("B", "$coupler.end", "$slider")
        axis = [_short(direction.real), _short(direction.imag)]
        ends = [_ground(rail.real, rail.imag), "$slider"]
        yield add("joints", "rail", type="Prismatic", connect=ends, axis=axis, angle=angle)
    law = f"{_short(start)} + 2*pi*t"
    motor = {"connect": ["ground", "$crank"], "law": law}
    yield add("drivers", "motor", type="RotationalDriver", **motor)


def _ground(x: float, y: float) -> dict[str, Any]:
    return {"body": "ground", "at": [_short(x), _short(y)]}


def _short(value: float) -> float:
    return float(f"{value:.12g}")
