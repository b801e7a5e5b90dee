"""What the synthesis of a mechanism of one's own ends with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.design.synthesis.candidates import Candidate, Candidates
from dalembert.results.motion import Motion


@dataclass(frozen=True, eq=False)
class FoundMechanism(Candidate):
    """A mechanism and how it meets the target.

    Attributes
    ----------
    parameters : name → value
    crank_angles : (n,) turned by the motor at the entries of the target
    error : sum of squares of what is in the target
    distances : (n,) of the points, or of the outputs
    motion : a turn of the motor
    entries : the same motion at the entries
    measures : ``"x"``, ``"y"``, ``"angle"``, ``"output"`` → measure, as far as the target has it
    """

    parameters: dict[str, float]
    crank_angles: np.ndarray
    error: float
    distances: np.ndarray
    motion: Motion = field(repr=False)
    entries: Motion = field(repr=False)
    measures: Mapping[str, str] = field(repr=False)

    @property
    def numbers(self) -> dict[str, float]:
        return self.parameters

    @property
    def units(self) -> dict[str, str]:
        known = self.motion.model.parameters
        return {name: known[name].unit for name in self.parameters}

    def told(self) -> dict[str, Any]:
        return {"crank_turns": True}

    def _path(self, motion: Motion) -> np.ndarray:
        return np.column_stack([motion.values(self.measures[axis]) for axis in "xy"])

    def curve(self) -> np.ndarray:
        return self._path(self.motion)

    def passed(self) -> np.ndarray:
        return self._path(self.entries)

    def reached(self) -> np.ndarray:
        return np.unwrap(self.entries.values(self.measures["output"]))

    @property
    def watched(self) -> list[str]:
        return list(self.measures.values())

    def page(self) -> dict[str, Any]:
        trace = [self.measures["x"].removesuffix(".x")] if "x" in self.measures else []
        return self.motion.page(trace=trace)


@dataclass(eq=False, repr=False)
class MechanismSynthesis(Candidates):
    """Mechanisms of one topology, best first; each differs from the others."""

    @property
    def kind(self) -> str:
        return str(self.best.motion.model.name)
