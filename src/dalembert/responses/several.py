"""Several responses at once: as a list, and by the terms of their sums."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response


def as_responses(responses: Response | Sequence[Response]) -> list[Response]:
    """One response or several as a list with different labels.

    Raises
    ------
    AnalysisError
        Something else, none at all, or the same label twice.
    """
    several = isinstance(responses, Sequence) and not isinstance(responses, str)
    listed: list[Response] = list(responses) if several else [responses]  # type: ignore
    if not listed:
        raise AnalysisError("no response is given; give at least one, such as da.final(measure)")
    for given in listed:
        if not isinstance(given, Response):
            raise AnalysisError(f"{given!r} is not a response; give one such as da.final(measure)")
    labels = [r.label for r in listed]
    twice = next((label for label in labels if labels.count(label) > 1), None)
    if twice:
        raise AnalysisError(f"two responses are called {twice!r}; name them")
    return listed


def expanded(responses: Sequence[Response]) -> tuple[list[Response], np.ndarray]:
    """All terms, each once, and (responses, terms) their weights."""
    found = list(dict.fromkeys(term for response in responses for _, term in response.terms))
    weights = np.zeros((len(responses), len(found)))
    for row, response in zip(weights, responses, strict=True):
        for weight, term in response.terms:
            row[found.index(term)] += weight
    return found, weights
