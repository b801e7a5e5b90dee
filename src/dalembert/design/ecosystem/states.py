"""Equations ``r(x, p) = 0`` of a state as other packages solve them, and measures ``m(x, p)``.

Whoever couples a mechanism or a structure with other equations needs more than responses: the
residual at states that do not satisfy it, and its derivatives there, to be solved with and to be
multiplied by from both sides.
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
    """A part of the state.

    Attributes
    ----------
    name : of the part
    shape : in which its numbers stand
    members : what they are, along the first axis
    """

    name: str
    shape: tuple[int, ...]
    members: Sequence[str]

    @property
    def size(self) -> int:
        """How many numbers."""
        return int(np.prod(self.shape))


@dataclass(frozen=True)
class Change:
    """Changes, or weights, of a state with its parameters, or of residuals with measures."""

    state: np.ndarray
    other: np.ndarray


class StateTangent(ABC):
    """The derivative of residuals and measures at a state."""

    @abstractmethod
    def push(self, dx: np.ndarray, dp: np.ndarray) -> Change:
        """Changes of residuals (n,) and measures from those of state (n,) and parameters (np,)."""

    @abstractmethod
    def pull(self, r_bar: np.ndarray, m_bar: np.ndarray) -> Change:
        """Weights of state and parameters from those of residuals and measures."""

    @abstractmethod
    def solve(self, rhs: np.ndarray, trans: str = "N") -> np.ndarray:
        """``(∂r/∂x)⁻¹`` times a vector (n,); the transpose of it where ``trans`` is ``"T"``."""


class StateEquations(ABC):
    """A state, its equations, and what is measured of it.

    Attributes
    ----------
    model : with parameters
    variables : parts of the state
    measured : label → measure, and how many numbers each has
    sizes : (n,) natural sizes of the residuals
    reach : (n,) natural sizes of the state
    """

    model: ParametricModel
    variables: Sequence[StateVariable]
    measured: Mapping[str, Expression]
    samples: int
    sizes: np.ndarray
    reach: np.ndarray

    @abstractmethod
    def solve(self, p: np.ndarray, near: np.ndarray | None = None) -> np.ndarray:
        """(n,) the state for parameter values, from one that is near.

        Raises
        ------
        AnalysisError
            It was not found.
        """

    @abstractmethod
    def residual(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(n,) what is left of the equations."""

    @abstractmethod
    def measures(self, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(m,) measures one after the other, each with all of its numbers."""

    @abstractmethod
    def tangent(self, x: np.ndarray, p: np.ndarray) -> StateTangent:
        """The derivatives at a state.

        Raises
        ------
        AnalysisError
            The equations are singular there.
        """


Measures = Mapping[str, str | Expression] | Sequence[str | Expression]


def labelled(model: ParametricModel, measures: Measures) -> dict[str, Expression]:
    """Label → measure.

    Raises
    ------
    AnalysisError
        Two have one label.
    """
    if isinstance(measures, Mapping):
        return {label: model.expression(one) for label, one in measures.items()}
    if isinstance(measures, (str, Expression)):
        measures = [measures]
    found: dict[str, Expression] = {}
    for one in measures:
        made = model.expression(one)
        label = one if isinstance(one, str) else made.name or "measure"
        if label in found:
            raise AnalysisError(f"two measures are called {label!r}; give measures={{name: …}}")
        found[label] = made
    return found


def inputs_of(model: ParametricModel, vary: Sequence[str] | None) -> list[str]:
    """The parameters that others give: those named, or all.

    Raises
    ------
    ModelError
        A name is unknown.
    """
    for name in vary or ():
        if name not in model.parameters:
            raise ModelError(unknown("parameter", name, model.parameters))
    return list(model.parameters if vary is None else vary)
