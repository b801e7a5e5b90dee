"""What is decided about the gaps at a state."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.analysis.contact.pattern import Pattern
from dalembert.model.contacts import Phases


@dataclass(frozen=True, eq=False)
class Ruling:
    """What is decided.

    Attributes
    ----------
    phases : of all gaps from now on
    gaps : numbers of those that take part in an impact
    patterns : what they do in it, in compression and in restitution where these are apart; empty
        where there is none
    dead : those that do not bounce, after bounces that accumulate
    impulse : ``P`` of the impact, None where there is none
    together : gaps that closed at the same time
    trouble : why nothing can be decided, or nothing
    acceleration : ``u̇`` of all gaps in these phases
    resting : numbers of the gaps that touch without moving apart
    rest : what these do
    """

    phases: Phases
    gaps: tuple[int, ...] = ()
    patterns: tuple[Pattern, ...] = ()
    dead: frozenset[int] = field(default_factory=frozenset)
    impulse: np.ndarray | None = None
    together: tuple[int, ...] = ()
    trouble: str = ""
    acceleration: np.ndarray | None = None
    resting: tuple[int, ...] = ()
    rest: Pattern | None = None
