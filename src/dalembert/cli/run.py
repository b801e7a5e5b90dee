"""``dalembert run``: run the analysis of a model file, write results and report."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    FAILED,
    INTERRUPTED,
    AsJson,
    Open,
    Quiet,
    Settings,
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
from dalembert.cli.profile import profile as profile_of, show_profile
from dalembert.errors import UnsupportedError
from dalembert.interrupts import ctrl_c, defer_ctrl_c
from dalembert.results.status import Outcome, Status
from dalembert.timing import Timing


def run(
    model: Path,
    /,
    *,
    output: Path | None = None,
    analysis: str | None = None,
    settings: Settings | None = None,
    report: bool = True,
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
    csv
        Also write all results as a table.
    profile
        Print the computing time of building, steps, outputs and report.
    """
    from dalembert.io.analyses import make_analysis
    from dalembert.io.decisions.tasks import report_choices
    from dalembert.report.page import write_page

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
            page = result.page(**choices) if result.has_page else None
            files = result.write_data(base, csv, page, choices.get("units", ()))
        if report and page is not None:
            with timing.part("report"):
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
        summary["profile"] = profile_of(timing, result)
    if as_json:
        print_json(summary)
    elif not quiet:
        _print(summary, printer.messages)
        printer.show(summary)
        print_files(files)
        if profile:
            show_profile(summary["profile"])
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
