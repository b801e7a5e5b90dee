"""Model file of a drawn mechanism."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from dalembert.io.imports.sketches.drawing import Drawing
from dalembert.io.imports.sketches.guides import Block, Guide
from dalembert.io.imports.sketches.links import Link
from dalembert.io.imports.sketches.names import Names, is_automatic, letters, series
from dalembert.io.imports.sketches.parts import Part, make_part
from dalembert.io.imports.sketches.pins import Pin
from dalembert.io.imports.sketches.sheet import Sheet, merged
from dalembert.model.system import System


class Mechanism:
    """Parts, joints and drivers of a drawing as tables of a model file.

    Parameters
    ----------
    drawing : gets omissions
    sheet : parameters
    pins, links, guides : of the drawing; ground marks are final
    """

    def __init__(
        self,
        drawing: Drawing,
        sheet: Sheet,
        pins: Sequence[Pin],
        links: Sequence[Link],
        guides: Sequence[Guide],
    ):
        self.drawing, self.sheet = drawing, sheet
        self.names = Names(System.reserved)
        self.ground_points: dict[str, list] = {}
        self.joints: dict[str, Any] = {}
        self.drivers: dict[str, Any] = {}
        self.turning: dict[str, Part] = {}
        self.sliding: dict[str, float] = {}
        self.traced: list[str] = []
        self.joints_of: dict[Pin | Guide, list[str]] = {}
        moving = [link for link in links if not link.is_ground]
        self.pin_names = self._named_pins(pins, moving)
        self.parts = [make_part(*pair, self.pin_names, sheet) for pair in self._named(moving)]
        for pin in pins:
            self._join(pin)
        self.ground_references: dict[Pin, str] = {}
        for guide in guides:
            self._slide(guide)
        for part in self.parts:
            if isinstance(part.link, Block):
                self._guide(part, part.link)
        self._place_loose()

    def _named_pins(self, pins: Sequence[Pin], links: Sequence[Link]) -> dict[Pin, str]:
        names: dict[Pin, str] = {}
        streams = {kind: series(kind) for kind in ("O", "P")}
        alphabet = letters()
        for pin in sorted(pins, key=lambda pin: not _stated(pin.name)):
            count = sum(pin in link.pins for link in links)
            stream = streams["O"] if pin.is_ground else alphabet if count > 1 else streams["P"]
            names[pin] = self.names.unique(_stated(pin.name), stream)
        return names

    def _named(self, links: Sequence[Link]) -> Iterator[tuple[Link, str]]:
        """Links with their names: labels, groups, names of lines, then ``bar1``, ``link1``."""
        streams = {kind: series(kind) for kind in ("bar", "link", "block")}
        wishes = []
        for link in links:
            entities = [line.name for line in link.lines] if len(link.lines) == 1 else []
            groups = [line.group.partition(":")[0] for line in link.lines]
            candidates = [link.name, *groups, *entities]
            wishes.append(next((n for n in map(_stated, candidates) if n), ""))
        for link, wish in sorted(zip(links, wishes, strict=True), key=lambda pair: not pair[1]):
            kind = "block" if isinstance(link, Block) else "bar" if link.is_bar else "link"
            yield link, self.names.unique(wish, streams[kind])

    def _join(self, pin: Pin) -> None:
        """Revolute joints of a pin; a pin of one link alone is a point of interest."""
        references = [part.references[pin] for part in self.parts if pin in part.references]
        bodies = [part for part in self.parts if pin in part.references]
        if pin.is_ground and references:
            pairs = [
                (self._ground_point(pin), r, part)
                for r, part in zip(references, bodies, strict=True)
            ]
        elif len(references) > 1:
            pairs = [
                (references[0], r, part) for r, part in zip(references[1:], bodies[1:], strict=True)
            ]
        else:
            pairs = []
            if references and not isinstance(bodies[0].link, Block):
                self.traced.append(references[0])
        for k, (first, second, part) in enumerate(pairs):
            wish = self.pin_names[pin]
            name = wish if k == 0 else self.names.unique(f"{wish}{k + 1}", series(wish))
            self.joints[name] = {"type": "Revolute", "connect": [first, second]}
            self.turning[name] = part
            self.joints_of.setdefault(pin, []).append(name)

    def _ground_point(self, pin: Pin) -> str:
        name = self.pin_names[pin]
        if name not in self.ground_points:
            self.ground_points[name] = [
                self.sheet.length(f"{name}_{axis}", value, f"{axis} of the fixed pin {name}")
                for axis, value in zip("xy", pin.center, strict=True)
            ]
        return f"ground.{name}"

    def _slide(self, guide: Guide) -> None:
        """Joints of pins in a slot."""
        for pin in guide.pins:
            references = [part.references[pin] for part in self.parts if pin in part.references]
            if not references and not pin.is_ground:
                self.drawing.omit(pin.place, "circle", "is in a slot, but on no bar")
                continue
            second = references[0] if references else self._ground_point(pin)
            if second in self.traced:
                self.traced.remove(second)
            name, first, angle = self._guide_point(guide)
            self.joints[name] = {
                "type": "PinInSlot",
                "connect": [first, second],
                "axis": self._axis(guide, angle),
            }
            self._record(name, guide, pin.center)

    def _guide(self, part: Part, block: Block) -> None:
        """The joint of a sliding block."""
        guide = block.guide
        assert guide is not None
        name, first, angle = self._guide_point(guide)
        pins = [pin for pin in block.pins if guide.away(pin.center) <= self.sheet.size * 1e-6]
        foot = guide.nearest(block.middle)
        if pins:
            second = part.references[pins[0]]
        elif self.sheet.rounded(float(np.linalg.norm(foot - block.middle))) == 0:
            second = part.name
        else:
            second = part.add_place("guided", foot, self.sheet)
        self.joints[name] = {
            "type": "Prismatic",
            "connect": [first, second],
            **merged(
                {"axis": self._axis(guide, angle)}, {"angle": self.sheet.angle(part.angle - angle)}
            ),
        }
        self._record(name, guide, pins[0].center if pins else foot)

    def _record(self, name: str, guide: Guide, place: np.ndarray) -> None:
        self.sliding[name] = float(guide.axis @ (place - guide.ends[0]))
        self.joints_of.setdefault(guide, []).append(name)

    def _guide_point(self, guide: Guide) -> tuple[str, str, float]:
        """Name of the joint, point at the start of the slot, angle of the body with the slot."""
        name = self.names.unique(_stated(guide.name), series("slot"))
        owner = next((part for part in self.parts if part.link is guide.owner), None)
        if owner is not None:
            return name, owner.add_place(name, guide.ends[0], self.sheet), owner.angle
        self.ground_points[name] = [
            self.sheet.length(f"{name}_{axis}", value, f"{axis} of the start of {name}")
            for axis, value in zip("xy", guide.ends[0], strict=True)
        ]
        return name, f"ground.{name}", 0.0

    def _axis(self, guide: Guide, angle: float) -> list[float]:
        c, s = np.cos(angle), np.sin(angle)
        return self.sheet.direction(np.array([[c, s], [-s, c]]) @ guide.axis)

    def _place_loose(self) -> None:
        """Positions of bodies that no chain of joints connects to the ground."""
        links: dict[str, set[str]] = {}
        for table in self.joints.values():
            first, second = (end.partition(".")[0] for end in table["connect"])
            links.setdefault(first, set()).add(second)
            links.setdefault(second, set()).add(first)
        reached, pending = {"ground"}, ["ground"]
        while pending:
            for other in links.get(pending.pop(), set()) - reached:
                reached.add(other)
                pending.append(other)
        for part in self.parts:
            if part.name not in reached:
                center = part.link.moments()[1]
                part.table["position"] = self.sheet.vector(center)
                reason = "no joint connects it to the ground; mark a fixed pin or a slot"
                self.drawing.omit(part.link.place, f"body {part.name}", reason)

    @property
    def freedom(self) -> int:
        """Grübler's count of degrees of freedom, without drivers."""
        rows = {"Revolute": 2, "Prismatic": 2, "PinInSlot": 1}
        return 3 * len(self.parts) - sum(rows[joint["type"]] for joint in self.joints.values())


def _stated(name: str) -> str:
    """The name that a person gave; empty for none."""
    return "" if is_automatic(name) else name
