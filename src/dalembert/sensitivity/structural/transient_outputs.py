"""Where responses look at the motion of a structure: at ends of steps, and inside of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dalembert.results.structural.measured_states import Formula
from dalembert.sensitivity.marching.sightings import Sightings
from dalembert.sensitivity.samples import Sample

Look = tuple[int, int]
"""Number of a response, and of an output that it looks at."""


class Seen(NamedTuple):
    """What responses weigh at one instant; columns by response.

    Attributes
    ----------
    u, v, a, forces : (n, rows)
    p : (np, rows)
    """

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    forces: np.ndarray
    p: np.ndarray


class Looks:
    """The outputs that weigh in sampled responses of one run.

    Parameters
    ----------
    samples : of the same run

    Attributes
    ----------
    ends : number of steps taken → looks at their end
    inside : number of steps taken → length of the shorter step → looks at its end
    """

    def __init__(self, samples: Sequence[Sample]):
        self.samples = list(samples)
        self.record = self.samples[0].motion.record
        self._formulas = [Formula(s.motion, s.measure.sx) for s in self.samples]  # type: ignore[arg-type]
        self.ends: dict[int, list[Look]] = {}
        self.inside: dict[int, dict[float, list[Look]]] = {}
        for r, sample in enumerate(self.samples):
            self._place(r, sample)

    def _place(self, r: int, sample: Sample) -> None:
        sightings = Sightings(sample)
        for k in (int(k) for k in sightings.active):
            node = int(sightings.number[k])
            if sightings.within[k]:
                length = float(sightings.branches.length[k])
                self.inside.setdefault(node, {}).setdefault(length, []).append((r, k))
            else:
                self.ends.setdefault(node, []).append((r, k))

    def motion(self, look: Look):
        """The motion that a look looks at."""
        return self.samples[look[0]].motion

    def seen(self, looks: Sequence[Look], size: int, parameters: int) -> Seen:
        """What the responses weigh there."""
        rows = len(self.samples)
        u, v, a, forces = (np.zeros((size, rows)) for _ in range(4))
        p = np.zeros((parameters, rows))
        for r, k in looks:
            found = self._formulas[r].weights(k, float(self.samples[r].weights[k]))
            whole = (found.u, found.v, found.a, found.forces, found.p)  # type: ignore[attr-defined]
            for column, weight in zip((u, v, a, forces, p), whole, strict=True):
                column[:, r] += weight
        return Seen(u, v, a, forces, p)
