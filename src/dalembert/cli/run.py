"""``dalembert run``: compute what a model file asks for and write results and report."""

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
    Quiet,
    Settings,
    emit,
    head,
    shown,
    tell,
    written,
    wrong_input,
)
from dalembert.cli.deck import run_deck
from dalembert.cli.loading import (
    failure_drawn,
    is_deck,
    loaded,
    output_folder,
    refuse_replacing,
    teller_of,
)
from dalembert.cli.opening import Open, opened
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
        Folder for the results; this one by default.
    analysis
        Another type of analysis than the file's, e.g. Kinematics.
    report
        Write the interactive report.
    csv
        Write all results as a table too.
    profile
        Tell where the time went: building, steps, outputs, report.
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
    file, built = loaded(model, settings, pages)
    timing.lap("model")
    teller = teller_of(built)
    with wrong_input():
        task = make_analysis(file, built, analysis)
        choices = report_choices(file, built)
    base = output_folder(output) / file.path.stem
    with wrong_input():
        refuse_replacing(model, [base.with_name(base.name + kind) for kind in (".nc", ".csv")])
    show = not quiet and not as_json and sys.stderr.isatty()
    with ctrl_c() as signals:
        with failure_drawn(model, pages), file.located("analysis"), timing.part("analysis"):
            result = task.run(built, progress=show)
        defer_ctrl_c()
        with timing.part("results"):
            page = result.page(**choices) if result.has_page else None
            files = result.write_data(base, csv, page, choices.get("units", ()))
        if report and page is not None:
            with timing.part("report"):
                files.append(write_page(page, base.with_name(f"{base.name}.report.html")))
        late = signals.pressed and result.status.outcome is not Outcome.INTERRUPTED
    code = INTERRUPTED if late else _exit_code(result.status)
    made: dict[str, Any] = {"ok": code == DONE, "name": file.name, "model": teller.sentence}
    made |= result.summary()
    made["files"] = [str(f) for f in files]
    if late:
        made["interrupted"] = True
        print("Error: interrupted after the analysis; its results are complete", file=sys.stderr)
    if profile:
        made["profile"] = profile_of(timing, result)
    if as_json:
        emit(made)
    elif not quiet:
        _print(made, teller.messages)
        teller.show(made)
        written(files)
        if profile:
            show_profile(made["profile"])
    opened(files, open_page)
    if code != DONE and quiet and not late:
        print(f"Error: {made['status']}", file=sys.stderr)
    return code


def _exit_code(status: Status) -> int:
    if status.success:
        return DONE
    return INTERRUPTED if status.outcome is Outcome.INTERRUPTED else FAILED


def _print(made: dict[str, Any], messages: list[tuple[str, str]]) -> None:
    head(made["name"], made["model"])
    for level, text in messages:
        tell(f"  {level}: {text}", "yellow" if level == "warning" else None)
    for text in made.get("warnings", []):
        tell(f"  warning: {text}", "yellow")
    tell(f"  {made['status']}", "green" if made["ok"] else "red")
    for name, value in made.get("statistics", {}).items():
        tell(f"  {name.replace('_', ' '):<24} {shown(value)}")
