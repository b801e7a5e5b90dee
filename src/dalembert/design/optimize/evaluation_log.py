"""Evaluations kept in a file, from which an interrupted optimisation goes on.

A search asked again takes the same way: what stands in the file is read instead of run, so every
method resumes where it stopped, without one of its own.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import FileError
from dalembert.files import atomic_path


class EvaluationLog:
    """Lines of JSON: what was asked first, then one design a line.

    Parameters
    ----------
    path : of the file; made if it is not there
    about : what tells this problem from others

    Raises
    ------
    FileError
        The file belongs to another problem, or is none.
    """

    def __init__(self, path: str | Path, about: Mapping[str, Any]):
        self.path = Path(path)
        self.known: dict[bytes, dict[str, Any]] = {}
        wanted = json.loads(json.dumps(about))
        if self.path.exists() and self.path.stat().st_size:
            self._read(wanted)
        else:
            with atomic_path(self.path) as temporary:
                temporary.write_text(json.dumps(wanted) + "\n", encoding="utf-8")

    def _read(self, wanted: dict[str, Any]) -> None:
        text = self.path.read_text(encoding="utf-8")
        first, *lines = text.splitlines()
        try:
            found = json.loads(first)
        except ValueError:
            raise FileError(f"{self.path} is no history of an optimisation") from None
        for key, value in wanted.items():
            if not isinstance(found, dict) or found.get(key) != value:
                raise FileError(
                    f"{self.path} is the history of another problem ({key} differs); "
                    "give another file, or remove it"
                )
        for line in lines:
            try:
                entry = json.loads(line)
            except ValueError:  # half a line of a run that was killed
                continue
            kept = self.known.setdefault(self._key(entry["x"], entry.get("part", "")), {})
            kept.update(entry)
        if not text.endswith("\n"):  # the next line begins anew
            self._append("\n")

    @staticmethod
    def _key(x: Any, part: str) -> bytes:
        return part.encode() + np.asarray(x, dtype=float).tobytes()

    def _append(self, text: str) -> None:
        with self.path.open("a", encoding="utf-8") as file:
            file.write(text)

    def find(self, x: np.ndarray, part: str = "") -> dict[str, Any] | None:
        """What is known of a design: ``terms`` and perhaps ``gradient``, or a ``failure``."""
        return self.known.get(self._key(x, part))

    def keep(self, x: np.ndarray, part: str = "", **entry: Any) -> None:
        """Write what a run gave."""
        plain = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in entry.items()}
        self.known.setdefault(self._key(x, part), {}).update(plain)
        named = {"part": part} if part else {}
        entry = {**named, "x": np.asarray(x, dtype=float).tolist(), **plain}
        self._append(json.dumps(entry) + "\n")

    def part(self, name: str = "") -> LogPart:
        """Evaluations of one of several problems that share the file."""
        return LogPart(self, name)


@dataclass(frozen=True)
class LogPart:
    """What one problem writes and finds there."""

    log: EvaluationLog
    name: str

    def find(self, x: np.ndarray) -> dict[str, Any] | None:
        """As of ``EvaluationLog``."""
        return self.log.find(x, self.name)

    def keep(self, x: np.ndarray, **entry: Any) -> None:
        """As of ``EvaluationLog``."""
        self.log.keep(x, self.name, **entry)
