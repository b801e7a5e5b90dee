"""Log of evaluations in a file, from which an interrupted optimisation resumes.

Optimisers are deterministic: a repeated search evaluates the same designs and reads them from the
file instead of running them, so that every method resumes without code of its own.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dalembert.errors import FileError
from dalembert.files import atomic_path


class EvaluationLog:
    """JSON lines: a header with the fingerprint of the problem, then one design per line.

    Parameters
    ----------
    path : of the file; created if missing
    fingerprint : identification of the problem

    Raises
    ------
    FileError
        The file belongs to another problem, or is no log.
    """

    def __init__(self, path: str | Path, fingerprint: Mapping[str, object]):
        self.path = Path(path)
        self.entries: dict[bytes, dict[str, Any]] = {}
        expected = json.loads(json.dumps(fingerprint))
        if self.path.exists() and self.path.stat().st_size:
            self._read(expected)
        else:
            with atomic_path(self.path) as temporary:
                temporary.write_text(json.dumps(expected) + "\n", encoding="utf-8")

    def _read(self, expected: dict[str, Any]) -> None:
        text = self.path.read_text(encoding="utf-8")
        first, *lines = text.splitlines()
        try:
            header = json.loads(first)
        except ValueError:
            raise FileError(f"{self.path} is not an optimisation history") from None
        for key, value in expected.items():
            if not isinstance(header, dict) or header.get(key) != value:
                raise FileError(
                    f"{self.path} is the history of another problem ({key} differs); "
                    "give another file, or remove it"
                )
        for line in lines:
            try:
                entry = json.loads(line)
            except ValueError:  # truncated line of a killed run
                continue
            merged = self.entries.setdefault(self._key(entry["x"], entry.get("part", "")), {})
            merged.update(entry)
        if not text.endswith("\n"):  # terminate the truncated line
            self._append("\n")

    @staticmethod
    def _key(x: ArrayLike, part: str) -> bytes:
        return part.encode() + np.asarray(x, dtype=float).tobytes()

    def _append(self, text: str) -> None:
        with self.path.open("a", encoding="utf-8") as file:
            file.write(text)

    def find(self, x: np.ndarray, part: str = "") -> dict[str, Any] | None:
        """Entry of a design: ``terms`` and optionally ``gradient``, or a ``failure``."""
        return self.entries.get(self._key(x, part))

    def append(self, x: np.ndarray, part: str = "", **entry: Any) -> None:
        """Append the outcome of a run."""
        plain = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in entry.items()}
        self.entries.setdefault(self._key(x, part), {}).update(plain)
        part_entry = {"part": part} if part else {}
        entry = {**part_entry, "x": np.asarray(x, dtype=float).tolist(), **plain}
        self._append(json.dumps(entry) + "\n")

    def part(self, name: str = "") -> LogPart:
        """Section of one of several problems that share the file."""
        return LogPart(self, name)


@dataclass(frozen=True)
class LogPart:
    """Section of the log that belongs to one problem."""

    log: EvaluationLog
    name: str

    def find(self, x: np.ndarray) -> dict[str, Any] | None:
        """See ``EvaluationLog``."""
        return self.log.find(x, self.name)

    def append(self, x: np.ndarray, **entry: Any) -> None:
        """See ``EvaluationLog``."""
        self.log.append(x, self.name, **entry)
