"""Exported files in memory and on disk, and what could not be expressed in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from dalembert.io.omission import Omission


@dataclass(frozen=True)
class Files:
    """Files in memory, so that nothing is written before all of it is complete.

    Attributes
    ----------
    files : name → contents; the first is the main one
    omissions : parts that they do not contain
    """

    files: dict[str, bytes]
    omissions: Sequence[Omission] = ()


@dataclass(frozen=True)
class Exported:
    """Written files.

    Attributes
    ----------
    files : their paths; the first is the main one
    omissions : parts of the model or result that they do not contain; also comments in the file
        where the format has comments
    """

    files: list[Path]
    omissions: list[Omission] = field(default_factory=list)

    def __repr__(self) -> str:
        names = ", ".join(path.name for path in self.files[:3])
        more = f" and {len(self.files) - 3} more" if len(self.files) > 3 else ""
        without = f", without {len(self.omissions)} part(s)" if self.omissions else ""
        return f"<Exported {names}{more}{without}>"
