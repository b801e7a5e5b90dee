"""Report of places that nearly coincide, and of lines that cross without a pin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.io.imports.sketches.drawing import Drawing, Line
from dalembert.io.imports.sketches.guides import Guide
from dalembert.io.imports.sketches.links import Link, distances
from dalembert.io.imports.sketches.pins import Pin

NEARLY = 20.0
"""Distance of a near miss over the tolerance."""


def report_misses(
    drawing: Drawing,
    lines: Sequence[Line],
    pins: Sequence[Pin],
    links: Sequence[Link],
    guides: Sequence[Guide],
    tolerance: float,
) -> None:
    """List circles on no line, ends next to a circle or a line, and crossings."""
    used = {pin for link in links for pin in link.pins}
    used |= {pin for guide in guides for pin in guide.pins}
    for pin in pins:
        if pin not in used:
            _report_unused(drawing, pin, links)
    for link in links:
        _report_rigid_pins(drawing, link, [p for p in pins if _is_alone(p, link, links, guides)])
    owner = {id(line): link for link in links for line in link.lines}
    for line in lines:
        if not line.closed:
            for end in line.corners[[0, -1]]:
                if not any((end == pin.center).all() for pin in pins):
                    _report_end(drawing, line, end, pins, links, owner[id(line)], tolerance)
    _report_crossings(drawing, links, pins)


def _report_unused(drawing: Drawing, pin: Pin, links: Sequence[Link]) -> None:
    text = "circle on no line"
    if links:
        away = min(distances(pin.center[None], link.segments).min() for link in links)
        text += f"; the nearest one is {away:.4g} {drawing.unit} from its centre"
    drawing.omit(pin.place, text, "is no pin; draw it over the lines that it joins")


def _is_alone(pin: Pin, link: Link, links: Sequence[Link], guides: Sequence[Guide]) -> bool:
    """Whether a pin joins a link to nothing."""
    elsewhere = [*(other.pins for other in links if other is not link), *(g.pins for g in guides)]
    return pin in link.corners and not pin.is_ground and not any(pin in pins for pins in elsewhere)


def _report_rigid_pins(drawing: Drawing, link: Link, pins: Sequence[Pin]) -> None:
    """Report circles at which lines of one link meet that nothing else holds together."""
    segments = link.segments
    for pin in pins:
        ends = [{tuple(e) for e in piece if (e != pin.center).any()} for piece in segments]
        at_pin = [len(e) < 2 for e in ends]
        if sum(at_pin) > 1 and len(_connected(ends)) > 1:
            drawing.omit(
                pin.place,
                f"circle at {_text(pin.center)} {drawing.unit}",
                "joins only lines of one body, which is rigid there; for a joint draw separate "
                "lines, not one polyline, and outside of named groups, layers and blocks",
            )


def _connected(sets: Sequence[set]) -> list[set]:
    """Unions of the sets that have elements in common."""
    unions: list[set] = []
    for members in sets:
        joined = [union for union in unions if union & members]
        unions = [union for union in unions if not union & members]
        unions.append(members.union(*joined))
    return unions


def _report_end(
    drawing: Drawing,
    line: Line,
    end: np.ndarray,
    pins: Sequence[Pin],
    links: Sequence[Link],
    own: Link,
    tolerance: float,
) -> None:
    """Report the nearest pin or other link, if it is missed by little."""
    near = [
        (pin.distance(end) - pin.radius, f"the circle at {_text(pin.center)}")
        for pin in pins
        if pin not in own.pins
    ]
    for link in links:
        if link is not own:
            away = float(distances(end[None], link.segments).min())
            near.append((away, link.place.partition(": ")[2]))
    if near and (miss := min(near))[0] <= NEARLY * tolerance:
        drawing.omit(
            line.place,
            f"end at {_text(end)} {drawing.unit}, {miss[0]:.3g} {drawing.unit} from {miss[1]}",
            "is not joined to it; draw it there, or raise the tolerance",
        )


def _report_crossings(drawing: Drawing, links: Sequence[Link], pins: Sequence[Pin]) -> None:
    """Report lines of different links that cross, where they share no pin."""
    segments = np.concatenate([link.segments for link in links if len(link.lines)] or [_NONE])
    owners = np.repeat(np.arange(len(links)), [len(link.segments) for link in links])
    starts, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    for k in range(len(segments)):
        others = slice(k + 1, None)
        between = starts[others] - starts[k]
        cross = along[k, 0] * along[others, 1] - along[k, 1] * along[others, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            s = (between[:, 0] * along[others, 1] - between[:, 1] * along[others, 0]) / cross
            t = (between[:, 0] * along[k, 1] - between[:, 1] * along[k, 0]) / cross
        inner = (s > 1e-6) & (s < 1 - 1e-6) & (t > 1e-6) & (t < 1 - 1e-6)
        for other in np.flatnonzero(inner) + k + 1:
            first, second = links[owners[k]], links[owners[other]]
            place = starts[k] + s[other - k - 1] * along[k]
            shared = [pin for pin in first.pins if pin in second.pins]
            if first is not second and not any(p.distance(place) <= p.radius for p in shared):
                other_place = second.place.partition(": ")[2]
                text = f"crosses {other_place} at {_text(place)} {drawing.unit}"
                drawing.omit(first.place, text, "has no circle there and is not joined")


_NONE = np.zeros((0, 2, 2))


def _text(point: np.ndarray) -> str:
    return f"({point[0]:.4g}, {point[1]:.4g})"
