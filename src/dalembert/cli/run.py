"""``dalembert run``: compute what a model file asks for and write results and report."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    FAILED,
    INTERRUPTED,
    AsJson,
    Quiet,
    Settings,
    console,
    emit,
    wrong_input,
)
from dalembert.cli.deck import run_deck
from dalembert.cli.loading import is_deck, loaded, output_folder
from dalembert.errors import UnsupportedError

if TYPE_CHECKING:
    from dalembert.analysis.linearization import Modes
    from dalembert.results.motion import Motion


def run(
    model: Path,
    /,
    *,
    output: Path | None = None,
    analysis: str | None = None,
    settings: Settings | None = None,
    report: bool = True,
    csv: Annotated[bool, Parameter(negative=())] = False,
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
    settings
        New value of a parameter, name=value; repeatable.
    report
        Write the interactive report.
    csv
        Write all results as a table too.
    quiet
        Print errors only.
    as_json
        Print one JSON document instead of text.
    """
    from dalembert.io.analyses import make_analysis
    from dalembert.io.tasks import report_choices

    if is_deck(model):
        with wrong_input():
            if analysis is not None:
                raise UnsupportedError(f"--analysis {analysis}: a deck is solved by linear statics")
        return run_deck(model, output, settings, csv, quiet, as_json)
    file, built = loaded(model, settings)
    with wrong_input():
        task = make_analysis(file, built, analysis)
        choices = report_choices(file, built)
    folder = output_folder(output)
    show = not quiet and not as_json and sys.stderr.isatty()
    with file.located("analysis"):
        result = task.run(built, progress=show)
    base = folder / file.path.stem
    if hasattr(result, "trajectory"):
        files = _write_motion(result, base, report, csv, choices)
        summary = _motion_summary(result)
        code = _exit_code(result)
    else:
        files, summary, code = _write_modes(result, base, csv), _modes_summary(result), DONE
    made = {"ok": code == DONE, "name": file.name, "model": built.diagnosis.summary, **summary}
    made["files"] = [str(f) for f in files]
    if as_json:
        emit(made)
    elif not quiet:
        _print(made, built.diagnosis.messages)
    if code != DONE and quiet:
        print(f"Error: {made['status']}", file=sys.stderr)
    return code


def _exit_code(motion: Motion) -> int:
    if motion.status.success:
        return DONE
    return INTERRUPTED if motion.status.outcome.name == "INTERRUPTED" else FAILED


def _write_motion(motion: Motion, base: Path, report: bool, csv: bool, choices: dict) -> list[Path]:
    files = [motion.save(base.with_name(f"{base.name}.nc"))]
    if csv:
        files.append(motion.to_csv(base.with_name(f"{base.name}.csv")))
    if report:
        files.append(motion.report(base.with_name(f"{base.name}.report.html"), **choices))
    return files


def _write_modes(modes: Modes, base: Path, csv: bool) -> list[Path]:
    from dalembert.atomic import atomic_path
    from dalembert.results.store import save_dataset

    files = [save_dataset(modes.data, base.with_name(f"{base.name}.nc"))]
    if csv:
        table = base.with_name(f"{base.name}.csv")
        with atomic_path(table) as temporary:
            modes.data[["frequency", "damping_ratio"]].to_dataframe().to_csv(temporary)
        files.append(table)
    return files


def _motion_summary(motion: Motion) -> dict[str, Any]:
    last: dict[str, Any] = {}
    for name in ("kinetic_energy", "potential_energy", "energy", "balance_error"):
        if name in motion.data and motion.time.size:
            last[name] = float(motion.data[name][-1])
    worst = {
        name: float(motion.data[name].max())
        for name in ("position_violation", "velocity_violation")
        if name in motion.data and motion.time.size
    }
    return {
        "status": str(motion.status),
        "time": motion.status.time,
        "residual": motion.status.residual,
        "statistics": motion.statistics,
        "warnings": list(motion.warnings),
        "events": [{"name": e.name, "time": e.time} for e in motion.events],
        "final": last,
        "largest": worst,
    }


def _modes_summary(modes: Modes) -> dict[str, Any]:
    found = zip(modes.frequencies, modes.damping_ratios, strict=True)
    return {
        "status": f"{'stable' if modes.stable else 'not stable'}, {modes.eigenvalues.size} mode(s)",
        "modes": [{"frequency [Hz]": float(f), "damping ratio": float(z)} for f, z in found],
    }


def _print(made: dict[str, Any], messages: list[tuple[str, str]]) -> None:
    out = console()
    out.print(f"[bold]{made['name']}[/bold]: {made['model']}")
    for level, text in messages:
        out.print(
            f"  {level}: {text}", markup=False, style="yellow" if level == "warning" else None
        )
    for text in made.get("warnings", []):
        out.print(f"  warning: {text}", markup=False, style="yellow")
    out.print(f"  {made['status']}", markup=False, style="green" if made["ok"] else "red")
    pairs = made.get("statistics", {}) | made.get("final", {}) | made.get("largest", {})
    for name, value in pairs.items():
        text = f"{value:.6g}" if isinstance(value, float) else str(value)
        out.print(f"  {name.replace('_', ' '):<24} {text}", markup=False)
    for event in made.get("events", [])[:20]:
        out.print(f"  event {event['name']} at t = {event['time']:.9g} s", markup=False)
    for number, mode in enumerate(made.get("modes", []), 1):
        listed = ", ".join(f"{name} {value:.6g}" for name, value in mode.items())
        out.print(f"  mode {number}: {listed}", markup=False)
    for path in made["files"]:
        out.print(f"  written {path}", markup=False)
