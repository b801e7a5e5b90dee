"""Drawings of linkages, written as DXF by ezdxf and as SVG by hand, and the same linkages built."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import ezdxf
import numpy as np

import dalembert as da
from dalembert import planar

RADIUS = 1.0


@dataclass
class Linkage:
    """Pins [mm] and bars between them; the first bar is driven at its first pin.

    Attributes
    ----------
    pins : (n, 2)
    fixed : number of pins from the first that are fixed
    bars : name → two indices of pins
    """

    pins: list[np.ndarray]
    fixed: int
    bars: dict[str, tuple[int, int]] = field(default_factory=dict)

    def is_clear(self) -> bool:
        """Whether no pin is close to another one, or to a bar that it is not on."""
        points = np.array(self.pins)
        between = np.linalg.norm(points[:, None] - points, axis=2)
        if (between + 1e9 * np.eye(len(points))).min() < 6 * RADIUS:
            return False
        for k, pin in enumerate(points):
            for first, second in self.bars.values():
                if k not in (first, second):
                    along = points[second] - points[first]
                    share = np.clip((pin - points[first]) @ along / (along @ along), 0, 1)
                    if np.linalg.norm(points[first] + share * along - pin) < 4 * RADIUS:
                        return False
        return True

    def system(self) -> da.System:
        """The linkage built by hand, driven at 1 rad/s."""
        system = da.System("linkage")
        bodies: dict[int, list] = {k: [] for k in range(len(self.pins))}
        for name, (i, j) in self.bars.items():
            along = (self.pins[j] - self.pins[i]) / 1000
            angle = math.atan2(along[1], along[0])
            length = float(np.linalg.norm(along))
            bar = system.add(planar.Bar(name, length=length, mass=1.0, angle=angle))
            bodies[i].append(bar.start)
            bodies[j].append(bar.end)
        for k, points in bodies.items():
            if k < self.fixed:
                points = [system.ground.point(*(self.pins[k] / 1000)), *points]
            for n, point in enumerate(points[1:]):
                system.add(planar.Revolute(f"J{k}_{n}", points[0], point))
        driven = next(iter(self.bars))
        i, j = self.bars[driven]
        along = self.pins[j] - self.pins[i]
        law = math.atan2(along[1], along[0]) + da.t
        bar = system.elements[driven]
        system.add(planar.RotationalDriver("motor", system.ground, bar, law))
        return system

    def dxf(self, path: Path, short: float = 0.0, turned: Sequence[bool] = ()) -> Path:
        """A drawing with a layer for each bar; bars end before the centres by ``short``."""
        document = ezdxf.new("R2010")
        document.header["$INSUNITS"] = 4
        space = document.modelspace()
        for k, (name, (i, j)) in enumerate(self.bars.items()):
            ends = _shortened(self.pins[i], self.pins[j], short)
            if k < len(turned) and turned[k]:
                ends = ends[::-1]
            space.add_line(*map(tuple, ends), dxfattribs={"layer": name})
        for k, pin in enumerate(self.pins):
            layer = "ground" if k < self.fixed else "pins"
            space.add_circle(tuple(pin), RADIUS, dxfattribs={"layer": layer})
        place = {"layer": "motor"}
        space.add_arc(tuple(self.pins[0]), 3 * RADIUS, 0, 90, dxfattribs=place)
        document.saveas(path)
        return path

    def svg(self, path: Path, transform: str = "", scale: float = 1.0) -> Path:
        """A drawing in millimetres, y downwards from 1000 mm."""
        rows = []
        for name, (i, j) in self.bars.items():
            (x1, y1), (x2, y2) = self._down(i, scale), self._down(j, scale)
            rows.append(f'<path id="{name}" d="M{x1!r} {y1!r} L{x2!r},{y2!r}"/>')
        for k in range(len(self.pins)):
            x, y = self._down(k, scale)
            fill = ' class="ground"' if k < self.fixed else ' fill="none"'
            rows.append(f'<circle cx="{x!r}" cy="{y!r}" r="{RADIUS * scale!r}"{fill}/>')
        x, y = self._down(0, scale)
        rows.append(f'<path class="motor" d="M{x!r},{y!r}h{scale!r}"/>')
        size = 1000 * scale
        path.write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" width="1000mm" height="1000mm" '
            f'viewBox="0 0 {size!r} {size!r}"><g{transform}>{"".join(rows)}</g></svg>',
            encoding="utf-8",
        )
        return path

    def _down(self, k: int, scale: float) -> tuple[float, float]:
        x, y = map(float, self.pins[k])
        return x * scale, (1000 - y) * scale


def _shortened(a: np.ndarray, b: np.ndarray, short: float) -> list[np.ndarray]:
    along = (b - a) / np.linalg.norm(b - a)
    return [a + short * along, b - short * along]


def bar_ends(model: da.Model, names: Sequence[str], times: list[float]) -> np.ndarray:
    """(time, bar, 4) coordinates of the ends of bars, ordered for each bar [m]."""
    motion = da.solve_kinematics(model, times[-1], outputs=times)
    columns = []
    for name in names:
        ends = [np.asarray(motion[f"{name}.{end}.position"]) for end in ("start", "end")]
        if tuple(ends[0][0]) > tuple(ends[1][0]):
            ends.reverse()
        columns.append(np.concatenate(ends, axis=1))
    return np.stack(columns, axis=1)
