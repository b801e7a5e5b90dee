"""Folder of a study: answers in Parquet or CSV parts that are written atomically."""

from __future__ import annotations

import csv
import json
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from dalembert.design.studies.task import Answer
from dalembert.errors import FileError
from dalembert.files import atomic_path, locked_file, readable
from dalembert.packages import optional_package

ABOUT, LOCK, TABLE = "study.json", ".lock", "table"
DAMAGED = ".damaged"
"""Suffix of a part that could not be read."""
CHECK = "check"
"""Column of a part with the checksums of its rows, as CSV has none."""
UNPACKED = 20.0
"""Bytes of memory per byte of a part."""


class TableFormat(Protocol):
    """Format of a table file that is written atomically."""

    suffix: str

    def write(self, columns: Mapping[str, ArrayLike], target: Path) -> None:
        """Write columns of integers, numbers (NaN if missing) and texts."""
        ...

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        """Read columns: ``design`` as integers, ``numbers`` as numbers, others as texts."""
        ...


class Parquet:
    """Apache Parquet, through pyarrow."""

    suffix = ".parquet"

    def write(self, columns: Mapping[str, ArrayLike], target: Path) -> None:
        import pyarrow as arrow
        import pyarrow.parquet as parquet

        arrays = {}
        for name, values in columns.items():
            column = np.asarray(values)
            if column.dtype.kind == "f":  # NaN as null, so that equal tables compare equal
                arrays[name] = arrow.array(column.astype(float), from_pandas=True)
            else:
                arrow_type = arrow.int64() if column.dtype.kind == "i" else arrow.string()
                arrays[name] = arrow.array(column.tolist(), arrow_type)
        with atomic_path(target) as path:
            parquet.write_table(arrow.table(arrays), path, write_page_checksum=True)

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        import pyarrow.parquet as parquet

        table = parquet.read_table(path, page_checksum_verification=True)
        return {
            name: table[name].to_numpy().tolist() if name in numbers else table[name].to_pylist()
            for name in table.column_names
        }


class Csv:
    """Comma-separated values; numbers have all digits, NaN is an empty cell."""

    suffix = ".csv"

    def write(self, columns: Mapping[str, ArrayLike], target: Path) -> None:
        cells = [[_cell(value) for value in np.asarray(c).tolist()] for c in columns.values()]
        with atomic_path(target) as path, path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*cells, strict=True))

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        with path.open(newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file, strict=True)
        columns: dict[str, list[Any]] = {
            name: list(column) for name, column in zip(head, zip(*rows, strict=True), strict=True)
        }
        for name in numbers:
            columns[name] = [float(cell) if cell else float("nan") for cell in columns[name]]
        columns["design"] = [int(cell) for cell in columns["design"]]
        return columns


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(value)
    return str(value)


def table_format(parts: Path) -> TableFormat:
    """Format of the existing parts; of a new study Parquet, or CSV without pyarrow.

    Raises
    ------
    UnsupportedError
        The parts are Parquet, and pyarrow is not installed.
    """
    if any(parts.glob("part-*.csv")):
        return Csv()
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        if any(parts.glob("part-*.parquet")):
            optional_package("pyarrow", f"{parts}: continuing this study")
        return Csv()
    return Parquet()


class StudyFolder:
    """Answers on disk, from which an interrupted or killed study resumes.

    A part holds the answers of one chunk and is written atomically, so that no design is lost or
    counted twice. It is named by the number of its first design.

    Raises
    ------
    FileError
        The folder belongs to another study, or a study is running in it.
    UnsupportedError
        Its answers are Parquet, and pyarrow is not installed.
    """

    def __init__(self, path: str | Path, identity: str, description: dict[str, Any]):
        self.path = Path(path)
        self.parts = self.path / "parts"
        self.responses: Sequence[str] = description["responses"]
        try:
            self.parts.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = error.strerror or error
            raise FileError(f"{path}: cannot be written ({reason}); choose another") from None
        self.format = table_format(self.parts)
        lock = locked_file(self.path / LOCK)
        if lock is None:
            raise FileError(f"{self.path}: a study is running in this folder; wait for its end")
        self._lock = lock
        try:
            self._claim(identity, description)
        except FileError:
            self.close()
            raise
        for temporary in self.parts.glob(".part-*"):
            temporary.unlink(missing_ok=True)

    def _claim(self, identity: str, description: dict[str, Any]) -> None:
        claim = self.path / ABOUT
        if not claim.exists():
            if any(self.parts.iterdir()):
                raise FileError(f"{self.path}: has parts but no {ABOUT}; choose another folder")
            with atomic_path(claim) as path:
                path.write_text(
                    json.dumps({"identity": identity, **description}, indent=2), "utf-8"
                )
            return
        try:
            stored = json.loads(claim.read_text("utf-8"))["identity"]
        except (OSError, ValueError, KeyError, TypeError):
            raise FileError(f"{claim}: does not describe a study; choose another folder") from None
        if stored != identity:
            raise FileError(
                f"{self.path}: holds another study (other designs, responses, analysis or model); "
                "choose another folder, or remove this one"
            )

    def close(self) -> None:
        """Release the folder."""
        self._lock.close()

    def answers(self) -> dict[int, Answer]:
        """Stored answers by number of the design.

        Damaged parts are renamed, so that their designs are evaluated again.
        """
        answers: dict[int, Answer] = {}
        for path in sorted(self.parts.glob(f"part-*{self.format.suffix}")):
            for answer in self._read(path):
                if answer.number in answers:
                    raise FileError(f"{path}: design {answer.number} is in two parts")
                answers[answer.number] = answer
        return answers

    def _read(self, path: Path) -> list[Answer]:
        names = [f"r{k}" for k in range(len(self.responses))]
        try:
            readable(path, UNPACKED)
            columns = self.format.read(path, [*names, CHECK])
            rows = zip(*(columns[name] for name in names), strict=True)
            answers = [
                Answer(*row) for row in zip(columns["design"], rows, columns["reason"], strict=True)
            ]
            checks = columns.get(CHECK)  # missing in parts of earlier versions
            if checks is not None and checks != [_checksum(answer) for answer in answers]:
                raise ValueError("a row differs from its checksum")
            return answers
        except Exception:  # Parquet raises many kinds of errors
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
            "design": [answer.number for answer in answers],
            "reason": [answer.reason for answer in answers],
        }
        for k in range(len(self.responses)):
            columns[f"r{k}"] = [float(answer.values[k]) for answer in answers]
        columns[CHECK] = [_checksum(answer) for answer in answers]
        first = min(answer.number for answer in answers)
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
