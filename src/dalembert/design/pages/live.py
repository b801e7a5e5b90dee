"""Live pages of design tasks: the page runs the designs of its table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.design.quantity import AnalysisCase, Quantity
from dalembert.errors import DalembertError, UnsupportedError
from dalembert.responses.base import Response
from dalembert.results.files.live_responses import computable
from dalembert.results.live import PageDesigns
from dalembert.results.result import Result

MAX_DESIGNS = 1500
"""Upper limit of the designs drawn on a page."""


@dataclass(frozen=True, eq=False)
class LiveTask:
    """Result, designs and responses of a task for its live page.

    Attributes
    ----------
    result : result of the selected design
    page : function of the options of pages → page of the result with the views of the task
    designs : designs of the table
    responses : responses of the task, in the case of the result
    """

    result: Result
    page: Callable[..., dict[str, Any]]
    designs: PageDesigns
    responses: Sequence[Response]


def live_page(decision: Any, live: bool | None, first_view: dict[str, Any]) -> dict[str, Any]:
    """Page of a task whose designs run in the page, or its page with the reason why not.

    Parameters
    ----------
    live : whether the page is live; by default as for motions
    first_view : options of the page
    """
    if live is False:
        return dict(decision.page(**first_view))
    try:
        task = decision.live_task()
        if task is None:
            raise UnsupportedError(f"designs of {type(decision).__name__} do not run in a page")
    except DalembertError as error:
        return decision.page(**first_view) | ({"live": {"reason": str(error)}} if live else {})
    runs = not task.result.analysis.live_obstacle(task.result)
    page = task.page(**first_view) if runs else {}
    times = task.result.page_times(page, task.responses)
    responses = computable(task.result, task.responses, times) if times.size else []
    page = task.result.live_page(page, live, responses, task.designs, first_view.get("units", ()))
    if "code" in page.get("live", {}):
        return dict(page)
    return decision.page(**first_view) | {key: page[key] for key in ("live",) if key in page}


def drawn(count: int) -> np.ndarray:
    """Numbers of the designs of a page, evenly spaced: at most ``MAX_DESIGNS``."""
    return np.unique(np.linspace(0, count - 1, min(count, MAX_DESIGNS)).round().astype(int))


def responses_of(quantities: Sequence[Quantity], case: AnalysisCase) -> list[Response]:
    """Responses of a case on which quantities depend.

    Raises
    ------
    UnsupportedError
        Quantities of other cases set parameters of this one.
    """
    if case.inputs:
        listed = ", ".join(case.inputs)
        raise UnsupportedError(f"results of other analyses set {listed} of {case.model.name}")
    terms = (term for quantity in quantities for term in quantity.terms if term.case is case)
    return list(dict.fromkeys(term.response for term in terms))
