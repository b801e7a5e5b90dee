"""Objectives and constraints: responses of one or several analyses, and formulas of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.analysis import Analysis
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import CheckedArguments, check_arguments


class AnalysisCase(Protocol):
    """A model, an analysis of it, and quantities of other cases that set its parameters."""

    @property
    def model(self) -> ParametricModel: ...

    @property
    def analysis(self) -> Analysis: ...

    @property
    def inputs(self) -> Mapping[str, Quantity]: ...

    @property
    def needs(self) -> Sequence[AnalysisCase]: ...

    def __getitem__(self, response: Response, /) -> CaseResponse: ...


class Quantity(ABC):
    """A number ``q(r_1 … r_n)`` of responses of cases."""

    label: str

    @property
    @abstractmethod
    def terms(self) -> list[CaseResponse]:
        """Responses that it depends on."""

    @abstractmethod
    def value(self, values: np.ndarray) -> float:
        """Value at the values of its terms."""

    @abstractmethod
    def slope(self, values: np.ndarray) -> np.ndarray:
        """(n,) derivatives by the values of its terms."""

    def unit(self, units: Sequence[str]) -> str:
        """Unit, from the units of its terms."""
        return ""

    def of(self, case: AnalysisCase | None) -> Quantity:
        """Copy whose responses without a case belong to ``case``."""
        return self

    def varying(self, names: Sequence[str]) -> Quantity:
        """Copy for a design that varies these parameters: random ones scatter about the design."""
        return self


Objective = Response | Quantity
"""Response of a model, response of a case, or a combination of these."""


@dataclass(frozen=True, eq=False)
class CaseResponse(Quantity):
    """Response of one case."""

    case: AnalysisCase
    response: Response

    @property
    def label(self) -> str:  # type: ignore[override]
        """Label of the response."""
        return self.response.label

    @property
    def terms(self) -> list[CaseResponse]:
        return [self]

    def value(self, values: np.ndarray) -> float:
        return float(values[0])

    def slope(self, values: np.ndarray) -> np.ndarray:
        return np.ones(1)

    def unit(self, units: Sequence[str]) -> str:
        return units[0]


@dataclass(frozen=True, eq=False)
class Constant(Quantity):
    """Constant number."""

    number: float

    @property
    def label(self) -> str:  # type: ignore[override]
        return f"{self.number:g}"

    @property
    def terms(self) -> list[CaseResponse]:
        return []

    def value(self, values: np.ndarray) -> float:
        return self.number

    def slope(self, values: np.ndarray) -> np.ndarray:
        return np.zeros(0)


@dataclass(frozen=True, eq=False)
class Combined(Quantity):
    """Formula of responses, also of different analyses: ``"mass + 0.1*peak"``.

    Parameters
    ----------
    formula : of the names of ``parts``
    name : label; the formula if empty
    parts : name → response, response of a case, or another combination
    """

    formula: str
    parts: Mapping[str, Any]
    name: str = ""
    declared_unit: str = ""

    @property
    def label(self) -> str:  # type: ignore[override]
        """Name, or the formula if there is none."""
        return self.name or self.formula

    @cached_property
    def terms(self) -> list[CaseResponse]:  # type: ignore[override]
        return [term for part in self.parts.values() for term in part.terms]

    @cached_property
    def function(self) -> ca.Function:
        """Value and derivatives of the formula by its names."""
        symbols = {name: Expression(ca.SX.sym(name), name) for name in self.parts}
        formula = parse_formula(self.formula, symbols.get, lambda: list(symbols))
        inputs = ca.vertcat(*(s.sx for s in symbols.values()))
        return ca.Function("formula", [inputs], [formula.sx, ca.gradient(formula.sx, inputs)])

    def _split(self, values: np.ndarray) -> list[np.ndarray]:
        return split_terms(list(self.parts.values()), values)

    def _inner(self, values: np.ndarray) -> np.ndarray:
        parts = zip(self.parts.values(), self._split(values), strict=True)
        return np.array([part.value(v) for part, v in parts])

    def value(self, values: np.ndarray) -> float:
        return float(self.function(self._inner(values))[0])

    def slope(self, values: np.ndarray) -> np.ndarray:
        outer = np.array(self.function(self._inner(values))[1]).ravel()
        split = zip(outer, self.parts.values(), self._split(values), strict=True)
        return np.concatenate([o * part.slope(v) for o, part, v in split])

    def unit(self, units: Sequence[str]) -> str:
        return self.declared_unit

    def of(self, case: AnalysisCase | None) -> Quantity:
        parts = {name: with_case(part, case) for name, part in self.parts.items()}
        combination = Combined(self.formula, parts, self.name, self.declared_unit)
        combination.function  # noqa: B018 - refuses unknown names
        return combination

    def varying(self, names: Sequence[str]) -> Quantity:
        parts = {name: part.varying(names) for name, part in self.parts.items()}
        return Combined(self.formula, parts, self.name, self.declared_unit)


@check_arguments
def combined(formula: str, name: str = "", unit: str = "", **parts: Objective) -> Combined:
    """Combine responses by a formula into one objective or constraint.

    Parameters
    ----------
    formula : of the names of ``parts``
    name, unit : label and unit in results
    **parts : responses, responses of cases (``case[response]``), other combinations

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0, bounds=(1, 1e3))
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> spring.load(end, fx=100.0)
    >>> cost = da.combined("size/10 + give", size=da.final("k"), give=da.final("end.ux"))
    >>> best = da.optimize(spring.build(), cost, analysis=da.Statics())
    >>> round(best.x["k"], 3), round(best.fun, 6)  # of k/10 + 100/k
    (31.623, 6.324555)
    """
    return Combined(formula, parts, name, unit)


@dataclass(frozen=True, eq=False)
class SumOfSquares(CheckedArguments, Quantity):
    """``Σ ((r_i − target_i) / scale_i)²``; ``method="least-squares"`` uses its residuals.

    Parameters
    ----------
    responses : responses or responses of cases
    targets : numbers, zero by default
    scales : of the residuals, one by default
    name : label

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0, bounds=(1, 1e3))
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> for name, load in (("a", 10.0), ("b", 30.0)):
    ...     spring.load(end, case=name, fx=load)
    >>> measured = [da.at(0, "end.ux"), da.at(1, "end.ux")]
    >>> aim = da.SumOfSquares(measured, targets=[0.11, 0.29])
    >>> best = da.optimize(spring.build(), aim, analysis=da.Statics())
    >>> round(best.x["k"], 3)  # Σ F²/Σ F u
    102.041
    """

    responses: Sequence[Any]
    targets: Sequence[float] | float = 0.0
    scales: Sequence[float] | float = 1.0
    name: str = "sum of squares"

    def __post_init__(self) -> None:
        size = len(self.responses)
        for argument in ("targets", "scales"):
            value = np.asarray(getattr(self, argument), dtype=float)
            if value.ndim and value.size != size:
                raise AnalysisError(
                    f"{self.name}: {value.size} {argument} for {size} responses; give one for each"
                )
        if not np.all(np.asarray(self.scales, dtype=float) > 0):
            raise AnalysisError(f"{self.name}: scales must be above zero, got {self.scales}")

    @property
    def label(self) -> str:  # type: ignore[override]
        """The name."""
        return self.name

    @property
    def terms(self) -> list[CaseResponse]:
        return [term for part in self.responses for term in part.terms]

    def residuals(self, values: np.ndarray) -> np.ndarray:
        """(n,) scaled differences from the targets."""
        return (values - np.asarray(self.targets)) / np.asarray(self.scales)

    def value(self, values: np.ndarray) -> float:
        return float(np.sum(self.residuals(values) ** 2))

    def slope(self, values: np.ndarray) -> np.ndarray:
        return 2 * self.residuals(values) / np.asarray(self.scales)

    def of(self, case: AnalysisCase | None) -> Quantity:
        parts = [with_case(part, case) for part in self.responses]
        if any(not isinstance(part, CaseResponse) for part in parts):
            raise AnalysisError(f"{self.name}: give responses, not formulas of responses")
        return SumOfSquares(parts, self.targets, self.scales, self.name)


def split_terms(parts: Sequence[Quantity], values: np.ndarray) -> list[np.ndarray]:
    """Values of the terms of each part, from the values of all terms."""
    return np.split(values, np.cumsum([len(part.terms) for part in parts])[:-1])


def with_case(response: Objective, case: AnalysisCase | None) -> Quantity:
    """Quantity of a response or quantity whose terms without a case belong to ``case``.

    Raises
    ------
    AnalysisError
        It is neither, or a response that belongs to no case.
    """
    if isinstance(response, Quantity):
        return response.of(case)
    if not isinstance(response, Response):
        raise AnalysisError(f"{response!r} is not a response; give one such as da.final(measure)")
    if case is None:
        raise AnalysisError(
            f"response {response.label} has no case; give model and analysis=, or case[response]"
        )
    return case[response]
