"""The folder of a study: its answers in parts that are there whole or not at all."""

from __future__ import annotations

import json
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any

from dalembert.design.studies.tables import table_format
from dalembert.design.studies.task import Answer
from dalembert.errors import FileError
from dalembert.files import atomic_path, readable

ABOUT, LOCK, TABLE = "study.json", ".lock", "table"
DAMAGED = ".damaged"
"""Ending of the name of a part that could not be read."""
CHECK = "check"
"""Column of a part with the checksums of its rows; CSV has none of its own."""
UNPACKED = 20.0
"""Bytes of memory that a byte of a part takes."""


class StudyFolder:
    """Answers on disk, so that a study goes on where it was ended, however it was ended.

    A part holds the answers of one chunk and becomes visible in one step, so no design is lost
    or counted twice; the number of the first design, which is in no other part, names it.

    Raises
    ------
    FileError
        It belongs to another study, or one is at work in it.
    UnsupportedError
        Its answers are Parquet, and there is no pyarrow.
    """

    def __init__(self, path: str | Path, identity: str, about: dict[str, Any]):
        self.path = Path(path)
        self.parts = self.path / "parts"
        self.responses: Sequence[str] = about["responses"]
        try:
            self.parts.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = error.strerror or error
            raise FileError(f"{path}: cannot be written ({reason}); choose another") from None
        self.format = table_format(self.parts)
        self._lock = _locked(self.path / LOCK)
        try:
            self._claim(identity, about)
        except FileError:
            self.close()
            raise
        for left_over in self.parts.glob(".part-*"):
            left_over.unlink(missing_ok=True)

    def _claim(self, identity: str, about: dict[str, Any]) -> None:
        claim = self.path / ABOUT
        if not claim.exists():
            if any(self.parts.iterdir()):
                raise FileError(f"{self.path}: has parts but no {ABOUT}; choose another folder")
            with atomic_path(claim) as path:
                path.write_text(json.dumps({"identity": identity, **about}, indent=2), "utf-8")
            return
        try:
            found = json.loads(claim.read_text("utf-8"))["identity"]
        except (OSError, ValueError, KeyError, TypeError):
            raise FileError(f"{claim}: is not of a study; choose another folder") from None
        if found != identity:
            raise FileError(
                f"{self.path}: holds another study (other designs, responses, analysis or model); "
                "choose another folder, or remove this one"
            )

    def close(self) -> None:
        """Let others in."""
        self._lock.close()

    def answers(self) -> dict[int, Answer]:
        """All that is there, by number of the design.

        A damaged part is renamed, so that its designs are evaluated again.
        """
        found: dict[int, Answer] = {}
        for path in sorted(self.parts.glob(f"part-*{self.format.suffix}")):
            for answer in self._read(path):
                if answer.number in found:
                    raise FileError(f"{path}: design {answer.number} is in two parts")
                found[answer.number] = answer
        return found

    def _read(self, path: Path) -> list[Answer]:
        names = [f"r{k}" for k in range(len(self.responses))]
        try:
            readable(path, UNPACKED)
            found = self.format.read(path, [*names, CHECK])
            rows = zip(*(found[name] for name in names), strict=True)
            answers = [
                Answer(*row) for row in zip(found["design"], rows, found["reason"], strict=True)
            ]
            checks = found.get(CHECK)  # none in parts of earlier versions
            if checks is not None and checks != [_checksum(a) for a in answers]:
                raise ValueError("a row differs from its checksum")
            return answers
        except Exception:  # Parquet has errors of many kinds
            self._set_aside(path)
            return []

    @staticmethod
    def _set_aside(path: Path) -> None:
        try:
            path.replace(path.with_name(f"{path.name}{DAMAGED}"))
        except OSError as error:
            reason = error.strerror or error
            raise FileError(f"{path}: is damaged and cannot be renamed ({reason})") from None

    def add(self, answers: Sequence[Answer]) -> None:
        """Write the answers of a chunk."""
        columns: dict[str, Any] = {
            "design": [a.number for a in answers],
            "reason": [a.reason for a in answers],
        }
        for k in range(len(self.responses)):
            columns[f"r{k}"] = [float(a.values[k]) for a in answers]
        columns[CHECK] = [_checksum(a) for a in answers]
        first = min(a.number for a in answers)
        self.format.write(columns, self.parts / f"part-{first:09d}{self.format.suffix}")

    def finish(self, columns: dict[str, Any]) -> Path:
        """Write the table of the whole study."""
        target = self.path / f"{TABLE}{self.format.suffix}"
        self.format.write(columns, target)
        return target


def _checksum(answer: Answer) -> int:
    """CRC-32 of a row."""
    values = [float(value) for value in answer.values]
    return zlib.crc32(repr((int(answer.number), values, str(answer.reason))).encode())


def _locked(path: Path) -> IO[str]:
    """An open file that no other study has; the system frees it when the process ends."""
    opened = path.open("w")
    try:
        import fcntl

        fcntl.lockf(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except ImportError:  # no such locks on this system
        pass
    except OSError:
        opened.close()
        raise FileError(f"{path.parent}: a study is at work in it; wait for its end") from None
    return opened
