"""``dalembert compare``: comparison of formulations and integrators on a model file."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.budget import LARGEST
from dalembert.cli.console import (
    DONE,
    FAILED,
    INTERRUPTED,
    AsJson,
    Quiet,
    Settings,
    aligned_table,
    console,
    print_files,
    print_json,
    wrong_input,
)
from dalembert.cli.loading import load_model, output_folder

if TYPE_CHECKING:
    from dalembert.results.comparison.result import Comparison

Numbers = Annotated[str, Parameter(allow_leading_hyphen=True)]
MAX_NOTES = 8
"""Upper limit of notes printed on the terminal."""


def compare(
    model: Path,
    /,
    *,
    duration: float | None = None,
    formulations: str | None = None,
    integrators: str | None = None,
    stabilizations: str | None = None,
    coordinates: str | None = None,
    steps: Numbers | None = None,
    tolerances: Numbers | None = None,
    measure: str | None = None,
    repeat: int | None = None,
    output: Path | None = None,
    svg: Annotated[bool, Parameter(negative=())] = False,
    settings: Settings | None = None,
    quiet: Quiet = False,
    as_json: AsJson = False,
) -> int:
    """Compare formulations and integrators; writes a table (.compare.csv) and a picture.

    All named strategies are combined; strategies that are not named are added where informative.

    Parameters
    ----------
    model
        Model file; its [compare] and the times of its [analysis] apply unless an option is given.
    duration
        Length of the runs [s].
    formulations
        Comma-separated names; RangeSpace,KKT,NullSpace,AugmentedLagrangian,DAE by
        default. Options of a strategy are written in the file, under [compare].
    integrators
        Names; RK4,DormandPrince by default, and Radau for DAE.
    stabilizations
        Names; Projection by default.
    coordinates
        Names; AbsoluteCoordinates by default, and JointCoordinates for RangeSpace where no
        formulations are named.
    steps
        Step sizes of fixed-step integrators [s], e.g. 0.02,0.01; by default four that suit the
        motion.
    tolerances
        Tolerances of adaptive integrators; 1e-4,1e-6,1e-8 by default.
    measure
        Name or formula whose error is reported; all coordinates by default.
    repeat
        Number of repetitions of each run; the shortest time is reported.
    output
        Folder for table and picture; the current folder by default.
    svg
        Write the picture as .svg instead of .png.
    """
    from dalembert.analysis.comparison.compare import Comparing
    from dalembert.analysis.comparison.reference import observe
    from dalembert.io.decisions.tasks import make_comparison

    file, built = load_model(model, settings)
    options: dict[str, Any] = {
        "formulations": _split(formulations),
        "integrators": _split(integrators),
        "stabilizations": _split(stabilizations),
        "coordinates": _split(coordinates),
        "steps": _split(steps),
        "tolerances": _split(tolerances),
        "measure": measure,
        "repeat": repeat,
    }
    replacements = {name: value for name, value in options.items() if value is not None}
    if duration is not None:
        replacements |= {"duration": duration, "t_span": None, "outputs": 201}
    with wrong_input():
        # errors of options are reported separately from those of the file
        Comparing(**({"duration": LARGEST} | replacements))
        task = Comparing(**(make_comparison(file, built, replacements) | replacements))
        observe(built, task.measure)
    folder = output_folder(output)
    show = not quiet and not as_json and sys.stderr.isatty()
    comparison = task.run(built, progress=show)
    files = _write(comparison, folder / file.path.stem, "svg" if svg else "png")
    code = DONE if comparison.complete and comparison.finished.any() else FAILED
    code = code if comparison.complete else INTERRUPTED
    if as_json:
        print_json(_document(comparison, code, files))
    elif not quiet:
        _print(comparison, files)
        if task.formulations is None and task.integrators is None:
            print("  compare others with --formulations A,B --integrators C,D; see --help")
    if code == FAILED and quiet:
        print("Error: no run finished", file=sys.stderr)
    return code


def _split(text: str | None) -> list[str] | None:
    return None if text is None else [part.strip() for part in text.split(",") if part.strip()]


def _write(comparison: Comparison, base: Path, kind: str) -> list[Path]:
    import matplotlib as mpl

    files = [comparison.to_csv(base.with_name(f"{base.name}.compare.csv"))]
    if comparison.finished.any():
        mpl.use("Agg")
        files.append(comparison.save_plot(base.with_name(f"{base.name}.compare.{kind}")))
    return files


def _document(comparison: Comparison, code: int, files: list[Path]) -> dict[str, Any]:
    from dalembert.results.comparison.data import BETWEEN

    attributes = comparison.data.attrs
    uncertainty = {k: attributes[f"uncertainty_{k}"] for k in ("position", "velocity", "reaction")}
    return {
        "ok": code == DONE,
        "name": attributes["model"],
        "start": attributes["start"],
        "end": attributes["end"],
        "measure": attributes["measure"],
        "unit": attributes["measure_unit"],
        "reference": {"runs": attributes["reference"], "uncertainty": uncertainty},
        "complete": comparison.complete,
        "runs": [
            row | {"warnings": [text for text in row["warnings"].split(BETWEEN) if text]}
            for row in comparison.table().to_dict("records")
        ],
        "orders": comparison.orders().to_dict("records"),
        "files": [str(f) for f in files],
    }


def _print(comparison: Comparison, files: list[Path]) -> None:
    from rich.padding import Padding
    from rich.text import Text

    from dalembert.results.comparison.table import cells, notes, title

    terminal = console()
    has_width = terminal.is_terminal or "COLUMNS" in os.environ
    columns, rows = cells(comparison, terminal.width if has_width else None)
    texts = zip([column.heading for column in columns], *rows, strict=True)
    terminal.width = max(terminal.width, sum(max(map(len, column)) + 2 for column in texts))
    table = aligned_table(title(comparison))
    for column in columns:
        side: Any = "left" if column.text else "right"
        table.add_column(Text(column.heading), justify=side, no_wrap=True)
    has_warning = comparison.table()["warnings"].astype(bool).tolist()
    group = [column.heading for column in columns].index("integrator")
    for k, (row, finished) in enumerate(zip(rows, comparison.finished, strict=True)):
        if k and row[:group] != rows[k - 1][:group]:
            table.add_section()
        style = "red" if not finished else "yellow" if has_warning[k] else None
        table.add_row(*(Text(cell) for cell in row), style=style)
    terminal.print(table)
    lines = [f"[{number}] {reason}" for number, reason in enumerate(notes(comparison), 1)]
    if len(lines) > MAX_NOTES:
        lines[MAX_NOTES:] = [f"… and {len(lines) - MAX_NOTES} more in the table's file"]
    for line in [*lines, *comparison.summary()]:
        terminal.print(Padding(Text(line), (0, 0, 0, 2)), soft_wrap=False)
    print_files(files)
