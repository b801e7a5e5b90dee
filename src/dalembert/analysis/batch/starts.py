"""Initial states of many designs, assembled at once."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.timeline import check_driver_laws
from dalembert.elements.driver import Driver
from dalembert.errors import AnalysisError
from dalembert.model.graph.assembly.many_starts import ManyStarts
from dalembert.model.graph.model import Model
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.evaluation.backends import BACKENDS, Backend
from dalembert.symbolic.evaluation.parallel import in_blocks
from dalembert.symbolic.formulas.expression import stack
from dalembert.symbolic.once import once


class Starts:
    """Parameters and initial states of many designs.

    Parameters
    ----------
    model, designs : model and parameters
    backend, workers : evaluator of functions, and its number of threads
    span : start and end of the run [s]
    needs_mass : masses must not become zero
    first : ``(t, y, p) → x`` from assembled positions

    Attributes
    ----------
    p : (designs, n) parameters including computed ones; nominal ones of refused designs
    started : numbers of the assembled designs
    x0 : (started, size) initial states
    y0 : (designs, n) assembled positions of the bodies
    statuses : number of the design → Status of designs that cannot be assembled
    """

    def __init__(
        self,
        model: Model,
        designs: Designs,
        backend: Backend,
        workers: int,
        span: tuple[float, float],
        needs_mass: bool,
        first: ca.Function,
    ):
        self.model, self.designs, self.count = model, designs, len(designs)
        self.backend, self.workers, self.first = backend, workers, first
        (self.start, self.end), self.needs_mass = span, needs_mass
        self.statuses: dict[int, Status] = {}
        self.p, candidates = self._parameters()
        self.x0, self.started = self._starts(candidates)

    def _parameters(self) -> tuple[np.ndarray, np.ndarray]:
        """(designs, n) parameters including computed ones, and numbers of valid designs."""
        table, model = self.designs.values, self.model
        suspect = model.unverified(table)
        p = np.tile(model.nominal, (self.count, 1))
        if model.parts.space.computed:
            for k in np.flatnonzero(~suspect):
                p[k] = model.completed(table[k])
        else:
            p[~suspect] = table[~suspect]
        suspect |= self._lose_mass(p)
        if any(isinstance(c, Driver) and c.positive for c in model.constraints):
            instants = np.linspace(self.start, self.end, 1001)
            for k in np.flatnonzero(~suspect):
                try:
                    check_driver_laws(model, instants, p[k])
                except AnalysisError:
                    suspect[k] = True
        return p, np.flatnonzero(~suspect)

    def _lose_mass(self, p: np.ndarray) -> np.ndarray:
        """(designs,) whether a mass is zero that was positive when the model was built."""
        if not self.needs_mass:
            return np.zeros(self.count, dtype=bool)
        y = np.tile(self.model.start.y, (self.count, 1))
        (mass,) = self.evaluate(_masses(self.model), y, p)
        mass[:, list(self.model.equations.massless)] = 1.0
        return np.any(mass == 0, axis=1)

    def evaluate(self, function: ca.Function, *arguments: np.ndarray) -> list[np.ndarray]:
        """Results of a function for rows of arguments."""
        return in_blocks(self.backend.columns(function), self.workers, *arguments)

    def _starts(self, candidates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Initial states and numbers of the designs that can be assembled."""
        many, p = ManyStarts(self.model.closure, self.evaluate), self.p[candidates]
        y, fraction, assembled = many.positions(p, self.start)
        first = self.model.closure.anchor[0]
        if (failed := np.flatnonzero(~assembled)).size:
            failed_p = first + fraction[failed, None] * (p[failed] - first)
            for k, row, gap in zip(
                candidates[failed], *many.gaps(self.start, y[failed], failed_p), strict=True
            ):
                self.statuses[int(k)] = self._not_assembled(int(row), float(gap))
        y, p, candidates = y[assembled], p[assembled], candidates[assembled]
        y, steady = many.with_steady_states(y, self.start, p)
        t = np.full((candidates.size, 1), self.start)
        (x0,) = self.evaluate(self.first, t, y, p)
        defined = np.all(np.isfinite(x0), axis=1) & steady
        self.y0 = np.full((self.count, y.shape[1]), np.nan)
        self.y0[candidates] = y
        return x0[defined], candidates[defined]

    def _not_assembled(self, row: int, gap: float) -> Status:
        """Status of a design that cannot be assembled; it names the joint that is open most."""
        name, unit = "an initial condition", ""
        if row >= 0:
            constraint, k = self.model.closure.owners[row]
            name, unit = constraint.name, constraint.units()[k]
        return Status(
            Outcome.NOT_ASSEMBLED,
            f"cannot be assembled on the branch of the nominal assembly at t = {self.start:g} s: "
            f"{name} stays open by {gap:.3g} {unit} where the branch ends; run the design alone to "
            "search for other assemblies",
            float("nan"),
            gap,
        )


@once
def backend_of(model: Model) -> Backend:
    """Default backend of analyses of a model."""
    return BACKENDS["auto"]()


def starting_mode(kernel: DynamicsKernel, model: Model) -> int:
    """The mode of the nominal start."""
    start, p = model.start, model.nominal
    x = kernel.start.function(0.0, start.y, start.v, p).full().ravel()
    return kernel.choose(0.0, x, p)


@once
def _masses(model: Model) -> ca.Function:
    """``(y, p) →`` diagonal of the mass matrix."""
    e = model.all_equations
    return ca.Function("masses", [e.y, e.p], [ca.densify(stack([ca.diag(e.mass)]))])


@once
def first_states(kernel: DynamicsKernel, mode: int) -> ca.Function:
    """``(t, y, p) → x`` from assembled positions."""
    model = kernel.model
    t, y, p = (ca.SX.sym(s, n) for s, n in zip("typ", model.initial_state.input_sizes, strict=True))
    position, speeds = model.initial_state.function(t, y, p)
    x = kernel.start.function(t, position, speeds, p)
    step = kernel.variants[mode].step
    if step.begin is None:
        return ca.Function("first", [t, y, p], [x], {"cse": True})
    first = ca.Function("first", [t, y, p], [x])
    arguments = [
        ca.MX.sym(s, n) for s, n in zip("typ", model.initial_state.input_sizes, strict=True)
    ]
    state = first(*arguments)
    memory = step.begin.function(arguments[0], state, arguments[2])
    return ca.Function("first", arguments, [ca.densify(ca.vertcat(state, memory))])
