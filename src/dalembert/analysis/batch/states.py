"""States of many designs at the outputs, and any measure of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.variant import Variant
from dalembert.model.model import Model
from dalembert.results.batch.samples import write_samples
from dalembert.results.result import Result
from dalembert.symbolic.evaluation.backends import Backend
from dalembert.symbolic.evaluation.shared_columns import BLOCK, gathered_blocks
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once


@dataclass(eq=False)
class States:
    """States at the outputs; what else there is follows from them when asked for.

    Attributes
    ----------
    model : Model
    bodies : ``(t, x, p) → y, v, v̇, λ`` of all bodies and equations
    backend : what evaluates functions
    time : (K,) outputs [s]
    p : (designs, n) parameters with all that is computed of them
    x : (designs, K, size) states; NaN where there is none
    workers : threads
    apart : number of the design → its result, of those that ran on their own
    """

    model: Model
    bodies: ca.Function
    backend: Backend
    time: np.ndarray
    p: np.ndarray
    x: np.ndarray
    workers: int
    apart: Mapping[int, Result] = field(default_factory=dict)

    def table(self, measures: Sequence[Expression]) -> np.ndarray:
        function = measured(self.model, self.bodies, tuple(measures))
        known = np.flatnonzero(np.isfinite(self.x[:, 0, 0])) if self.time.size else np.zeros(0, int)
        rows = function.numel_out(0)
        found = np.full((len(self.x), rows, self.time.size), np.nan)
        if known.size:
            (values,) = self.evaluate(function, known, np.arange(self.time.size))
            found[known] = values.transpose(0, 2, 1)
        for k, result in self.apart.items():
            write_samples(found[k], self.time, result, measures)
        return found

    def evaluate(
        self, function: ca.Function, designs: np.ndarray, outputs: np.ndarray
    ) -> list[np.ndarray]:
        """(designs, outputs, rows) of ``(t, x, p)`` functions at some outputs of some designs.

        ``outputs`` are those of all, (outputs,), or of each, (designs, outputs).
        """
        each, size = outputs.shape[-1], function.numel_in(1)
        every = each == self.time.size and outputs.ndim == 1

        def given(part: slice) -> list[np.ndarray]:
            some = designs[part]
            chosen = outputs[part] if outputs.ndim > 1 else outputs
            x = self.x[some] if every else self.x[some[:, None], chosen]
            times = np.broadcast_to(self.time[chosen], (some.size, each))
            p = np.repeat(self.p[some], each, axis=0)
            return [times.reshape(-1, 1), x[..., :size].reshape(-1, size), p]

        found = gathered_blocks(
            self.backend.columns(function),
            self.workers,
            len(designs),
            max(1, BLOCK // max(each, 1)),
            given,
            each,
        )
        return [values.reshape(len(designs), each, -1) for values in found]


@dataclass(eq=False, kw_only=True)
class MarchedStates(States):
    """States of the integrated coordinates.

    Attributes
    ----------
    kernel, mode : of the runs, and the variant that all have used
    """

    kernel: DynamicsKernel
    mode: int

    @property
    def variant(self) -> Variant:
        return self.kernel.variants[self.mode]


@once
def measured(model: Model, bodies: ca.Function, measures: tuple[Expression, ...]) -> ca.Function:
    """``(t, x, p) → measures`` one above the other, as a motion takes them."""
    function = model.function(*measures)
    t, x, p = bodies.sx_in()
    y, v, a, multiplier = bodies.call([t, x, p])
    forces = ca.vertcat(multiplier, ca.SX.zeros(function.size1_in(4) - multiplier.numel()))
    column = function.call([t, y, v, a, forces, p])
    return ca.Function("measured", [t, x, p], column, {"cse": True})
