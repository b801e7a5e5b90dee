"""Estimate of what a random search has missed, by capture and recapture.

Starts that lead to assemblies are captures. From how many assemblies were reached once and twice
follows a lower estimate of those never reached (A. Chao 1984),

    f₀ ≥ f₁ (f₁ − 1) / (2 (f₂ + 1)) ,

and one more assembly that a share q of these starts leads to is missed with the probability
``(1 − q)ⁿ``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Completeness:
    """How completely a random search has covered the assemblies.

    Attributes
    ----------
    starts : random starts
    hits : of each assembly in their order, how many starts led to it
    not_isolated : starts that led to assemblies in a continuous family, which are not listed
    ended : why the search ended
    """

    starts: int
    hits: tuple[int, ...]
    not_isolated: int
    ended: str

    @property
    def missing(self) -> float:
        """Estimated number of assemblies that were not reached."""
        once, twice = (sum(hit == k for hit in self.hits) for k in (1, 2))
        return once * (once - 1) / (2 * (twice + 1))

    @property
    def undetected_share(self) -> float:
        """Largest share of the successful starts that one more assembly may attract (95 %)."""
        captures = sum(self.hits)
        return 1.0 if not captures else 1 - (1 - CONFIDENCE) ** (1 / captures)

    def __str__(self) -> str:
        seen = sum(self.hits)
        text = (
            f"{seen} of {self.starts} random starts closed, the rarest assembly "
            f"{min(self.hits, default=0)} times; estimated number missing {self.missing:.2g}; "
            f"another assembly would attract less than {100 * self.undetected_share:.2g} % of them "
            "(95 %)"
        )
        if self.not_isolated:
            text += (
                f"; {self.not_isolated} starts ended in continuous families of assemblies, which "
                "are not listed"
            )
        return f"{text}; {self.ended}"

    def to_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "starts": self.starts,
            "hits": list(self.hits),
            "missing": self.missing,
            "undetected_share": self.undetected_share,
            "not_isolated": self.not_isolated,
            "ended": self.ended,
        }


def covered(hits: Sequence[int], least: int, each: int, rarest: int) -> bool:
    """Whether starts suffice: ``least`` in all, ``each`` on average, ``rarest`` for every one."""
    return sum(hits) >= max(least, each * len(hits)) and min(hits) >= rarest
