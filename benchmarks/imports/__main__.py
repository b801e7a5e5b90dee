"""Table of imported files: ``python -m benchmarks.imports FOLDER… --output table.md``.

Mass matrix, bias forces and accelerations of every file with joints are compared with Pinocchio
(URDF) or MuJoCo (MJCF) at random states, loops with exact constraints.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np

import dalembert as da
from benchmarks.imports.mujoco_peer import MujocoPeer
from benchmarks.imports.pinocchio_peer import PinocchioPeer

LIMIT = 1e-9
"""Difference above which a file is compared a second time, with the same inertia tensors."""
OWN_TENSORS = "MuJoCo with exact principal axes"
STATES = 20
"""Number of random states."""
COMMON = ("urdf", "robots", "assets", "xml", "mjcf")
"""Names of folders that do not distinguish files."""
PLACE = re.compile(r"(its mass properties are needed by )?[\w./-]+:\d+: <[^>]*>: ")
"""File, line and element in a message."""
LONGEST = 200
"""Upper limit of the length of a message."""
WITHOUT_JOINTS = ("has no joint", "has no <link>", "cannot be free")
"""Parts of the messages about files in which nothing moves, which are not in the table."""
HEADING = ("file", "peer", "bodies", "loops", "M", "bias", "v̇")


def main() -> None:
    """Compare all files and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--output", type=Path)
    parser.add_argument("--name", action="append", default=[], help="part of the file names")
    arguments = parser.parse_args()
    lines = [HEADING, ("---",) * 4 + ("---:",) * 3]
    for folder in arguments.folders:
        for path in sorted(p for s in ("urdf", "xml") for p in folder.rglob(f"*.{s}")):
            if arguments.name and not any(part in str(path) for part in arguments.name):
                continue
            for line in rows(path, folder):
                print(" | ".join(line), flush=True)
                if not any(text in line[2] for text in WITHOUT_JOINTS):
                    lines.append(line)
    text = "".join(f"| {' | '.join(line)} |\n" for line in lines)
    if arguments.output is not None:
        arguments.output.write_text(text, encoding="utf-8")


def rows(path: Path, folder: Path) -> Iterator[tuple[str, ...]]:
    """The row of a file; none for a file that is neither URDF nor MJCF."""
    head = path.read_bytes()[:20_000]
    if b"<robot" in head:
        yield row(path, [partial(PinocchioPeer, path, base) for base in ("fixed", "free")])
    elif b"<mujoco" in head and b"<mujocoinclude" not in head:
        line = row(path, [partial(MujocoPeer, path, folder)])
        yield line
        if any(difference > LIMIT / 2 for difference in map(_number, line[4:])):
            name, *rest = row(path, [partial(MujocoPeer, path, folder, own_tensors=True)])
            yield f"{name}, {OWN_TENSORS}", *rest


def _number(text: str) -> float:
    """A difference in a row; NaN for none."""
    return float(text) if text[:1].isdigit() else float("nan")


def row(path: Path, peers: list[Callable[[], PinocchioPeer | MujocoPeer]]) -> tuple[str, ...]:
    """The largest differences of a file with all of its bases, or the reason why there are none."""
    worst, first, reason, condition = np.zeros(3), None, "", 1.0
    for make in peers:
        try:
            peer = make()
            for state, terms in peer.states(STATES):
                worst = np.maximum(worst, peer.ours.difference(state, terms))
                condition = max(condition, condition_number(terms[0]))
            first = first or peer
        except (da.DalembertError, ValueError) as error:
            reason = reason or _reason(error, path)
    if first is None:
        return _title(path), "—", f"not compared: {reason}", "", "", "", ""
    counts = str(len(first.ours.model.bodies)), str(first.ours.loops)
    differences = ("–" if np.isnan(d) else f"{d:.0e}" for d in worst)
    name = _title(path) + (f" (condition {condition:.0e})" if worst[2] > LIMIT / 2 else "")
    return name, first.name, *counts, *differences


def _title(path: Path) -> str:
    """Folder and name of a file."""
    return f"{next(p.name for p in path.parents if p.name not in COMMON)}/{path.stem}"


def _reason(error: Exception, path: Path) -> str:
    """The message without places and remedies."""
    text = str(error).replace(f"{path.parent}/", "").replace("|", "/").replace("\n", " ")
    return PLACE.sub("", text).partition(";")[0][:LONGEST]


def condition_number(mass: np.ndarray) -> float:
    """Of a mass matrix whose diagonal is scaled to one."""
    scale = 1 / np.sqrt(np.maximum(np.diag(mass), 1e-300))
    return float(np.linalg.cond(mass * np.outer(scale, scale)))


if __name__ == "__main__":
    main()
