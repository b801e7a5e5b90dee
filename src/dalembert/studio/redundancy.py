"""Remedies of redundant constraints: a joint less, or one with another degree of freedom.

Every remedy is tried: it is offered if the mechanism keeps its degrees of freedom and has fewer
redundant equations.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

from dalembert.errors import DalembertError
from dalembert.io.model_file import check_model_data
from dalembert.io.reading import parse_document
from dalembert.studio.drawing_edits import apply
from dalembert.studio.fixes import Fix, fix_between
from dalembert.studio.text_edits import TextEdits

MOST_BODIES, MOST_TRIALS, MOST_FIXES = 40, 16, 3
"""Bodies of a mechanism beyond which nothing is tried; trials, and remedies of one joint."""
PATIENCE = 3.0
"""Time after which nothing more is tried, since the picture waits [s]."""
FREER: Mapping[int, Mapping[str, tuple[str, ...]]] = {
    2: {"Weld": ("Revolute",), "Prismatic": ("PinInSlot",), "Revolute": ("PinInSlot",)},
    3: {
        "Weld": ("Revolute", "Prismatic"),
        "Revolute": ("Cylindrical", "Spherical"),
        "Prismatic": ("Cylindrical",),
    },
}
"""Dimension → type of a joint → types with more degrees of freedom, the nearest first."""
KEYS = {"Spherical": ("connect",), "PinInSlot": ("connect", "axis"), "Revolute": ("connect",)}
"""Type → keys that it takes from the former joint; others take ``connect`` and ``axis``."""


def redundancy_fixes(text: str, path: Path, model: Any) -> dict[str, tuple[Fix, ...]]:
    """Joint with redundant equations → remedies at it, or at joints that they follow from.

    Parameters
    ----------
    text, path : of the model file
    model : of the text
    """
    diagnosis = model.diagnosis
    if not diagnosis.redundancies or len(diagnosis.bodies) > MOST_BODIES:
        return {}
    freedom, count = diagnosis.degrees_of_freedom, len(diagnosis.redundancies)
    fixes: dict[str, tuple[Fix, ...]] = {}
    trials, end = 0, time.monotonic() + PATIENCE
    for item in diagnosis.redundancies:
        if item.joint in fixes:
            continue
        good: list[tuple[int, Fix]] = []
        joints = (item.joint, *item.shared_with)
        for title, changed in chain.from_iterable(_candidates(text, j, model) for j in joints):
            trials += 1
            if trials > MOST_TRIALS or time.monotonic() > end:
                break
            after = _diagnosis(changed, path)
            if (
                after is not None
                and after.degrees_of_freedom == freedom
                and len(after.redundancies) < count
            ):
                good.append((len(after.redundancies), fix_between(title, text, changed)))
        best = sorted(good, key=lambda fix: fix[0])[:MOST_FIXES]
        fixes[item.joint] = tuple(fix for _, fix in best)
    return fixes


def _diagnosis(text: str, path: Path) -> Any:
    """Diagnosis of a text; None if it is not valid."""
    try:
        model: Any = check_model_data(parse_document(path, text), path).model()
        return model.diagnosis
    except DalembertError:
        return None


def _candidates(text: str, joint: str, model: Any) -> Iterator[tuple[str, str]]:
    """Titles and texts of remedies, valid or not."""
    edits = TextEdits(text)
    entry = edits.data.get("joints", {}).get(joint)
    if not isinstance(entry, dict):
        return
    yield f"Remove {joint}", apply(text, [{"op": "remove", "section": "joints", "name": joint}])
    dimension = model.bodies[0].dimension
    kind = str(entry.get("type"))
    for freer in FREER[dimension].get(kind, ()):
        keys = KEYS.get(freer, ("connect", "axis"))
        fields = {"type": freer} | {key: entry[key] for key in keys if key in entry}
        if freer == "Spherical":
            fields["connect"] = [_without_axes(end) for end in entry.get("connect", ())]
        if (kind, freer) == ("Revolute", "PinInSlot"):
            for along, ends in _slots(entry.get("connect"), edits.data):
                slot = fields | {"connect": ends, "axis": [1.0, 0.0]}
                yield f"Free {joint} along {along}", _with_joint(text, joint, slot)
        else:
            yield f"Make {joint} a {freer} joint", _with_joint(text, joint, fields)


def _slots(ends: Any, data: Mapping[str, Any]) -> Iterator[tuple[str, list[Any]]]:
    """Bodies along whose axis x a pin may slide, bars first, with the ends of the joint."""
    if not isinstance(ends, list) or len(ends) != 2:
        return
    bodies = data.get("bodies", {})
    owners = [
        str(end.get("body")) if isinstance(end, dict) else str(end).partition(".")[0]
        for end in ends
    ]
    order = sorted(range(2), key=lambda k: bodies.get(owners[k], {}).get("type") != "Bar")
    for k in order:
        yield owners[k], [ends[k], ends[1 - k]]


def _without_axes(end: Any) -> Any:
    """The point at which a frame is."""
    return {key: end[key] for key in ("body", "at") if key in end} if isinstance(end, dict) else end


def _with_joint(text: str, joint: str, fields: Mapping[str, Any]) -> str:
    """The text with other keys of a joint."""
    edits = TextEdits(text)
    place = edits.places[("joints", joint)]
    if not place.is_header:  # written in one line
        edits.replace(("joints", joint), fields)
        return edits.text
    edits.remove("joints", joint)
    edits.add("joints", joint, fields)
    return edits.text
