"""Formulas of measures over the states of a structure, and their derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.model.assembled.measures import Measure, State, Weights
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.symbolic.once import once


class MeasuredStates(Result):
    """States (load cases or instants) and formulas of their measures.

    Attributes
    ----------
    model : StructuralModel
    parameters : (np,) values used
    time : (K,) instants, or numbers of the states
    """

    model: StructuralModel
    parameters: np.ndarray

    def state(self, k: int) -> State:
        """The state that measures evaluate."""
        raise NotImplementedError

    def measure(self, name: str) -> Measure:
        """The measure behind a symbol of a formula."""
        return self.model.measure(name)

    def no_weights(self) -> Weights:
        """Zero weights, to which those of measures are added."""
        return Weights.zero(len(self.model.degrees), self.parameters.size)

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, or a formula of measures."""
        return self.model.expression(measure)

    def __contains__(self, measure: object) -> bool:
        if not super().__contains__(measure):
            return False
        try:  # statics know the names of motion measures, without values
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
        """Derivatives of a formula with respect to the state ``k`` and the parameters."""
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
    alone : whether the formula is a single measure
    """

    def __init__(self, model: StructuralModel, sx: ca.SX):
        symbols = model.measure_symbols(sx)
        self.names, self.alone = [s.name() for s in symbols], bool(symbols) and sx.is_symbolic()
        self._sx, self._inputs = sx, [t.sx, stack(symbols), model.p]

    @cached_property
    def value(self) -> ca.Function:
        """Function of the formula."""
        return ca.Function("formula", self._inputs, [ca.densify(self._sx)])

    @cached_property
    def slopes(self) -> ca.Function:
        """Derivatives with respect to measures and parameters."""
        slopes = [ca.densify(ca.gradient(self._sx, by)) for by in self._inputs[1:]]
        return ca.Function("slopes", self._inputs, slopes)

    @cached_property
    def turns(self) -> ca.Function:
        """Directional derivative of the slopes."""
        inputs = self._inputs
        variables = ca.vertcat(*inputs[1:])
        change = ca.SX.sym("change", variables.numel())
        derivatives = [
            ca.densify(ca.jtimes(slope, variables, change)) for slope in self.slopes(*inputs)
        ]
        return ca.Function("turns", [*inputs, change], derivatives)


@once
def formula_graph(model: StructuralModel, sx: ca.SX) -> FormulaGraph:
    """Functions of a formula, created on first use."""
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
        """(K,) values at all states."""
        count, graph = len(self.states.time), self._graph
        numbers = np.array([self._numbers(k) for k in range(count)]).reshape(count, -1).T
        if graph.alone or not count:
            return numbers.ravel()
        p = np.tile(self.states.parameters[:, None], count)
        return graph.value.map(count)(self.states.time[None, :], numbers, p).full().ravel()

    def weights(self, k: int, weight: float = 1.0) -> Weights:
        """Derivatives with respect to the state ``k`` and the parameters, times ``weight``."""
        into, state = self.states.no_weights(), self.states.state(k)
        if self._graph.alone:
            self._measures[0].pull(state, weight, into)
            return into
        arguments = self.states.time[k], self._numbers(k), self.states.parameters
        slopes, parameter_weights = (part.full().ravel() for part in self._graph.slopes(*arguments))
        into.p += weight * parameter_weights
        for measure, slope in zip(self._measures, slopes, strict=True):
            measure.pull(state, weight * float(slope), into)
        return into

    def rate(self, k: int, change: State) -> float:
        """Directional derivative at the state ``k``; ``change.p`` is that of the parameters."""
        return self.weights(k).along(change)

    def turn(self, k: int, change: State, weight: float = 1.0) -> Weights:
        """Directional derivative of ``weights`` at the state ``k``."""
        into, state = self.states.no_weights(), self.states.state(k)
        arguments = self.states.time[k], self._numbers(k), self.states.parameters
        slopes = self._graph.slopes(*arguments)[0].full().ravel()
        measure_rates = []
        for measure in self._measures:
            weights = self.states.no_weights()
            measure.pull(state, 1.0, weights)
            measure_rates.append(weights.along(change))
        rates = np.concatenate([measure_rates, change.p])
        slope_rates, parameter_weights = (
            part.full().ravel() for part in self._graph.turns(*arguments, rates)
        )
        into.p += weight * parameter_weights
        for measure, slope, slope_rate in zip(self._measures, slopes, slope_rates, strict=True):
            measure.pull(state, weight * float(slope_rate), into)
            measure.turn(state, change, weight * float(slope), into)
        return into

    def _numbers(self, k: int) -> list[float]:
        state = self.states.state(k)
        return [measure.value(state) for measure in self._measures]
