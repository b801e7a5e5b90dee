"""Outputs of a structural transient with weights in responses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dalembert.results.structural.measured_states import Formula
from dalembert.sensitivity.marching.sightings import SampledOutputs
from dalembert.sensitivity.samples import Sample

Output = tuple[int, int]
"""Number of a response and of one of its outputs."""


class StateWeights(NamedTuple):
    """Weights of the state at one instant; columns by response.

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


class WeighedOutputs:
    """Outputs with nonzero weights in sampled responses of one run.

    Parameters
    ----------
    samples : samples of the same run

    Attributes
    ----------
    ends : number of steps → outputs at the end of the last one
    inside : number of steps → length of the partial step after them → outputs at its end
    """

    def __init__(self, samples: Sequence[Sample]):
        self.samples = list(samples)
        self.record = self.samples[0].motion.record
        self._formulas = [Formula(s.motion, s.measure.sx) for s in self.samples]  # type: ignore[arg-type]
        self.ends: dict[int, list[Output]] = {}
        self.inside: dict[int, dict[float, list[Output]]] = {}
        for r, sample in enumerate(self.samples):
            self._add_sample(r, sample)

    def _add_sample(self, r: int, sample: Sample) -> None:
        outputs = SampledOutputs(sample)
        for k in (int(k) for k in outputs.active):
            node = int(outputs.number[k])
            if outputs.within[k]:
                length = float(outputs.branches.length[k])
                self.inside.setdefault(node, {}).setdefault(length, []).append((r, k))
            else:
                self.ends.setdefault(node, []).append((r, k))

    def motion(self, output: Output):
        """The motion of an output."""
        return self.samples[output[0]].motion

    def weights(self, outputs: Sequence[Output], size: int, parameters: int) -> StateWeights:
        """Sum of the weights of these outputs, which are at the same instant."""
        rows = len(self.samples)
        u, v, a, forces = (np.zeros((size, rows)) for _ in range(4))
        p = np.zeros((parameters, rows))
        for r, k in outputs:
            w = self._formulas[r].weights(k, float(self.samples[r].weights[k]))
            parts = (w.u, w.v, w.a, w.forces, w.p)  # type: ignore[attr-defined]
            for column, weight in zip((u, v, a, forces, p), parts, strict=True):
                column[:, r] += weight
        return StateWeights(u, v, a, forces, p)
