"""Sums and differences of responses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result


@options
class Combination(Response):
    """Linear combination ``c + Σ w_k R_k`` of responses of one result.

    Sums, differences, and products with numbers of responses give one. Its gradient is that of its
    terms, by each method. The measure is its formula, for people.

    Parameters
    ----------
    weighted : (weight, response) of each term, none of them a combination
    constant : ``c``

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 10.0)
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, speed)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> net = da.final("stone.x") - 2 * da.maximum("stone.y") + 1
    >>> net.label, round(da.evaluate(motion, net), 6)  # 6 - 2·5 + 1
    ('final(stone.x) - 2*maximum(stone.y) + 1', -3.0)
    >>> round(da.sensitivity(motion, net).item(), 6)  # -2 v/g
    -2.0
    """

    weighted: tuple[tuple[float, Response], ...] = ()
    constant: float = 0.0

    @property
    def label(self) -> str:
        return self.name or str(self.measure)

    @property
    def terms(self) -> tuple[tuple[float, Response], ...]:
        return self.weighted

    @property
    def known_unit(self) -> str:
        return self._common([response.known_unit for _, response in self.weighted])

    def unit_of(self, source: Any) -> str:
        return self._common([response.unit_of(source) for _, response in self.weighted])

    def searches(self, motion: Result) -> bool:
        return any(response.searches(motion) for _, response in self.weighted)

    def _common(self, units: Sequence[str]) -> str:
        """The unit of the sum, where all terms have the same; terms with a factor may have any.

        Raises
        ------
        AnalysisError
            Terms without a factor that have different units.
        """
        plain = [u for u, (w, _) in zip(units, self.weighted, strict=True) if abs(w) == 1 and u]
        different = list(dict.fromkeys(plain))
        if len(different) > 1:
            first, second = different[:2]
            raise AnalysisError(
                f"response {self.label}: terms in {first} and in {second} cannot be added; "
                "multiply one of them by a factor that leads from one unit to the other"
            )
        if different:
            return different[0]
        return units[0] if len(set(units)) == 1 else ""


def combined_terms(parts: Sequence[tuple[float, Any]]) -> Response:
    """``Σ w_k part_k`` of responses and numbers, equal responses taken together."""
    weights: dict[Response, float] = {}
    constant = 0.0
    for weight, part in parts:
        if not isinstance(part, Response):
            constant += weight * float(part)
            continue
        constant += weight * part.constant
        for own, response in part.terms:
            weights[response] = weights.get(response, 0.0) + weight * own
    kept = tuple((weight, response) for response, weight in weights.items())
    return Combination(_formula(kept, constant), "", kept, constant)


def _formula(weighted: Sequence[tuple[float, Response]], constant: float) -> str:
    text = ""
    for weight, response in weighted:
        size = "" if abs(weight) == 1 else f"{abs(weight):g}*"
        text += f" {'-' if weight < 0 else '+'} {size}{response.label}"
    if constant or not text:
        text += f" {'-' if constant < 0 else '+'} {abs(constant):g}"
    return text[3:] if text.startswith(" + ") else "-" + text[3:]


def expanded(responses: Sequence[Response]) -> tuple[list[Response], np.ndarray]:
    """All terms, each once, and (responses, terms) their weights."""
    found = list(dict.fromkeys(term for response in responses for _, term in response.terms))
    weights = np.zeros((len(responses), len(found)))
    for row, response in zip(weights, responses, strict=True):
        for weight, term in response.terms:
            row[found.index(term)] += weight
    return found, weights
