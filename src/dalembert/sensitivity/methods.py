"""The ways to a gradient, as strategy objects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.sensitivity.checks.finite_difference import FiniteDifference
from dalembert.sensitivity.registry import engine_of


@dataclass(frozen=True)
class Direct:
    """Direct differentiation: cost grows with the number of parameters."""

    def gradient(
        self, motion: Result, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        """(responses, columns) derivatives."""
        return engine_of(motion, responses).direct(columns)


@dataclass(frozen=True)
class Adjoint:
    """Adjoint method: cost grows with the number of responses."""

    def gradient(
        self, motion: Result, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        """(responses, columns) derivatives."""
        return engine_of(motion, responses).adjoint()[:, list(columns)]


@dataclass(frozen=True)
class Automatic:
    """Adjoint unless there are fewer parameters than responses."""

    def choose(self, responses: int, parameters: int) -> Direct | Adjoint:
        """The cheaper method for these numbers."""
        return Direct() if parameters < responses else Adjoint()


Strategy = Direct | Adjoint | Automatic | FiniteDifference
Method = str | Strategy

METHODS: dict[str, Strategy] = {
    "auto": Automatic(),
    "adjoint": Adjoint(),
    "direct": Direct(),
    "finite-difference": FiniteDifference(),
}
