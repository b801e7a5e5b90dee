"""Pages of harmonic responses: charts over the frequency, and what a live page computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.results.harmonic_measures import part_name
from dalembert.results.result import Result

if TYPE_CHECKING:
    from dalembert.results.files.live_responses import FirstResponse
    from dalembert.results.live import PageResponse
    from dalembert.symbolic.formulas.expression import Expression

PAGE_REDUCTIONS = ("maximum", "minimum", "peak", "at", "final")
"""Reductions that do not depend on the choice of the frequencies."""
MOST_RESPONSES = 6
"""Upper limit of the responses that a live page lists by default."""


class FrequencyPage(Result):
    """Result over the frequency with a page.

    Attributes
    ----------
    frequencies : (K,) [Hz]
    inputs : names of the inputs
    outputs : name → measure
    """

    of_any_size: ClassVar[bool] = True
    """Whether shapes have no scale."""

    frequencies: np.ndarray
    inputs: list[str]
    outputs: Mapping[str, Expression]

    def page_times(self, page: dict[str, Any], responses: Sequence[PageResponse]) -> np.ndarray:
        requested = [term.time for r in responses for _, term in r.terms if hasattr(term, "time")]
        return np.union1d(self.frequencies, np.array(requested, dtype=float))

    def page_reduction(self, term: Any, times: np.ndarray) -> dict[str, Any]:
        reduction: dict[str, Any] = term.reduction(times)
        if reduction["kind"] not in PAGE_REDUCTIONS:
            raise UnsupportedError(
                f"response {term.label}: its value depends on the chosen frequencies, which follow "
                "the resonances in a page; a page computes extremes, peaks and values at "
                "frequencies"
            )
        return reduction

    def page_extras(
        self, row_of: Callable[[ca.SX], int], responses: Sequence[dict[str, Any]]
    ) -> dict[str, Any]:
        """Amplitudes and phases that responses may have, and rows whose maxima are located."""
        measured, amplitudes = [], []
        for name, source, part in product(self.outputs, self.sources, ("amplitude", "phase")):
            expression = self.expression(part_name(name, part, source))
            row, unit = row_of(ca.SX(expression.sx)), expression.unit
            entry = {"name": part_name(name, part, source), "unit": "" if unit == "1" else unit}
            measured.append(entry | {"group": part, "row": row})
            amplitudes += [row] if part == "amplitude" else []
        signs = {"maximum": 1, "peak": 1, "minimum": -1}
        terms = [term for response in responses for term in response["terms"]]
        own = [(term["row"], signs[term["kind"]]) for term in terms if term["kind"] in signs]
        extremes = dict.fromkeys([*((row, 1) for row in amplitudes), *own])
        return {"measured": measured, "amplitudes": amplitudes, "extremes": list(extremes)}

    def first_responses(self) -> Sequence[FirstResponse]:
        """Highest peaks of the outputs."""
        from dalembert.results.files.live_responses import FirstResponse

        names = [part_name(o, "amplitude", s) for o in self.outputs for s in self.sources]
        chosen = [(name, self.expression(name)) for name in names[:MOST_RESPONSES]]
        return [
            FirstResponse(
                f"maximum({name})",
                "" if e.unit == "1" else e.unit,
                ca.SX(e.sx),
                {"kind": "maximum"},
            )
            for name, e in chosen
        ]

    @property
    def sources(self) -> list[str]:
        """Names of the inputs in names of measures, where there are several."""
        return [""] if len(self.inputs) == 1 else self.inputs

    def page(self, units: Sequence[str] = (), **first_view: Any) -> dict[str, Any]:
        """Payload of the report."""
        from dalembert.results.files.frequency_payload import frequency_payload

        return frequency_payload(self, units)
