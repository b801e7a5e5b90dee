"""What is decided about the gaps at a state."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.model.contacts import Phases


@dataclass(frozen=True, eq=False)
class Ruling:
    """What is decided.

    Attributes
    ----------
    phases : of all gaps from now on
    gaps : numbers of those that take part in an impact
    pattern : their phases in it, empty where there is none
    dead : those that do not bounce, after bounces that accumulate
    impulse : ``P`` of the impact, None where there is none
    together : gaps that closed at the same time
    trouble : why nothing can be decided, or nothing
    acceleration : ``u̇`` of all gaps in these phases
    """

    phases: Phases
    gaps: tuple[int, ...] = ()
    pattern: Phases = ()
    dead: frozenset[int] = field(default_factory=frozenset)
    impulse: np.ndarray | None = None
    together: tuple[int, ...] = ()
    trouble: str = ""
    acceleration: np.ndarray | None = None
