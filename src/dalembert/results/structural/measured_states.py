"""Formulas of measures over the states of a structure, and what they weigh."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.result import Result
from dalembert.structures.measuring.measures import Measure, State, Weights
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.symbolic.once import once


class MeasuredStates(Result):
    """States by number, load cases or instants, and any formula of their measures.

    Attributes
    ----------
    model : StructuralModel
    parameters : (np,) values used
    time : (K,) instants, or numbers of the states
    """

    model: StructuralModel
    parameters: np.ndarray

    def state(self, k: int) -> State:
        """What a measure sees."""
        raise NotImplementedError

    def measure(self, name: str) -> Measure:
        """What a symbol in a formula stands for."""
        return self.model.measure(name)

    def no_weights(self) -> Weights:
        """Weights of nothing, to which those of measures are added."""
        return Weights.zero(len(self.model.degrees), self.parameters.size)

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, or a formula of measures."""
        return self.model.expression(measure)

    def __contains__(self, measure: object) -> bool:
        if not super().__contains__(measure):
            return False
        try:  # the measures of a motion have names in statics, too, and no values
            self.values(measure)  # type: ignore[arg-type]
        except AnalysisError:
            return False
        return True

    def keys(self) -> list[str]:
        energy = ["kinetic_energy"]
        names = super().keys()
        return [name for name in names if name not in energy or name in self]

    def values(self, measure: str | Expression) -> np.ndarray:
        """(K,) values of a scalar measure or formula."""
        return Formula(self, self.expression(measure).sx).values

    def weights(self, sx: ca.SX, k: int) -> Weights:
        """What a formula weighs the state ``k`` and the parameters."""
        return Formula(self, sx).weights(k)


class FormulaGraph:
    """A formula and its derivatives as functions of time, measures and parameters.

    Parameters
    ----------
    model : StructuralModel
    sx : the formula

    Attributes
    ----------
    names : of the measures
    alone : whether it is one measure and nothing else
    """

    def __init__(self, model: StructuralModel, sx: ca.SX):
        others = {"t", *model.parameters}
        found = [s for s in ca.symvar(sx) if s.name() not in others]
        self.names, self.alone = [s.name() for s in found], bool(found) and sx.is_symbolic()
        self._sx, self._given = sx, [t.sx, stack(found), model.p]

    @cached_property
    def value(self) -> ca.Function:
        """The formula."""
        return ca.Function("formula", self._given, [ca.densify(self._sx)])

    @cached_property
    def slopes(self) -> ca.Function:
        """Its derivatives by measures and parameters."""
        slopes = [ca.densify(ca.gradient(self._sx, by)) for by in self._given[1:]]
        return ca.Function("slopes", self._given, slopes)

    @cached_property
    def turns(self) -> ca.Function:
        """Change of the slopes with the measures and the parameters."""
        given = self._given
        seen = ca.vertcat(*given[1:])
        change = ca.SX.sym("change", seen.numel())
        turned = [ca.densify(ca.jtimes(slope, seen, change)) for slope in self.slopes(*given)]
        return ca.Function("turns", [*given, change], turned)


@once
def formula_graph(model: StructuralModel, sx: ca.SX) -> FormulaGraph:
    """The functions of a formula, compiled where they are needed first."""
    return FormulaGraph(model, sx)


@dataclass
class Formula:
    """A scalar formula of measures, parameters and time, over all states.

    Parameters
    ----------
    states : MeasuredStates
    sx : the formula
    """

    states: MeasuredStates
    sx: ca.SX

    def __post_init__(self) -> None:
        self._graph = formula_graph(self.states.model, self.sx)
        self._measures = [self.states.measure(name) for name in self._graph.names]

    @property
    def values(self) -> np.ndarray:
        """(K,) at all states."""
        count, graph = len(self.states.time), self._graph
        numbers = np.array([self._numbers(k) for k in range(count)]).reshape(count, -1).T
        if graph.alone or not count:
            return numbers.ravel()
        p = np.tile(self.states.parameters[:, None], count)
        return graph.value.map(count)(self.states.time[None, :], numbers, p).full().ravel()

    def weights(self, k: int, weight: float = 1.0) -> Weights:
        """What the formula weighs the state ``k`` and the parameters."""
        into, state = self.states.no_weights(), self.states.state(k)
        if self._graph.alone:
            self._measures[0].pull(state, weight, into)
            return into
        given = self.states.time[k], self._numbers(k), self.states.parameters
        slopes, own = (found.full().ravel() for found in self._graph.slopes(*given))
        into.p += weight * own
        for measure, slope in zip(self._measures, slopes, strict=True):
            measure.pull(state, weight * float(slope), into)
        return into

    def rate(self, k: int, change: State) -> float:
        """Change of the value with the state ``k``; ``change.p`` is that of the parameters."""
        return self.weights(k).along(change)

    def turn(self, k: int, change: State, weight: float = 1.0) -> Weights:
        """Change of ``weights`` with the state ``k``."""
        into, state = self.states.no_weights(), self.states.state(k)
        given = self.states.time[k], self._numbers(k), self.states.parameters
        slopes = self._graph.slopes(*given)[0].full().ravel()
        moved = []
        for measure in self._measures:
            alone = self.states.no_weights()
            measure.pull(state, 1.0, alone)
            moved.append(alone.along(change))
        rates = np.concatenate([moved, change.p])
        turned, own = (found.full().ravel() for found in self._graph.turns(*given, rates))
        into.p += weight * own
        for measure, slope, more in zip(self._measures, slopes, turned, strict=True):
            measure.pull(state, weight * float(more), into)
            measure.turn(state, change, weight * float(slope), into)
        return into

    def _numbers(self, k: int) -> list[float]:
        state = self.states.state(k)
        return [measure.value(state) for measure in self._measures]
