"""Sample instants of blocks in the substeps of a stepper."""

from __future__ import annotations

from dalembert.analysis.dynamics.sampling import Sampling
from dalembert.errors import AnalysisError

CLOSE = 1e-9
"""Fraction of a substep that counts as zero."""


class SamplePhases:
    """Period and first sample of each block, counted in substeps.

    Parameters
    ----------
    sampling : Sampling of the model
    h, substeps : length of a substep [s], and number of substeps in a step

    Raises
    ------
    AnalysisError
        Samples of a block are not at ends of substeps.
    """

    def __init__(self, sampling: Sampling, h: float, substeps: int):
        self.sampling, self.h, self.substeps = sampling, h, substeps
        self.phases: list[tuple[int, int]] = []
        for block in sampling.blocks:
            counts = block.period / h, block.beginning / h
            period, first = map(round, counts)
            if period < 1 or not all(map(_whole, counts)):
                raise AnalysisError(
                    f"{block.name} is sampled every {block.period:g} s from {block.beginning:g} s, "
                    f"which are no multiples of the substep of {h:g} s; choose step and substeps "
                    "that fit"
                )
            self.phases.append((period, first))

    def check_time(self, time: float) -> None:
        """Raise if a start at a time moves samples into substeps.

        Raises
        ------
        AnalysisError
            The time is no multiple of a substep.
        """
        if not _whole(time / self.h):
            raise AnalysisError(
                f"time is {time:g} s, which is no multiple of the substep of {self.h:g} s, so that "
                "samples of blocks would be within substeps; choose a multiple"
            )

    @property
    def always(self) -> bool:
        """Whether all blocks are sampled before every substep."""
        return all(period == 1 and first <= 0 for period, first in self.phases)

    def check_repeated(self, count: int, start: float) -> None:
        """Raise unless steps from a number on have samples before the same substeps.

        Raises
        ------
        AnalysisError
            They differ.
        """
        begin = self._number(count, start)
        if any(self.substeps % period or first >= begin + period for period, first in self.phases):
            raise AnalysisError(
                "samples of blocks differ between steps, which no state-space model describes; use "
                "a common multiple of the sample times as step, and begin at the first sample"
            )

    def due(self, count: int, start: float) -> tuple[int, ...]:
        """Number of the sample before each substep of a step; -1 for none."""
        begin, numbers = self._number(count, start), []
        blocks = list(zip(self.sampling.blocks, self.phases, strict=True))
        for k in range(begin, begin + self.substeps):
            chosen = tuple(
                block
                for block, (period, first) in blocks
                if k >= first and (k - first) % period == 0
            )
            numbers.append(self.sampling.number(chosen) if chosen else -1)
        return tuple(numbers)

    def _number(self, count: int, start: float) -> int:
        """Number of the first substep of a step."""
        return round(start / self.h) + count * self.substeps


def _whole(count: float) -> bool:
    return abs(count - round(count)) <= CLOSE * max(abs(count), 1)
