"""All assembly configurations of a mechanism, and the completeness of their search.

The square system of the start (independent equations, and coordinates fixed at their guesses) has
as many roots as the mechanism has assembly configurations. Newton's method from random positions
finds them, many at once; how often each root is reached determines when to stop.

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

import numpy as np

from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.assembly.many_roots import ManyRoots
from dalembert.model.graph.assembly.position_search import RandomStarts, facing_function
from dalembert.symbolic.evaluation.backends import VirtualMachine
from dalembert.symbolic.evaluation.parallel import in_blocks

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


CLOSED, IMPLIED = 1e-10, 1e-9
"""Thresholds for the residual of an assembly, in natural sizes; for redundant equations."""
SAME, SAME_SINGULAR = 1e-6, 1e-3
"""Thresholds for the distance of equal assemblies, in natural sizes; for singular equations."""
SINGULAR = 1e-6
"""Threshold for singular equations: ratio of the smallest to the largest singular value."""
MIN_HITS, HITS_EACH, HITS_RAREST = 800, 200, 10
"""Successful starts required to end the search: in total, per assembly, for the rarest one."""
MAX_STARTS, WORK = 60_000, 3e9
"""Upper limits of the starts, and of the starts times the cube of the number of displacements."""
ALONG = 1e-2
"""Displacement for the test whether an assembly belongs to a continuous family."""


class Assemblies:
    """Assembly configurations of a mechanism at an instant.

    Parameters
    ----------
    closure : Closure of the mechanism
    t, p : instant [s] and (np,) parameter values

    Attributes
    ----------
    positions : (n_y,) each: the first one, then the nearest to it
    hits : number of starts that led to each
    """

    def __init__(self, closure: Closure, t: float, p: np.ndarray):
        self.closure, self.t, self.p = closure, t, p
        self.roots = ManyRoots(closure.assembler, t, p, closure.pinned)
        self.joints = ManyRoots(closure.assembler, t, p)
        self.sizes = closure.scales.displacements
        self.positions: list[np.ndarray] = []
        self.hits: list[int] = []
        self.singular: list[bool] = []
        self.not_isolated = 0
        self._facing = facing_function(closure.description, closure.all_equations)

    def search(
        self, first: np.ndarray | None, count: int | None, rng: np.random.Generator
    ) -> Completeness:
        """Find all assemblies, or ``count``; ``first`` is known already, or None.

        Without a first one, joints have the same orientation as in the nominal assembly.
        """
        closure, size = self.closure, self.sizes.size
        anchor = closure.anchor[1]
        self.reference = np.sign(self._face(anchor[None])[0])
        if first is not None:
            self._append(first, 0, not self._regular(first[None])[0])
        starts = RandomStarts(
            closure.description, closure.all_equations, closure.guesses, anchor, self.p
        )
        limit = int(np.clip(WORK / max(size, 1) ** 3, 40, MAX_STARTS))
        starts_done, reason = 0, f"the search ended at its limit of {limit} starts"
        while starts_done < limit:
            batch = min(256 if starts_done < 1024 else 1024, limit - starts_done)
            self._add(self.roots.newton(starts.draw(batch, rng)).y)
            starts_done += batch
            if count is not None and len(self.positions) >= count:
                reason = f"the search ended at the requested number of {count}"
                break
            if count is None and self._covered(starts_done):
                reason = "every assembly was reached often enough"
                break
        self._order(first, count)
        return Completeness(starts_done, tuple(self.hits), self.not_isolated, reason)

    def _covered(self, starts: int) -> bool:
        """Whether the search may end; singular assemblies are not counted."""
        hits = [h for h, singular in zip(self.hits, self.singular, strict=True) if not singular]
        if not hits:
            return starts >= 5 * MIN_HITS
        return covered(hits, MIN_HITS, HITS_EACH, HITS_RAREST)

    def _append(self, y: np.ndarray, hits: int, singular: bool) -> None:
        self.positions.append(y)
        self.hits.append(hits)
        self.singular.append(singular)

    def _order(self, first: np.ndarray | None, count: int | None) -> None:
        """Sort by the distance to the first one, or to the nominal assembly."""
        if not self.positions:
            return
        near = self.closure.anchor[1] if first is None else first
        far = np.linalg.norm(self.roots.apart(near, np.array(self.positions)), axis=1)
        order = np.argsort(far, kind="stable")[:count]
        for name in ("positions", "hits", "singular"):
            values = getattr(self, name)
            setattr(self, name, [values[k] for k in order])
        begin = 0 if first is None else 1
        self.positions[begin:] = [self.roots.unwound(near, y) for y in self.positions[begin:]]

    # classification of final positions ----------------------------------------------------------
    def _face(self, y: np.ndarray) -> np.ndarray:
        columns = VirtualMachine().columns(self._facing)
        t, p = np.full((len(y), 1), self.t), np.tile(self.p, (len(y), 1))
        return in_blocks(columns, 1, t, y, p)[0]

    def _add(self, y: np.ndarray) -> None:
        """Count the positions that are assemblies, and add the new ones."""
        y = y[self._assembled(y)]
        for k in range(len(self.positions)):
            y = y[~self._same(k, y)]
        regular = self._regular(y)
        while len(y):
            if not regular[0] and self._continuous(y[0]):
                self.not_isolated += int(np.sum(~regular))  # one test for all of a batch
                y, regular = y[regular], regular[regular]
                continue
            self._append(y[0], 0, not regular[0])
            new = ~self._same(len(self.positions) - 1, y)
            y, regular = y[new], regular[new]

    def _same(self, k: int, y: np.ndarray) -> np.ndarray:
        """(k,) which positions equal a known one; counts them."""
        if not len(y):
            return np.zeros(0, dtype=bool)
        distance = np.max(np.abs(self.roots.apart(self.positions[k], y)), axis=1, initial=0.0)
        same = distance <= (SAME_SINGULAR if self.singular[k] else SAME)
        self.hits[k] += int(np.sum(same))
        return same

    def _assembled(self, y: np.ndarray) -> np.ndarray:
        """(k,) which positions are closed, with all joints in the same orientation."""
        with np.errstate(all="ignore"):
            pinned, joints = (np.abs(r.evaluate(y)[0]) for r in (self.roots, self.joints))
            closed = np.max(pinned, axis=1, initial=0.0) <= CLOSED
            closed &= np.max(joints, axis=1, initial=0.0) <= IMPLIED
            return closed & np.all(np.sign(self._face(y)) == self.reference, axis=1)

    def _regular(self, y: np.ndarray) -> np.ndarray:
        """(k,) where the equations are regular."""
        if not len(y) or not self.sizes.size:
            return np.ones(len(y), dtype=bool)
        values = np.linalg.svd(self.roots.evaluate(y)[2], compute_uv=False)
        return values[:, -1] > SINGULAR * values[:, 0]

    def _continuous(self, y: np.ndarray) -> bool:
        """Whether an assembly belongs to a continuous family."""
        jacobian = self.roots.evaluate(y[None])[2][0]
        motion = np.linalg.svd(jacobian)[2][-1]
        step = ALONG * motion / np.max(np.abs(motion))
        there = self.roots.displaced(y[None], step[None])
        for _ in range(20):
            value, _, jacobians = self.roots.evaluate(there)
            if not np.all(np.isfinite(value)):
                return False
            back = -np.linalg.lstsq(jacobians[0], value[0], rcond=SINGULAR)[0]
            there = self.roots.displaced(there, back[None])
        if not np.max(np.abs(self.roots.evaluate(there)[0]), initial=0.0) <= CLOSED:
            return False
        return bool(np.max(np.abs(self.roots.apart(y, there))) > ALONG / 2)
