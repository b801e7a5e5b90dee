"""States of many designs at the outputs, and evaluation of measures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.variant import Variant
from dalembert.budget import check_budget
from dalembert.model.graph.model import Model
from dalembert.results.batch.samples import write_samples
from dalembert.results.result import Result
from dalembert.symbolic.evaluation.backends import Backend
from dalembert.symbolic.evaluation.parallel import BLOCK, gathered_blocks
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once


@dataclass(eq=False)
class States:
    """States at the outputs; measures are evaluated from them on request.

    Attributes
    ----------
    model : Model
    bodies : ``(t, x, p) → y, v, v̇, λ`` of all bodies and equations
    backend : evaluator of functions
    time : (K,) outputs [s]
    p : (designs, n) parameters including computed ones
    x : (designs, K, size) states; NaN where there are none
    workers : number of threads
    individual : number of the design → result of its individual run
    """

    model: Model
    bodies: ca.Function
    backend: Backend
    time: np.ndarray
    p: np.ndarray
    x: np.ndarray
    workers: int
    individual: Mapping[int, Result] = field(default_factory=dict)

    def table(self, measures: Sequence[Expression]) -> np.ndarray:
        function = measured(self.model, self.bodies, tuple(measures))
        finished = (
            np.flatnonzero(np.isfinite(self.x[:, 0, 0])) if self.time.size else np.zeros(0, int)
        )
        rows = function.numel_out(0)
        table = np.full((len(self.x), rows, self.time.size), np.nan)
        if finished.size:
            (values,) = self.evaluate(function, finished, np.arange(self.time.size))
            table[finished] = values.transpose(0, 2, 1)
        for k, result in self.individual.items():
            write_samples(table[k], self.time, result, measures)
        return table

    def evaluate(
        self, function: ca.Function, designs: np.ndarray, outputs: np.ndarray
    ) -> list[np.ndarray]:
        """(designs, outputs, rows) results of a ``(t, x, p)`` function at outputs of designs.

        ``outputs`` has the shape (outputs,), common to all designs, or (designs, outputs).
        """
        count, size = outputs.shape[-1], function.numel_in(1)
        all_outputs = count == self.time.size and outputs.ndim == 1

        def arguments(part: slice) -> list[np.ndarray]:
            selected = designs[part]
            chosen = outputs[part] if outputs.ndim > 1 else outputs
            x = self.x[selected] if all_outputs else self.x[selected[:, None], chosen]
            times = np.broadcast_to(self.time[chosen], (selected.size, count))
            p = np.repeat(self.p[selected], count, axis=0)
            return [times.reshape(-1, 1), x[..., :size].reshape(-1, size), p]

        blocks = gathered_blocks(
            self.backend.columns(function),
            self.workers,
            len(designs),
            max(1, BLOCK // max(count, 1)),
            arguments,
            count,
        )
        return [values.reshape(len(designs), count, -1) for values in blocks]


@dataclass(eq=False, kw_only=True)
class MarchedStates(States):
    """States of the integrated coordinates.

    Attributes
    ----------
    kernel, mode : kernel of the runs, and the mode of all steps
    """

    kernel: DynamicsKernel
    mode: int

    @property
    def variant(self) -> Variant:
        return self.kernel.variants[self.mode]


def check_memory(designs: int, outputs: int, size: int) -> None:
    """Refuse more outputs than memory permits.

    Parameters
    ----------
    designs, outputs : numbers of designs and of outputs of each
    size : number of entries of a state
    """
    check_budget(
        f"{designs} designs with {outputs} outputs of {size} numbers",
        memory=24.0 * designs * outputs * size,
        cure="request fewer, e.g. outputs=101, or run the designs in several batches",
    )


@once
def measured(model: Model, bodies: ca.Function, measures: tuple[Expression, ...]) -> ca.Function:
    """``(t, x, p) → measures`` as one column, as in a motion."""
    function = model.function(*measures)
    t, x, p = bodies.sx_in()
    y, v, a, multiplier = bodies.call([t, x, p])
    forces = ca.vertcat(multiplier, ca.SX.zeros(function.size1_in(4) - multiplier.numel()))
    column = function.call([t, y, v, a, forces, p])
    return ca.Function("measured", [t, x, p], column, {"cse": True})
