"""Initial view of the report of a file."""

from __future__ import annotations

from typing import Any

from dalembert.errors import DalembertError
from dalembert.io.decisions.responses import make_responses
from dalembert.io.decisions.task_tables import ReportTable
from dalembert.io.model_file import ModelFile
from dalembert.results.files.live_responses import PageResponse, computable
from dalembert.results.files.tables import checked_units
from dalembert.results.labelled import DATA_ONLY
from dalembert.results.result import Result
from dalembert.text.wording import unknown


def live_responses(
    file: ModelFile, model: Any, page: dict[str, Any], result: Result
) -> list[PageResponse]:
    """Responses of the file that its page computes; none if one is invalid, as its tasks report.

    Responses with measures of results of other analyses are left out.
    """
    try:
        responses = make_responses(file, model).values()
    except DalembertError:
        return []
    own = [r for r in responses if all(term.measure in result for _, term in r.terms)]
    times = result.page_times(page, own)
    return computable(result, own, times) if times.size else []


def report_choices(file: ModelFile, model: Any) -> dict[str, Any]:
    """Initial view of the report: ``plots``, ``trace`` and ``units``, with checked names."""
    report = file.document.report
    with file.located("report", "units"):
        units = checked_units(report.units)
    if not isinstance(report, ReportTable):
        return {"units": units}
    for i, group in enumerate(report.plots):
        for k, measure in enumerate(group):
            with file.located("report", "plots", i, k):
                if measure not in DATA_ONLY:
                    model.expression(measure)
    points = [p.name for body in model.bodies for p in body.points.values()]
    points += [body.name for body in model.bodies]
    for k, point in enumerate(report.trace):
        if point not in points:
            raise file.located.error(unknown("point", point, points), "report", "trace", k)
    return {"plots": report.plots or None, "trace": report.trace or None, "units": units}


def exported_measures(file: ModelFile, model: Any, result: Any) -> list[str]:
    """Measures of modes, or of the report of the file, else the coordinates of all bodies."""
    from dalembert.results.modes import Numbered
    from dalembert.results.pictures.scene import is_spatial

    if isinstance(result, Numbered):
        return list(result.exported)
    choices = report_choices(file, model)
    names = [name for group in choices.get("plots") or () for name in group]
    points = list(choices.get("trace") or ())
    if not names and not points and model.kind == "mechanism":
        points = [body.name for body in model.bodies]
    axes = "xyz" if points and is_spatial(model) else "xy"
    names += [f"{point}.{axis}" for point in points for axis in axes]
    return [name for name in dict.fromkeys(names) if not name.endswith("_violation")]
