"""Responses and joints of live pages as plain data."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Protocol

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.results.live import PageResponse
from dalembert.results.sources import Row, Source
from dalembert.symbolic.formulas.expression import Expression
from dalembert.units.unit import shown_in


@dataclass(frozen=True, eq=False)
class FirstResponse:
    """Response that a page lists by default: a reduction of a formula over the states.

    Attributes
    ----------
    label, unit : of the response
    sx : formula of measures and parameters
    reduction : such as ``{"kind": "maximum"}``
    """

    label: str
    unit: str
    sx: ca.SX
    reduction: dict[str, Any]

    def page_data(self, row_of: Callable[[Source], int]) -> dict[str, Any]:
        """The response with the number of its row."""
        terms = [{"row": row_of(self.sx), "weight": 1.0} | self.reduction]
        return {"label": self.label, "unit": self.unit, "terms": terms, "constant": 0.0}


class Measured(Protocol):
    """A result with measures."""

    def expression(self, measure: str | Expression) -> Expression: ...

    def page_reduction(self, term: Any, times: np.ndarray) -> dict[str, Any]: ...


def computable(
    result: Measured, responses: Iterable[PageResponse], times: np.ndarray
) -> list[PageResponse]:
    """The responses that a page of a result with these outputs computes."""
    chosen = []
    for response in responses:
        with suppress(UnsupportedError):
            for _, term in response.terms:
                result.page_reduction(term, times)
            chosen.append(response)
    return chosen


def page_responses(
    motion: Measured,
    responses: Iterable[PageResponse],
    times: np.ndarray,
    row_of: Callable[[Source], int],
) -> list[dict[str, Any]]:
    """Responses with the rows of their measures.

    Parameters
    ----------
    times : outputs of the page
    row_of : formula → number of its row in the module

    Raises
    ------
    UnsupportedError
        A page does not compute this reduction.
    AnalysisError
        A measure is not a scalar of the model, or a response is none.
    """
    result = []
    for response in responses:
        if not hasattr(response, "reduction"):
            raise AnalysisError(
                f"{response!r:.60} is not a response; take one such as da.maximum('A.force_norm')"
            )
        terms = []
        for weight, term in response.terms:
            measure = motion.expression(term.measure)
            if len(measure) != 1:
                raise AnalysisError(
                    f"response {term.label}: the measure has {len(measure)} components; "
                    "take .x, .y or a norm"
                )
            row = row_of(ca.SX(measure.sx))
            terms.append({"row": row, "weight": weight} | motion.page_reduction(term, times))
        unit = response.unit_of(motion)
        texts = {"label": response.label, "unit": "" if unit == "1" else unit}
        result.append(texts | {"terms": terms, "constant": response.constant})
    return result


def in_units(response: dict[str, Any], units: Sequence[str]) -> dict[str, Any]:
    """A response with its unit replaced by the first of the units of the same dimension."""
    factor, unit = shown_in(response["unit"], units)
    terms = [term | {"weight": term["weight"] / factor} for term in response["terms"]]
    constant = response["constant"] / factor
    return response | {"unit": unit, "terms": terms, "constant": constant}


def state_rows(sx: ca.SX, row_of: Callable[[Source], int], drawn: bool) -> list[int]:
    """Numbers of the rows of the entries of a column of states; −1 for constant ones.

    Parameters
    ----------
    drawn : whether only pictures use them, such as shapes of modes
    """
    entries = ca.vertsplit(ca.densify(sx))
    return [-1 if entry.is_constant() else row_of(Row(entry, drawn=drawn)) for entry in entries]


def joint_rows(model: Model) -> list[dict[str, Any]]:
    """Name, natural size and unit of each constraint equation."""
    sizes = model.closure.all_equations.scales.rows
    return [
        {"name": constraint.name, "size": float(size), "unit": constraint.units()[k]}
        for (constraint, k), size in zip(model.closure.owners, sizes, strict=False)
    ]
