"""Common base of mechanisms and structures: parameters, and measures by name."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from importlib import import_module
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, ExpressionError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.inputs import Input, Output
from dalembert.symbolic.formulas.parameter import Parameter, parameter_vector
from dalembert.symbolic.formulas.parser import Names
from dalembert.symbolic.once import CacheOwner
from dalembert.units.amounts import check_unit

MANY = (
    "arrays for solve_dynamics, solve_kinematics, solve_inverse_dynamics, solve_equilibrium, "
    "solve_statics and frequency_response, or sweep(model, DesignTable.table({name: values}), "
    "analysis=…, responses=…)"
)
"""Functions for many designs."""


class ParametricModel(CacheOwner, ABC):
    """A frozen model with parameters.

    Attributes
    ----------
    name : of the model
    parameters : name → Parameter
    nominal : (np,) their values
    """

    kind: ClassVar[str]
    """``"mechanism"`` or ``"structure"``."""
    name: str
    parameters: dict[str, Parameter]
    nominal: np.ndarray

    declared_outputs: dict[str, Output]
    gradient_obstacle: str = ""
    """Reason why results have no derivatives; empty if they have."""

    @abstractmethod
    def _measure(self, name: str) -> Expression | None:
        """The measure or parameter of a name; None if unknown."""

    @abstractmethod
    def _all_names(self) -> list[str]:
        """Names of all measures and parameters."""

    def explore(self, analysis: Any = None, *, height: int = 720, **first_view: Any) -> Any:
        """The live page of an analysis as a widget of a notebook; see ``dalembert.explore``."""
        return import_module("dalembert").explore(self, analysis, height=height, **first_view)

    @property
    def inputs(self) -> dict[str, Input]:
        """Parameters by which other programs act on the model."""
        return {name: p for name, p in self.parameters.items() if isinstance(p, Input)}

    @cached_property
    def outputs(self) -> dict[str, Expression]:
        """Formulas of measures that other programs observe, by name.

        Raises
        ------
        ExpressionError
            Unknown names, or another unit; names the output.
        """
        return {name: self._output(output) for name, output in self.declared_outputs.items()}

    def _output(self, output: Output) -> Expression:
        """Formula of an output."""
        try:
            measures = Names(self._measure, self._all_names)
            formula = measures.expression(output.formula)
            if formula.unit and output.unit:
                check_unit(formula.unit, output.unit, output.name, str(output.formula))
        except ExpressionError as error:
            raise ExpressionError(error.message, f"output {output.name}") from None
        return formula.named(output.name, output.unit or formula.unit)

    @cached_property
    def names(self) -> Names:
        """Names of measures, outputs and parameters, as formulas use them."""
        return Names(self._find, lambda: [*self.declared_outputs, *self._all_names()])

    def _find(self, name: str) -> Expression | None:
        return self.outputs[name] if name in self.declared_outputs else self._measure(name)

    @abstractmethod
    def check_values(self, p: np.ndarray) -> None:
        """Check parameter values against the conditions of the elements.

        Raises
        ------
        ModelError
            Names the element, the quantity and its value.
        """

    @abstractmethod
    def value_limits(self) -> tuple[ca.SX, list[Any]]:
        """Symbols of the parameters, and limits of quantities that depend on them."""

    def values(self, parameters: Mapping[str, float] | np.ndarray | None = None) -> np.ndarray:
        """Parameter vector with some values replaced; a whole vector is passed through.

        Raises
        ------
        ModelError
            Unknown parameter, or a value that is not finite or that ``check_values`` refuses.
        AnalysisError
            Values of many designs.
        """
        _refuse_designs(parameters)
        if isinstance(parameters, np.ndarray):
            return self.completed(parameters)
        p = parameter_vector(self.parameters, parameters, self.name)
        if parameters:
            self.check_values(p)
        return self.completed(p)

    def completed(self, p: np.ndarray) -> np.ndarray:
        """The parameter vector, extended by the values computed from it outside of the graph."""
        return p

    def tangents(self, p: np.ndarray, columns: Sequence[int]) -> np.ndarray:
        """(n, columns) changes of this vector with some of the parameters."""
        return np.eye(p.size)[:, list(columns)]

    def parameter_gradients(self, p: np.ndarray, gradients: np.ndarray) -> np.ndarray:
        """(rows, np) gradients by the parameters from (rows, n) by the vector."""
        return gradients

    def __getitem__(self, name: str) -> Expression:
        """A measure or parameter by name: ``model["crank.end.x"]``, ``model["bar.stress"]``.

        Raises
        ------
        UnknownNameError
            A ``KeyError`` that lists the nearest names.
        """
        return self.names.named(name)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self.names.find(name) is not None

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def module(
        self,
        analysis: Any,
        measures: Sequence[str | Expression] = (),
        responses: Sequence[Any] = (),
        parameters: Mapping[str, float] | np.ndarray | None = None,
    ) -> Any:
        """An analysis of the model as a WebAssembly ``Module``, for other programs.

        Parameters
        ----------
        analysis : such as ``Dynamics(duration=2.0, step=0.01)``; its nominal run fixes the times
        measures : names or formulas of the outputs over time
        responses : reductions of measures to numbers, with gradients by all parameters
        parameters : values of the nominal run, by default those of the model

        Returns
        -------
        Module

        Raises
        ------
        UnsupportedError
            The analysis cannot run outside of Python; states the reason, such as rigid contacts.

        Examples
        --------
        >>> import dalembert as da
        >>> from dalembert import planar
        >>> system = da.System("throw", gravity=(0, -10))
        >>> speed = system.parameter("speed", 10.0, "m/s", bounds=(5, 20))
        >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, speed)))
        >>> module = system.build().module(da.Dynamics(duration=2.0, step=0.1), ["stone.y"])
        >>> [parameter["name"] for parameter in module.parameters], "step" in module.functions
        (['speed'], True)
        """
        return analysis.module(self, measures, responses, parameters)

    def keys(self) -> list[str]:
        """Names of all measures and parameters; vectors have components ``.x``, ``.y``, ``.z``."""
        return list(dict.fromkeys(self.names.known()))

    def expression(self, measure: str | Expression) -> Expression:
        """A measure by name, a formula of measures, parameters and ``t``, or an expression.

        Raises
        ------
        ExpressionError
            A formula outside the grammar; ``UnknownNameError`` for an unknown name.
        """
        return self.names.expression(measure)


def _refuse_designs(parameters: Any) -> None:
    """Raise unless parameter values are those of one design."""
    if isinstance(parameters, Mapping):
        several = [str(name) for name, value in parameters.items() if np.ndim(value)]
        if not several:
            return
        values = f"{', '.join(several)} with several values each"
    elif parameters is None or (isinstance(parameters, np.ndarray) and parameters.ndim == 1):
        return
    else:
        values = " ".join(f"{type(parameters).__name__} {parameters!r:.60}".split())
    raise AnalysisError(
        f"parameters: got {values}; give name → number for one design. Many designs at once: {MANY}"
    )
