"""Completeness of a random search, estimated by capture and recapture.

Starts that lead to assemblies are captures. The numbers f₁, f₂ of assemblies that were reached
once and twice yield a lower estimate of the number never reached (A. Chao 1984),

    f₀ ≥ f₁ (f₁ − 1) / (2 (f₂ + 1)) ,

and another assembly, reached by a share q of these starts, is missed with the probability
``(1 − q)ⁿ``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Completeness:
    """Completeness of a random search for assemblies.

    Attributes
    ----------
    starts : number of random starts
    hits : number of starts that led to each assembly
    not_isolated : starts that led to continuous families of assemblies, which are not listed
    ended : reason of termination
    """

    starts: int
    hits: tuple[int, ...]
    not_isolated: int
    ended: str

    @property
    def missing(self) -> float:
        """Estimated number of assemblies not reached."""
        once, twice = (sum(hit == k for hit in self.hits) for k in (1, 2))
        return once * (once - 1) / (2 * (twice + 1))

    @property
    def undetected_share(self) -> float:
        """Upper bound of the share of starts attracted by an undetected assembly (95 %)."""
        captures = sum(self.hits)
        return 1.0 if not captures else 1 - (1 - CONFIDENCE) ** (1 / captures)

    def __str__(self) -> str:
        closed = sum(self.hits)
        text = (
            f"{closed} of {self.starts} random starts closed, the rarest assembly "
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
    """Whether hits suffice: ``least`` in total, ``each`` on average, ``rarest`` at minimum."""
    return sum(hits) >= max(least, each * len(hits)) and min(hits) >= rarest
