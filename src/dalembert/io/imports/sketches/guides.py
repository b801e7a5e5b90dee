"""Slots and sliding blocks of a drawing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.io.imports.sketches.drawing import Drawing, Line, Slot
from dalembert.io.imports.sketches.links import Link, distances
from dalembert.io.imports.sketches.outlines import rectangle
from dalembert.io.imports.sketches.pins import Pin
from dalembert.io.imports.sketches.roles import Role, role_of


@dataclass(eq=False)
class Guide:
    """A straight slot or rail in a link, or in the ground.

    Attributes
    ----------
    ends : (2, 2) of its centre line
    reach : largest distance of the centre of a pin in it from the centre line
    owner : link with the slot; None for the ground
    pins : that slide in it
    """

    place: str
    ends: np.ndarray
    reach: float
    group: str = ""
    is_ground: bool = False
    owner: Link | None = None
    pins: list[Pin] = field(default_factory=list)
    name: str = ""

    @property
    def axis(self) -> np.ndarray:
        along = self.ends[1] - self.ends[0]
        return np.asarray(along / np.linalg.norm(along))

    def nearest(self, point: np.ndarray) -> np.ndarray:
        """Foot of the perpendicular from a point."""
        return np.asarray(self.ends[0] + self.axis * (self.axis @ (point - self.ends[0])))

    def away(self, point: np.ndarray) -> float:
        return float(distances(point[None], self.ends[None])[0, 0])


@dataclass(eq=False)
class Block(Link):
    """A rectangle that slides along a guide.

    Attributes
    ----------
    middle : (2,)
    sides : (2, 2) from the middle to a long and to a short side
    guide : None until it is selected
    """

    middle: np.ndarray = field(default_factory=lambda: np.zeros(2))
    sides: np.ndarray = field(default_factory=lambda: np.eye(2))
    guide: Guide | None = None

    def contains(self, point: np.ndarray, tolerance: float) -> bool:
        lengths = np.linalg.norm(self.sides, axis=1)
        local = np.abs(self.sides @ (point - self.middle)) / lengths
        return bool((local <= lengths + tolerance).all())


def guides_and_blocks(
    drawing: Drawing, pins: Sequence[Pin], tolerance: float
) -> tuple[list[Guide], list[Block], list[Line]]:
    """Guides, sliding blocks, and the other lines; a pivoted slotted lever is line and guide."""
    guides, blocks, lines = [], [], []
    for entity in drawing.entities:
        if isinstance(entity, Slot):
            guides.append(_guide(entity, entity.ends, entity.width / 2))
        if not isinstance(entity, Line):
            continue
        role, box = role_of(entity.words), rectangle(entity)
        if role is Role.BLOCK and box is not None:
            inside = Block([entity], [], [], name=entity.name, middle=box[0], sides=box[1])
            inside.pins = [pin for pin in pins if inside.contains(pin.center, tolerance)]
            inside.corners = list(inside.pins)
            blocks.append(inside)
        elif role in (Role.SLOT, Role.BLOCK):
            ends, reach = _centre_line(entity, box)
            if ends is None or np.linalg.norm(ends[1] - ends[0]) <= tolerance:
                drawing.omit(entity.place, "line", "is no straight slot; draw one straight line")
                continue
            guide = _guide(entity, ends, reach)
            guides.append(guide)
            if _is_lever(guide, pins, tolerance):
                lines.append(entity)
        else:
            lines.append(entity)
    return guides, blocks, lines


def _guide(entity: Line | Slot, ends: np.ndarray, reach: float) -> Guide:
    is_ground = role_of([w for w in entity.words if role_of([w]) is Role.GROUND]) is Role.GROUND
    return Guide(entity.place, ends, reach, entity.group, is_ground, name=entity.name)


def _centre_line(
    line: Line, box: tuple[np.ndarray, np.ndarray] | None
) -> tuple[np.ndarray | None, float]:
    """Ends of a slot that is drawn as a line or as a rectangle, and its half width."""
    if box is not None:
        middle, (long, short) = box
        half_width = float(np.linalg.norm(short))
        inset = long * (1 - half_width / np.linalg.norm(long)) if half_width else long
        return np.array([middle - inset, middle + inset]), half_width
    return (None, 0.0) if line.closed or len(line.corners) != 2 else (line.corners, 0.0)


def _is_lever(guide: Guide, pins: Sequence[Pin], tolerance: float) -> bool:
    """Whether a slot ends in a pin and has another one between its ends."""
    at_ends = [pin for pin in pins if min(map(pin.distance, guide.ends)) <= pin.radius + tolerance]
    between = [p for p in pins if p not in at_ends and guide.away(p.center) <= tolerance + p.radius]
    return bool(at_ends and between)


def place_guides(
    drawing: Drawing,
    guides: Sequence[Guide],
    blocks: Sequence[Block],
    links: Sequence[Link],
    pins: Sequence[Pin],
    tolerance: float,
) -> None:
    """Select the link of each guide, the pins and the block that slide in it."""
    for guide in guides:
        owner = None if guide.is_ground else _owner(guide, links, tolerance)
        guide.owner = None if owner is None or owner.is_ground else owner
        reach = max(guide.reach, tolerance)
        guide.pins = [
            pin
            for pin in pins
            if guide.away(pin.center) <= reach
            and not (owner is not None and pin in owner.corners)
            and not (guide.owner is None and pin.is_ground)
        ]
        for link in links:
            for pin in guide.pins:
                if link is owner or (guide.owner is None and link.is_ground):
                    link.remove(pin)
    for block in blocks:
        block.guide = _guide_of(block, guides, tolerance)
        for guide in guides:
            guide.pins = [p for p in guide.pins if guide is not block.guide or p not in block.pins]
    used = [block.guide for block in blocks]
    for guide in guides:
        if not guide.pins and guide not in used:
            reason = "has no pin in it; draw a circle on its centre line"
            drawing.omit(guide.place, "slot", reason)


def _owner(guide: Guide, links: Sequence[Link], tolerance: float) -> Link | None:
    for link in links:
        away = distances(guide.ends, link.segments)
        lies_along = bool((away <= tolerance).all(axis=0).any())
        if lies_along or (guide.group and guide.group in [line.group for line in link.lines]):
            return link
        if any(_encloses(line, guide.ends) for line in link.lines if line.closed):
            return link
    return None


def _encloses(line: Line, points: np.ndarray) -> bool:
    """Whether all points are in a closed line, by the number of its crossings."""
    starts, ends = line.segments[:, 0], line.segments[:, 1]
    for x, y in points:
        spans = (starts[:, 1] > y) != (ends[:, 1] > y)
        rise = np.where(spans, ends[:, 1] - starts[:, 1], 1.0)
        crossing = starts[:, 0] + (y - starts[:, 1]) / rise * (ends[:, 0] - starts[:, 0])
        if np.count_nonzero(spans & (crossing > x)) % 2 == 0:
            return False
    return True


def _guide_of(block: Block, guides: Sequence[Guide], tolerance: float) -> Guide:
    """The guide through a block, or the ground along its long side."""
    for guide in guides:
        if block.contains(guide.nearest(block.middle), tolerance) and block.contains(
            guide.ends[0]
            + guide.axis
            * np.clip(
                guide.axis @ (block.middle - guide.ends[0]),
                0,
                np.linalg.norm(np.ptp(guide.ends, axis=0)),
            ),
            tolerance,
        ):
            return guide
    origin = block.pins[0].center if block.pins else block.middle
    return Guide(block.place, np.array([origin, origin + block.sides[0]]), 0.0, is_ground=True)
