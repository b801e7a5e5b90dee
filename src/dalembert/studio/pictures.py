"""Pictures of a text: the page of its analysis, or the reason why there is none."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from dalembert.analysis.explore import usual_analysis
from dalembert.analysis.timeline import OverTime
from dalembert.errors import AssemblyError, DalembertError
from dalembert.io.analyses import make_analysis
from dalembert.io.messages import key_path
from dalembert.io.model_file import ModelFile, check_model_data
from dalembert.io.reading import parse_document
from dalembert.io.report import live_responses, report_choices
from dalembert.model.assembled.model import StructuralModel
from dalembert.report.page import embedded, frame_of
from dalembert.results.files.assembly_report import assembly_payload, position_payload
from dalembert.results.result import Result
from dalembert.results.status import Outcome, Warnings
from dalembert.results.structural.free_motion import undeformed_payload
from dalembert.studio.drawn_numbers import Keys, with_drawn_parameters
from dalembert.studio.loose_nodes import parts_of, without_loose_nodes
from dalembert.studio.problems import Problem, loose_notes, notes_of, problems_of
from dalembert.studio.shown_motion import MotionLimit

DRAWN = 1_500_000
"""Upper limit of the size of a module that computes what is dragged [bytes]."""
BLANK: dict[str, Any] = {"format": 1, "time": [], "scene": {}}
SPACE: dict[str, Any] = {"kind": "spatial", "scene": {"dimension": 3}}
"""What a blank picture of a spatial mechanism has in addition."""


@dataclass(frozen=True)
class Picture:
    """Page of a text.

    Attributes
    ----------
    page : data of the page, as JSON; empty if there is none
    problems : errors and warnings
    summary : of the model in one line
    facts : numbers of the model, such as its degrees of freedom
    is_live : whether the page computes
    late : warnings of checks that take as long as the run, which only live pictures have
    frame : name of the page without data, of ``picture_frames``
    """

    page: str = ""
    problems: tuple[Problem, ...] = ()
    summary: str = ""
    facts: dict[str, Any] = field(default_factory=dict)
    is_live: bool = False
    late: tuple[Problem, ...] = ()
    frame: str = ""


def picture_of(text: str, path: Path, live: bool) -> Picture:
    """Picture of a text; one that cannot compute has no page if ``live``.

    Parameters
    ----------
    text : of the model file
    path : of the file, for relative paths and messages
    live : whether the page computes
    """
    try:
        return _picture_of(text, path, live)
    except AssemblyError as error:
        reasons = tuple(problems_of(error, text, path))
        if error.position is None:
            return Picture(problems=reasons)
        return _shown(assembly_payload(error), problems=reasons)
    except DalembertError as error:
        return Picture(problems=tuple(problems_of(error, text, path)))


def _picture_of(text: str, path: Path, live: bool) -> Picture:
    data = parse_document(path, text)
    data, loose = without_loose_nodes(data)
    if not any(data.get(section) for section in parts_of(data)):
        blank = BLANK | {"title": path.stem} | (SPACE if _is_spatial(data) else {})
        errors = _errors(data, text, path)
        return _shown(blank, problems=errors, summary="nothing is drawn yet")
    if not live:
        picture = _page_of(data, {}, text, path, live)
        return replace(picture, problems=(*picture.problems, *loose_notes(loose, text, path)))
    drawn, places = with_drawn_parameters(data)
    try:
        return _page_of(drawn, places, text, path, live)
    except DalembertError:
        if not places:
            raise
        return _page_of(data, {}, text, path, live)  # such as a number that cannot be a parameter


def _errors(data: dict[str, Any], text: str, path: Path) -> tuple[Problem, ...]:
    """Errors in the sections of a file without elements."""
    try:
        check_model_data(data, path)
    except DalembertError as error:
        return tuple(problems_of(error, text, path))
    return ()


def _is_spatial(data: dict[str, Any]) -> bool:
    """Whether a model without elements is spatial: by its gravity, or the places of its nodes."""
    gravity, nodes = data.get("gravity"), data.get("nodes")
    if isinstance(nodes, dict) and nodes:
        return all(isinstance(place, list) and len(place) == 3 for place in nodes.values())
    return data.get("dimension", len(gravity) if isinstance(gravity, list) else 2) == 3


def _page_of(
    data: dict[str, Any], places: dict[str, Keys], text: str, path: Path, live: bool
) -> Picture:
    """Picture of a model whose parameters at ``places`` are numbers of the drawing."""
    file = check_model_data(data, path)
    model = file.model()
    summary, facts = _diagnosis(model)
    notes = () if live or isinstance(model, StructuralModel) else notes_of(model, text, path)
    limit = MotionLimit(file.document.analysis is not None)
    try:
        result = result_of(file, model, limit)
    except DalembertError as error:
        if live:
            raise
        if isinstance(model, StructuralModel):
            still = undeformed_payload(model, error)
        else:
            still = position_payload(model)
        facts |= {"moving": list(getattr(error, "nodes", ()))}
        reasons = problems_of(_located(error), text, path)
        return _shown(still, problems=(*notes, *reasons), summary=summary, facts=facts)
    if live and result.status.outcome is Outcome.INTERRUPTED:
        return Picture()
    late = result.warnings.postpone() if isinstance(result.warnings, Warnings) else []
    wrong_choices: list[Problem] = []
    choices: dict[str, Any] = {}
    try:
        choices = report_choices(file, model)
    except DalembertError as error:  # such as a plot of an element that was deleted
        wrong_choices = problems_of(error, text, path)
    page = result.page(**choices)
    warnings = [Problem("warning", str(warning)) for warning in result.warnings]
    if not result.status.success:
        warnings.append(limit.problem(result))
    problems = (*notes, *warnings, *wrong_choices)
    if not live:
        return _shown(page, problems=problems, summary=summary, facts=facts)
    for row in page.get("parameters", ()):
        if row["name"] in places:
            row["drawn"] = places[row["name"]]
    responses = live_responses(file, model, page, result)
    stated = file.document.report.live
    size = DRAWN if places else None
    page = result.live_page(page, stated, responses, units=choices.get("units", ()), max_bytes=size)
    checks = tuple(Problem("warning", str(warning)) for warning in late)
    described: dict[str, Any] = {"problems": problems, "summary": summary, "facts": facts}
    if "code" not in page.get("live", {}):
        return Picture(late=checks, **described)
    return _shown(page, is_live=True, late=checks, **described)


def result_of(file: ModelFile, model: Any, limit: MotionLimit | None = None) -> Result:
    """Result of the analysis of a file, or of a motion where it states none.

    Parameters
    ----------
    file, model : to analyse
    limit : of the time to compute a motion
    """
    stated = file.document.analysis is not None or isinstance(model, StructuralModel)
    analysis: Any = make_analysis(file, model) if stated else usual_analysis(model)
    progress = limit if limit is not None and isinstance(analysis, OverTime) else False
    with file.located("analysis"):
        result: Result = analysis.run(model, progress=progress)
    return result


def _located(error: DalembertError) -> DalembertError:
    """An error at the first node that moves without strain, or as it is."""
    nodes = getattr(error, "nodes", ())
    if not nodes:
        return error
    owner = nodes[0].partition("[")[0]
    mesh = owner.removesuffix("_nodes")
    place = key_path("nodes", owner) if owner == mesh else key_path("meshes", mesh)
    return DalembertError(f"{place}: {error}")


def _diagnosis(model: Any) -> tuple[str, dict[str, Any]]:
    """Summary and numbers of a model."""
    if isinstance(model, StructuralModel):
        elements = ", ".join(f"{block.count} {block.kind.cls.__name__}" for block in model.blocks)
        return f"{len(model.degrees.nodes)} nodes; {elements}", {}
    diagnosis = model.diagnosis
    facts = {
        "degrees_of_freedom": diagnosis.degrees_of_freedom,
        "free": diagnosis.free,
        "redundant": len(diagnosis.redundancies),
        "redundancies": [str(item) for item in diagnosis.redundancies],
    }
    return diagnosis.summary, facts


def _shown(payload: dict[str, Any], **described: Any) -> Picture:
    """Picture with the page of a payload."""
    return Picture(embedded(payload), frame=frame_of(payload).name, **described)
