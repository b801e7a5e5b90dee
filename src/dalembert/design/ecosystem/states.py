"""State equations ``r(x, p) = 0`` and measures ``m(x, p)`` for coupled solvers of other packages.

Coupling with other equations requires residuals at arbitrary states, and products and solutions
with their derivatives in both directions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, ModelError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown


@dataclass(frozen=True)
class StateVariable:
    """Part of the state.

    Attributes
    ----------
    name : of the part
    shape : of its array
    members : names along the first axis
    """

    name: str
    shape: tuple[int, ...]
    members: Sequence[str]

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(np.prod(self.shape))


@dataclass(frozen=True)
class Change:
    """Changes (or weights) of state and parameters, or of residuals and measures."""

    state: np.ndarray
    other: np.ndarray


class StateTangent(ABC):
    """Derivatives of residuals and measures at a state."""

    @abstractmethod
    def push(self, dx: np.ndarray, dp: np.ndarray) -> Change:
        """Changes of residuals (n,) and measures from those of state (n,) and parameters (np,)."""

    @abstractmethod
    def pull(self, r_bar: np.ndarray, m_bar: np.ndarray) -> Change:
        """Weights of state and parameters from those of residuals and measures."""

    @abstractmethod
    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        """``(∂r/∂x)⁻¹`` times a vector (n,), transposed if ``trans`` is ``"T"``."""


class StateEquations(ABC):
    """State, its equations and measures.

    Attributes
    ----------
    model : model with parameters
    variables : parts of the state
    measured : label → measure
    samples : number of values of each measure
    sizes : (n,) scales of the residuals
    scales : (n,) scales of the state
    """

    model: ParametricModel
    variables: Sequence[StateVariable]
    measured: Mapping[str, Expression]
    samples: int
    sizes: np.ndarray
    scales: np.ndarray

    @abstractmethod
    def solve(self, p: np.ndarray, initial: np.ndarray | None = None) -> np.ndarray:
        """(n,) solution for parameter values, from an initial state.

        Raises
        ------
        AnalysisError
            The solution failed.
        """

    @abstractmethod
    def residual(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(n,) residuals of the equations."""

    @abstractmethod
    def measures(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(m,) values of all measures, concatenated."""

    @abstractmethod
    def tangent(self, x: np.ndarray, p: np.ndarray) -> StateTangent:
        """Derivatives at a state.

        Raises
        ------
        AnalysisError
            The equations are singular there.
        """


Measures = Mapping[str, str | Expression] | Sequence[str | Expression]


def labelled_measures(model: ParametricModel, measures: Measures) -> dict[str, Expression]:
    """Label → measure.

    Raises
    ------
    AnalysisError
        Two measures have the same label.
    """
    if isinstance(measures, Mapping):
        return {label: model.expression(measure) for label, measure in measures.items()}
    if isinstance(measures, (str, Expression)):
        measures = [measures]
    expressions: dict[str, Expression] = {}
    for measure in measures:
        expression = model.expression(measure)
        label = measure if isinstance(measure, str) else expression.name or "measure"
        if label in expressions:
            raise AnalysisError(f"two measures are called {label!r}; give measures={{name: …}}")
        expressions[label] = expression
    return expressions


def input_names(model: ParametricModel, vary: Sequence[str] | None) -> list[str]:
    """Names of the input parameters; by default all.

    Raises
    ------
    ModelError
        A name is unknown.
    """
    for name in vary or ():
        if name not in model.parameters:
            raise ModelError(unknown("parameter", name, model.parameters))
    return list(model.parameters if vary is None else vary)
