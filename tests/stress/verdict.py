"""Verdict of one case of the stress test."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

SOUND = ("completed", "ended", "refused")
DEFECTS = ("false success", "crash", "hang")


@dataclass(frozen=True)
class Verdict:
    """What became of a case.

    Attributes
    ----------
    family, seed : reproduce the case
    kind : "completed", "ended" (a status with its reason), "refused" (a typed error), or a defect:
        "false success", "crash", "hang"
    case : short description of the model and the strategies
    message : reason of the end, or the evidence of the defect
    seconds : wall time
    """

    family: str
    seed: int
    kind: str
    case: str = ""
    message: str = ""
    seconds: float = 0.0

    @property
    def sound(self) -> bool:
        return self.kind in SOUND

    @property
    def row(self) -> dict[str, Any]:
        return asdict(self)

    def __str__(self) -> str:
        return f"{self.kind}: {self.family} {self.seed} {self.case}: {self.message}"


Judge = Callable[[int], tuple[str, str, str]]
"""A family: seed → kind, case, message. Any exception is a crash."""
