"""Made-up payloads of the report page: closed-form motions with plausible reactions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

TAU = 2.0 * math.pi


def four_bar(frames: int = 161, duration: float = 0.8) -> dict[str, Any]:
    """Return the report of a crank-rocker with a coupler point, a spring and a damper."""
    l1, l2, l3, l4 = 0.3, 0.1, 0.26, 0.22
    t = np.linspace(0.0, duration, frames)
    rate = TAU / duration
    crank = 0.4 + rate * t
    ax, ay = l2 * np.cos(crank), l2 * np.sin(crank)
    reach = np.hypot(l1 - ax, -ay)
    toward = np.arctan2(-ay, l1 - ax)
    opening = np.arccos((l3**2 + reach**2 - l4**2) / (2 * l3 * reach))
    coupler = toward + opening
    bx, by = ax + l3 * np.cos(coupler), ay + l3 * np.sin(coupler)
    rocker = np.arctan2(by, bx - l1)
    px = ax + 0.15 * np.cos(coupler) - 0.11 * np.sin(coupler)
    py = ay + 0.15 * np.sin(coupler) + 0.11 * np.cos(coupler)

    def rate_of(values: np.ndarray) -> np.ndarray:
        return np.gradient(values, t)

    acceleration = rate_of(rate_of(px)), rate_of(rate_of(py))
    forces = {
        "A": (-1.8 * acceleration[0], -1.8 * acceleration[1] + 20.0),
        "B": (-1.2 * acceleration[0], -1.2 * acceleration[1] + 14.0),
        "C": (0.7 * acceleration[0] + 8.0, 0.7 * acceleration[1]),
        "D": (0.9 * acceleration[0], 0.9 * acceleration[1] + 11.0),
    }
    torque = 0.05 * forces["A"][0] - 0.02 * forces["A"][1]

    series = []

    def add(name: str, unit: str, group: str, values: np.ndarray) -> None:
        series.append({"name": name, "unit": unit, "group": group, "values": values.tolist()})

    poses = {
        "crank": (0 * t, 0 * t, crank),
        "coupler": (ax, ay, coupler),
        "rocker": (l1 + 0 * t, 0 * t, rocker),
    }
    for name, (x, y, angle) in poses.items():
        for label, unit, values in (("x", "m", x), ("y", "m", y), ("angle", "rad", angle)):
            per_second = f"{unit}/s"
            add(f"{name}.{label}", unit, "position", values)
            add(f"{name}.{label}_rate", per_second, "velocity", rate_of(values))
            add(
                f"{name}.{label}_acceleration",
                f"{per_second}²",
                "acceleration",
                rate_of(rate_of(values)),
            )
    for name, (fx, fy) in forces.items():
        add(f"{name}.force_x", "N", "reaction", fx)
        add(f"{name}.force_y", "N", "reaction", fy)
        add(f"{name}.force_norm", "N", "reaction", np.hypot(fx, fy))
    add("A.moment", "N·m", "reaction", torque)
    add("energy.total", "J", "energy", 3.0 + 1e-4 * np.sin(crank))
    add("constraint.residual", "", "quality", 1e-12 * (1.2 + np.sin(3 * crank)))

    def joint(
        name: str, body: str, point: list[float], grounded: bool, moment: np.ndarray
    ) -> dict[str, Any]:
        fx, fy = forces[name]
        return {
            "name": name,
            "description": "revolute",
            "symbol": "pin",
            "body": body,
            "point": point,
            "axis": None,
            "grounded": grounded,
            "force_x": fx.tolist(),
            "force_y": fy.tolist(),
            "moment": moment.tolist(),
        }

    def body(name: str, shapes: list[dict[str, Any]]) -> dict[str, Any]:
        x, y, angle = poses[name]
        return {
            "name": name,
            "x": x.tolist(),
            "y": y.tolist(),
            "angle": angle.tolist(),
            "shapes": shapes,
        }

    return {
        "format": 1,
        "title": "Crank-rocker four-bar",
        "subtitle": "dynamics, RK4 + RangeSpace + Projection",
        "time": t.tolist(),
        "scene": {
            "gravity": [0.0, -9.81],
            "bodies": [
                body("crank", [{"kind": "bar", "from": [0, 0], "to": [l2, 0]}]),
                body("coupler", [{"kind": "polygon", "points": [[0, 0], [l3, 0], [0.15, 0.11]]}]),
                body("rocker", [{"kind": "bar", "from": [0, 0], "to": [l4, 0]}]),
            ],
            "ground": {"shapes": []},
            "joints": [
                joint("A", "ground", [0, 0], True, torque),
                joint("B", "crank", [l2, 0], False, 0 * t),
                joint("C", "coupler", [l3, 0], False, 0 * t),
                joint("D", "ground", [l1, 0], True, 0 * t),
            ],
            "links": [
                {
                    "name": "spring",
                    "symbol": "coil",
                    "i": {"body": "ground", "point": [0.46, 0.1]},
                    "j": {"body": "rocker", "point": [0.14, 0]},
                },
                {
                    "name": "damper",
                    "symbol": "dashpot",
                    "i": {"body": "ground", "point": [0.46, 0.1]},
                    "j": {"body": "rocker", "point": [0.14, 0]},
                },
            ],
            "points": [{"name": "coupler.P", "body": "coupler", "point": [0.15, 0.11]}],
        },
        "series": series,
        "default_plots": [
            ["crank.angle", "rocker.angle"],
            ["A.force_norm", "D.force_norm", "A.moment"],
            ["constraint.residual"],
        ],
        "events": [
            {"name": "inner dead centre", "time": 0.21 * duration},
            {"name": "outer dead centre", "time": 0.68 * duration},
        ],
        "diagnosis": {
            "summary": "1 degree of freedom, no redundant constraint",
            "items": [
                {"label": "degrees of freedom", "value": "1"},
                {"label": "moving bodies", "value": "3"},
                {"label": "constraint equations", "value": "8"},
                {"label": "Grashof condition", "value": "crank-rocker"},
            ],
            "messages": [
                {"level": "info", "text": "The assembly was closed to 2.1e-13 m."},
                {
                    "level": "warning",
                    "text": "The transmission angle falls to 31° near t = 0.17 s.",
                },
            ],
        },
        "statistics": [
            {"label": "steps", "value": str(frames - 1)},
            {"label": "largest constraint residual", "value": "2.6e-12"},
            {"label": "energy drift", "value": "3.3e-5"},
            {"label": "wall time", "value": "0.12 s"},
        ],
        "parameters": [
            {
                "name": "l1",
                "value": l1,
                "unit": "m",
                "lower": 0.2,
                "upper": 0.5,
                "description": "distance of the ground pivots",
            },
            {
                "name": "l2",
                "value": l2,
                "unit": "m",
                "lower": 0.05,
                "upper": 0.15,
                "description": "crank length",
            },
            {
                "name": "l3",
                "value": l3,
                "unit": "m",
                "lower": 0.2,
                "upper": 0.4,
                "description": "coupler length",
            },
            {
                "name": "speed",
                "value": rate,
                "unit": "rad/s",
                "lower": None,
                "upper": None,
                "description": "crank speed",
            },
        ],
    }


def gallery(frames: int = 241, duration: float = 6.0) -> dict[str, Any]:
    """Return a motion which shows every kind of shape, joint and link."""
    t = np.linspace(0.0, duration, frames)
    turn = TAU * t / duration * 2
    zero = 0 * t
    r, rod = 0.08, 0.24
    wrist = r * np.cos(turn) + np.sqrt(rod**2 - (r * np.sin(turn)) ** 2)
    lean = np.arctan2(-r * np.sin(turn), wrist - r * np.cos(turn))
    profile = np.linspace(0, TAU, 91)[:-1]
    lobe = 0.05 + 0.015 * np.cos(profile) + 0.008 * np.cos(2 * profile)
    lift = 0.05 + 0.015 * np.cos(math.pi / 2 - turn) + 0.008 * np.cos(2 * (math.pi / 2 - turn))
    cam = np.column_stack([lobe * np.cos(profile), lobe * np.sin(profile)])

    def body(name: str, x: Any, y: Any, angle: Any, *shapes: dict[str, Any]) -> dict[str, Any]:
        return {
            "name": name,
            "x": (x + zero).tolist(),
            "y": (y + zero).tolist(),
            "angle": (angle + zero).tolist(),
            "shapes": list(shapes),
        }

    def joint(
        name: str,
        symbol: str,
        on: str,
        point: list[float],
        grounded: bool = False,
        **more: Any,
    ) -> dict[str, Any]:
        place = {"body": on, "point": point}
        return {"name": name, "symbol": symbol, **place, "grounded": grounded, **more}

    def symbol(kind: str, body: str, point: list[float], **more: Any) -> dict[str, Any]:
        return {"name": kind, "symbol": kind, "body": body, "point": point, **more}

    return {
        "format": 1,
        "title": "Every symbol",
        "time": t.tolist(),
        "scene": {
            "gravity": [0, -9.81],
            "bodies": [
                body("crank", 0, 0, turn, {"kind": "disc", "center": [0, 0], "radius": 0.1}),
                body(
                    "rod",
                    r * np.cos(turn),
                    r * np.sin(turn),
                    lean,
                    {"kind": "bar", "from": [0, 0], "to": [rod, 0]},
                ),
                body(
                    "slider",
                    wrist,
                    0,
                    0,
                    {"kind": "block", "center": [0, 0], "width": 0.08, "height": 0.05, "angle": 0},
                ),
                body("gear", 0, 0.25, turn, {"kind": "disc", "center": [0, 0], "radius": 0.06}),
                body(
                    "wheel",
                    0.15,
                    0.25,
                    -turn * 0.06 / 0.09,
                    {"kind": "disc", "center": [0, 0], "radius": 0.09},
                ),
                body(
                    "cam",
                    0.38,
                    0.2,
                    turn,
                    {"kind": "curve", "points": cam.tolist(), "closed": True},
                ),
                body(
                    "follower",
                    0.38,
                    0.2 + lift,
                    0,
                    {"kind": "bar", "from": [0, 0.012], "to": [0, 0.1]},
                    {"kind": "particle", "center": [0, 0.012]},
                ),
                body(
                    "bob",
                    0.55 + 0.02 * np.sin(turn),
                    0.1,
                    0,
                    {"kind": "particle", "center": [0, 0]},
                ),
                body("free", 0.62, 0.3 + 0.03 * np.cos(turn), turn),
            ],
            "ground": {
                "shapes": [
                    {"kind": "line", "from": [0.1, 0], "to": [0.4, 0]},
                    {"kind": "line", "from": [0.38, 0.22], "to": [0.38, 0.4]},
                    {"kind": "polygon", "points": [[0.5, -0.05], [0.62, -0.05], [0.62, 0]]},
                ]
            },
            "joints": [
                joint("O", "pin", "ground", [0, 0], True),
                joint("A", "pin", "rod", [0, 0]),
                joint("B", "pin", "slider", [0, 0]),
                joint("S", "slider", "slider", [0, 0], True),
                joint("G", "pin", "ground", [0, 0.25], True),
                joint("W", "pin", "ground", [0.15, 0.25], True),
                joint(
                    "mesh",
                    "mesh",
                    "wheel",
                    [0, 0],
                    mesh=[
                        {"body": "gear", "point": [0, 0], "radius": 0.06},
                        {"body": "wheel", "point": [0, 0], "radius": 0.09},
                    ],
                ),
                joint("K", "pin", "ground", [0.38, 0.2], True),
                joint("F", "slider", "follower", [0, 0.08], True),
                joint("P", "slotpin", "follower", [0, 0.04]),
                joint("X", "clamp", "rod", [0.12, 0]),
                joint("Q", "mark", "free", [0.03, 0]),
            ],
            "links": [
                {
                    "name": "k",
                    "symbol": "coil",
                    "i": {"body": "ground", "point": [0.45, 0.1]},
                    "j": {"body": "bob", "point": [0, 0]},
                },
                {
                    "name": "cylinder",
                    "symbol": "cylinder",
                    "i": {"body": "ground", "point": [0.5, -0.0]},
                    "j": {"body": "slider", "point": [0.04, 0]},
                },
                {
                    "name": "tie",
                    "symbol": "rod",
                    "i": {"body": "bob", "point": [0, 0]},
                    "j": {"body": "free", "point": [0, 0]},
                },
                {
                    "name": "bush",
                    "symbol": "sleeve",
                    "i": {"body": "ground", "point": [0.7, 0.28]},
                    "j": {"body": "free", "point": [0.0, 0]},
                },
            ],
            "symbols": [
                symbol("spiral", "ground", [0, 0], i="ground", j="crank"),
                symbol("brake", "ground", [0.38, 0.2], i="ground", j="cam"),
                symbol("motor", "ground", [0, 0.25], i="ground", j="gear"),
                symbol("travel", "slider", [0, 0], on="ground", axis=[1, 0]),
                symbol(
                    "arrow",
                    "bob",
                    [0, 0],
                    force_x=(10 * np.cos(turn)).tolist(),
                    force_y=(10 * np.sin(turn)).tolist(),
                ),
                symbol("twist", "free", [0, 0], moment=np.sin(turn).tolist()),
                {
                    "name": "limit",
                    "symbol": "limit",
                    "at_x": (0.36 + zero).tolist(),
                    "at_y": zero.tolist(),
                    "normal_x": (-1 + zero).tolist(),
                    "normal_y": zero.tolist(),
                },
                {
                    "name": "belt",
                    "symbol": "belt",
                    "crossed": True,
                    "wheels": [
                        {"body": "wheel", "point": [0, 0], "radius": 0.04},
                        {"body": "free", "point": [0, 0], "radius": 0.03},
                    ],
                },
            ],
            "points": [
                {"name": f"rim {k}", "body": "wheel", "point": [0.02 * k, 0]} for k in range(1, 5)
            ],
        },
        "series": [
            {"name": "slider.x", "unit": "m", "group": "position", "values": wrist.tolist()}
        ],
    }


def crowd(bodies: int = 80, frames: int = 4000) -> dict[str, Any]:
    """Return a long motion of many bodies, with as many series."""
    t = np.linspace(0.0, 20.0, frames)
    scene_bodies, joints, series = [], [], []
    for k in range(bodies):
        x0, y0 = 0.2 * (k % 10), 0.2 * (k // 10)
        angle = (0.5 + 0.1 * k) * t
        scene_bodies.append(
            {
                "name": f"arm {k}",
                "x": np.full(frames, x0).tolist(),
                "y": np.full(frames, y0).tolist(),
                "angle": angle.tolist(),
                "shapes": [{"kind": "bar", "from": [0, 0], "to": [0.09, 0]}],
            }
        )
        joints.append(
            {
                "name": f"J{k}",
                "description": "revolute",
                "symbol": "pin",
                "body": "ground",
                "point": [x0, y0],
                "axis": None,
                "grounded": True,
                "force_x": np.cos(angle).tolist(),
                "force_y": np.sin(angle).tolist(),
                "moment": np.sin(angle).tolist(),
            }
        )
        series.append(
            {
                "name": f"arm {k}.x",
                "unit": "m",
                "group": "position",
                "values": np.cos(angle).tolist(),
            }
        )
    points = [{"name": f"tip {k}", "body": f"arm {k}", "point": [0.09, 0]} for k in range(bodies)]
    return {
        "format": 1,
        "title": "Many arms",
        "time": t.tolist(),
        "series": series,
        "default_plots": [[s["name"] for s in series[:6]]],
        "scene": {
            "gravity": None,
            "bodies": scene_bodies,
            "ground": {"shapes": []},
            "joints": joints,
            "links": [],
            "points": points,
        },
    }
