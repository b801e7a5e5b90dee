"""From body to body along joints: poses that follow from those that are known."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

Pose = TypeVar("Pose")


def carried_along(
    joints: Iterable[Any],
    placed: dict[str, Pose],
    loose: dict[str, Pose],
    carry: Callable[[Any, Any, Pose], Pose | None],
) -> dict[str, Pose]:
    """Name → pose of all bodies that hang on what is known, the nearest first.

    Parameters
    ----------
    joints : that may carry a pose from one of their bodies to the other
    placed : poses that are known
    loose : poses of bodies for the case that they hang on nothing that is known
    carry : joint, body and pose of the other body → its pose; None where it does not follow
    """
    of_body: dict[str, list[Any]] = defaultdict(list)
    for joint in joints:
        for body in joint.ends():
            of_body[body.owner.name].append(joint)
    found = dict(placed)
    for root in (*placed, *loose):
        if root not in found:
            found[root] = loose[root]
        waiting = deque([root])
        while waiting:
            base = waiting.popleft()
            for joint in of_body[base]:
                child = joint.ends()[joint.ends()[0].owner.name == base].owner
                if child.name in found:
                    continue
                pose = carry(joint, child, found[base])
                if pose is not None:
                    found[child.name] = pose
                    waiting.append(child.name)
    return found
