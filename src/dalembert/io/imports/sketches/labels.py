"""Assignment of texts to the nearest pins, links and slots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.io.imports.sketches.drawing import Drawing, Label
from dalembert.io.imports.sketches.links import Link, distances
from dalembert.io.imports.sketches.pins import Pin
from dalembert.io.imports.sketches.roles import is_ground, speed_in

NEAR = 0.15
"""Largest distance of a text from what it names, over the size of the drawing."""


@dataclass(frozen=True)
class Motor:
    """A mark of a driver.

    Attributes
    ----------
    place : file and entity
    position : (2,)
    speed : text with its unit; empty for the default
    """

    place: str
    position: np.ndarray
    speed: str = ""


def assign_labels(
    drawing: Drawing, pins: Sequence[Pin], links: Sequence[Link], slots: Sequence[Any], size: float
) -> list[Motor]:
    """Give names and ground marks to pins, links and slots; returns marks of motors.

    Texts next to a circle name the pin, texts next to the middle of a line the link. The nearest
    pair is assigned first.
    """
    labels = [entity for entity in drawing.entities if isinstance(entity, Label) and entity.text]
    motors = [Motor(label.place, label.position, speed) for label, speed in _motors(labels)]
    grounds = [label for label in labels if is_ground(label.text)]
    names = [label for label in labels if label not in grounds and speed_in(label.text) is None]
    for target, label in _nearest(grounds, [*pins, *links], size, once=False):
        target.is_ground = True
        grounds.remove(label)
    for target, label in _nearest(names, [*pins, *links, *slots], size, once=True):
        target.name = label.text
        names.remove(label)
    for label in [*grounds, *names]:
        drawing.omit(label.place, f"text {label.text[:60]!r}", "is near nothing without a name")
    return motors


def _motors(labels: list[Label]) -> list[tuple[Label, str]]:
    speeds = [(label, speed_in(label.text)) for label in labels]
    return [(label, speed) for label, speed in speeds if speed is not None]


def _nearest(
    labels: list[Label], targets: list[Any], size: float, once: bool
) -> list[tuple[Any, Label]]:
    """Pairs of targets and labels, the nearest first."""
    if not labels or not targets:
        return []
    points = np.array([label.position for label in labels])
    away = np.stack([_away(target, points) for target in targets])  # (target, label)
    pairs: list[tuple[Any, Label]] = []
    used: set[int] = set()
    taken: set[int] = set()
    for index in np.argsort(away, axis=None, kind="stable"):
        target, label = divmod(int(index), len(labels))
        if away[target, label] > NEAR * size:
            break
        if label in used or (once and target in taken):
            continue
        used.add(label)
        taken.add(target)
        pairs.append((targets[target], labels[label]))
    return pairs


def _away(target: Any, points: np.ndarray) -> np.ndarray:
    """(n,) distances of points from a pin, or from the middle halves of lines."""
    if isinstance(target, Pin):
        return np.asarray(
            np.maximum(np.linalg.norm(points - target.center, axis=1) - target.radius, 0)
        )
    segments = target.segments if isinstance(target, Link) else target.ends[None]
    return np.asarray(distances(points, segments, 0.25).min(axis=1))
