"""``dalembert run``: run the analysis of a model file, write results and report."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from dalembert.analysis.dynamics.record import projection_time
from dalembert.cli.console import (
    DONE,
    FAILED,
    INTERRUPTED,
    AsJson,
    Open,
    Quiet,
    Settings,
    console,
    format_value,
    open_pages,
    print_files,
    print_heading,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.deck import run_deck
from dalembert.cli.loading import (
    draw_assembly_failure,
    is_deck,
    load_model,
    model_printer,
    output_folder,
    refuse_replacing,
)
from dalembert.errors import UnsupportedError
from dalembert.interrupts import ctrl_c, defer_ctrl_c
from dalembert.results.status import Outcome, Status
from dalembert.text.wording import visible
from dalembert.timing import ENDING, Timing

SUBPARTS = {
    "model": ("build",),
    "analysis": (
        "assembly",
        "compile",
        "integration",
        "loading",
        "factorisation",
        "solution",
        "computation",
        "outputs",
        "checks",
    ),
}
"""Part of the command → its subparts in the statistics of a result."""


def run(
    model: Path,
    /,
    *,
    output: Path | None = None,
    analysis: str | None = None,
    settings: Settings | None = None,
    report: bool = True,
    live: bool | None = None,
    csv: Annotated[bool, Parameter(negative=())] = False,
    profile: Annotated[bool, Parameter(negative=())] = False,
    open_page: Open = False,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> int:
    """Run the analysis of a model file; writes results (.nc) and a report (.report.html).

    Parameters
    ----------
    model
        Model file, TOML or JSON; or the text deck of a spring structure, .dat.
    output
        Folder for the results; the current folder by default.
    analysis
        Type of analysis instead of the file's, e.g. Kinematics.
    report
        Write the interactive report.
    live
        Run the model in the report, with sliders for its parameters. By default as the file states,
        else if parameters have bounds and the compiled model is small.
    csv
        Also write all results as a table.
    profile
        Print the computing time of building, steps, outputs and report.
    """
    from dalembert.io.analyses import make_analysis
    from dalembert.io.report import live_responses, report_choices
    from dalembert.report.page import write_page
    from dalembert.report.views import notes

    if is_deck(model):
        with wrong_input():
            if analysis is not None:
                raise UnsupportedError(f"--analysis {analysis}: a deck is solved by linear statics")
            if profile:
                raise UnsupportedError("--profile: a deck has none; profile its model file")
        return run_deck(model, output, settings, report, csv, quiet, as_json, open_page)
    pages = (output or Path()) if report else None
    timing = Timing()
    file, built = load_model(model, settings, pages)
    timing.lap("model")
    printer = model_printer(built)
    with wrong_input():
        task = make_analysis(file, built, analysis)
        choices = report_choices(file, built)
    base = output_folder(output) / file.path.stem
    with wrong_input():
        refuse_replacing(model, [base.with_name(base.name + kind) for kind in (".nc", ".csv")])
    show = not quiet and not as_json and sys.stderr.isatty()
    with ctrl_c() as signals:
        with draw_assembly_failure(model, pages), file.located("analysis"), timing.part("analysis"):
            result = task.run(built, progress=show)
        defer_ctrl_c()
        with timing.part("results"):
            page = result.page(**choices)
            if texts := file.document.report.notes:
                page["views"] = [notes("Notes", texts) | {"place": "board"}, *page.get("views", ())]
            files = result.write_data(base, csv, page, choices.get("units", ()))
        if report:
            with timing.part("report"):
                choice = file.document.report.live if live is None else live
                responses = live_responses(file, built, page, result)
                units = choices.get("units", ())
                page = result.live_page(page, choice, responses, units=units)
                files.append(write_page(page, base.with_name(f"{base.name}.report.html")))
        interrupted_late = signals.pressed and result.status.outcome is not Outcome.INTERRUPTED
    code = INTERRUPTED if interrupted_late else _exit_code(result.status)
    summary: dict[str, Any] = {"ok": code == DONE, "name": file.name, "model": printer.sentence}
    summary |= result.summary()
    summary["files"] = [str(f) for f in files]
    if interrupted_late:
        summary["interrupted"] = True
        print("Error: interrupted after the analysis; its results are complete", file=sys.stderr)
    if profile:
        summary["profile"] = _profile_data(timing, result)
    if as_json:
        print_json(summary)
    elif not quiet:
        _print(summary, printer.messages)
        printer.show(summary)
        print_files(files)
        if profile:
            _print_profile(summary["profile"])
    open_pages(files, open_page)
    if code != DONE and quiet and not interrupted_late:
        print(f"Error: {summary['status']}", file=sys.stderr)
    return code


def _exit_code(status: Status) -> int:
    if status.success:
        return DONE
    return INTERRUPTED if status.outcome is Outcome.INTERRUPTED else FAILED


def _print(summary: dict[str, Any], messages: list[tuple[str, str]]) -> None:
    print_heading(summary["name"], summary["model"])
    for level, text in messages:
        print_line(f"  {level}: {text}", "yellow" if level == "warning" else None)
    for text in summary.get("warnings", []):
        print_line(f"  warning: {text}", "yellow")
    print_line(f"  {summary['status']}", "green" if summary["ok"] else "red")
    for name, value in summary.get("statistics", {}).items():
        print_line(f"  {name.replace('_', ' '):<24} {format_value(value)}")


def _profile_data(timing: Timing, result: Any) -> dict[str, Any]:
    """Seconds of the parts of a command and of their subparts, and counts.

    Parameters
    ----------
    timing : seconds of the parts of the command
    result : Result with its statistics
    """
    statistics = result.statistics
    parts: dict[str, dict[str, Any]] = {
        name: {"seconds": seconds, "inside": _subparts(name, statistics)}
        for name, seconds in timing.parts.items()
    }
    seconds = projection_time(result)
    if seconds is not None:
        parts["analysis"]["inside"]["projection, of the integration"] = seconds
    counts = {
        name: value
        for name, value in statistics.items()
        if isinstance(value, int) and not isinstance(value, bool)
    }
    return {"seconds": timing.total, "parts": parts, "counts": counts}


def _subparts(part: str, statistics: Mapping[str, Any]) -> dict[str, float]:
    names = SUBPARTS.get(part, ())
    return {name: statistics[name + ENDING] for name in names if name + ENDING in statistics}


def _print_profile(data: Mapping[str, Any]) -> None:
    """Print the profile as a table."""
    from rich.table import Table

    table = Table("part", "seconds", "share", title="profile", title_justify="left")
    total = max(data["seconds"], 1e-300)
    for name, part in data["parts"].items():
        table.add_row(visible(name), *_profile_row(part["seconds"], total), style="bold")
        for inner, seconds in part["inside"].items():
            table.add_row(f"  {visible(inner)}", *_profile_row(seconds, total))
    table.add_row("all", *_profile_row(data["seconds"], total), style="bold")
    for column in table.columns[1:]:
        column.justify = "right"
    console().print(table)
    counts = Table("count", "number", show_edge=True)
    counts.columns[1].justify = "right"
    for name, number in data["counts"].items():
        counts.add_row(visible(name), str(number))
    if data["counts"]:
        console().print(counts)


def _profile_row(seconds: float, total: float) -> tuple[str, str]:
    return f"{seconds:.4f}", f"{100 * seconds / total:.1f} %"
