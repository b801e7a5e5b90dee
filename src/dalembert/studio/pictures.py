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
from dalembert.report.page import render_page
from dalembert.results.files.assembly_report import assembly_payload, position_payload
from dalembert.results.result import Result
from dalembert.results.status import Outcome, Warnings
from dalembert.results.structural.free_motion import undeformed_payload
from dalembert.studio.drawn_numbers import Keys, with_drawn_parameters
from dalembert.studio.loose_nodes import parts_of, without_loose_nodes
from dalembert.studio.problems import Problem, loose_notes, notes_of, problems_of
from dalembert.studio.shown_motion import MotionLimit

EMBEDDED = """header.top, #footer, #panels { display: none }
body { padding: 8px } main, .single main { padding: 0 }
.stage, .single .stage { height: auto; min-height: 0 }
.view, .single .view { flex: none; height: max(280px, 100vh - 200px) }
@media (min-width: 941px) { .board { min-height: 0 } }
.toolbar { order: 1; border-bottom: 0; border-top: 1px solid var(--line) }
.toolbar .menu-box { top: auto; bottom: calc(100% + 6px) }
#ghosts { order: 99 }
@media (max-width: 560px), (max-height: 430px) {
  .view, .single .view { height: max(170px, calc(100dvh - 150px)) }
  .toolbar { flex-wrap: nowrap; overflow-x: auto; padding: 5px 8px }
  .toolbar > *, .toolbar .chips { flex: none; flex-wrap: nowrap; max-height: none }
  .player { padding: 4px 8px } .player select { max-width: 72px }
}"""
"""Style of a page in the studio, which has its own heading. Legend and buttons are below the
drawing, whose place and height depend on the window only: no row of them moves what is clicked. On
a phone the tools are in one line."""
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
    page : HTML; empty if there is none
    problems : errors and warnings
    summary : of the model in one line
    facts : numbers of the model, such as its degrees of freedom
    is_live : whether the page computes
    late : warnings of checks that take as long as the run, which only live pictures have
    """

    page: str = ""
    problems: tuple[Problem, ...] = ()
    summary: str = ""
    facts: dict[str, Any] = field(default_factory=dict)
    is_live: bool = False
    late: tuple[Problem, ...] = ()


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
        page = "" if error.position is None else _render(assembly_payload(error))
        return Picture(page, tuple(problems_of(error, text, path)))
    except DalembertError as error:
        return Picture(problems=tuple(problems_of(error, text, path)))


def _picture_of(text: str, path: Path, live: bool) -> Picture:
    data = parse_document(path, text)
    data, loose = without_loose_nodes(data)
    if not any(data.get(section) for section in parts_of(data)):
        blank = BLANK | {"title": path.stem} | (SPACE if _is_spatial(data) else {})
        return Picture(_render(blank), summary="nothing is drawn yet")
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
        return Picture(_render(still), (*notes, *reasons), summary, facts)
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
        return Picture(_render(page), problems, summary, facts)
    for row in page.get("parameters", ()):
        if row["name"] in places:
            row["drawn"] = places[row["name"]]
    responses = live_responses(file, model, page, result)
    stated = file.document.report.live
    size = DRAWN if places else None
    page = result.live_page(page, stated, responses, units=choices.get("units", ()), max_bytes=size)
    is_live = "code" in page.get("live", {})
    checks = tuple(Problem("warning", str(warning)) for warning in late)
    return Picture(_render(page) if is_live else "", problems, summary, facts, is_live, checks)


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


def _render(payload: dict[str, Any]) -> str:
    return render_page(payload).replace("</head>", f"<style>{EMBEDDED}</style>\n</head>", 1)
