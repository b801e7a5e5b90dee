"""``dalembert compare``: formulations and integrators compared on the mechanism of a file."""

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
    console,
    emit,
    written,
    wrong_input,
)
from dalembert.cli.loading import loaded, output_folder

if TYPE_CHECKING:
    from dalembert.results.comparison.result import Comparison

Numbers = Annotated[str, Parameter(allow_leading_hyphen=True)]
SHOWN = 8
"""Reasons that are told on the terminal."""


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

    All that is named is combined; what is not named is tried where it tells something.

    Parameters
    ----------
    model
        Model file; its [compare] and the times of its [analysis] hold where no option is given.
    duration
        Length of the runs [s].
    formulations
        Names with commas between them; RangeSpace,Kkt,NullSpace,AugmentedLagrangian,Dae by
        default. Options of a strategy are written in the file, under [compare].
    integrators
        Names; RK4,DormandPrince by default, and Radau for Dae.
    stabilizations
        Names; Projection by default.
    coordinates
        Names; AbsoluteCoordinates by default, and JointCoordinates for RangeSpace where no
        formulations are named.
    steps
        Steps of integrators with fixed steps [s], e.g. 0.02,0.01; four that suit the motion by
        default.
    tolerances
        Tolerances of integrators that control their steps; 1e-4,1e-6,1e-8 by default.
    measure
        Name or formula whose error is told; all coordinates by default.
    repeat
        How often each run is timed; the shortest time counts.
    output
        Folder for table and picture; this one by default.
    svg
        Write the picture as .svg instead of .png.
    """
    from dalembert.analysis.comparison.compare import Comparing
    from dalembert.analysis.comparison.reference import observe
    from dalembert.io.decisions.tasks import make_comparison

    file, built = loaded(model, settings)
    lists: dict[str, Any] = {
        "formulations": _split(formulations),
        "integrators": _split(integrators),
        "stabilizations": _split(stabilizations),
        "coordinates": _split(coordinates),
        "steps": _split(steps),
        "tolerances": _split(tolerances),
        "measure": measure,
        "repeat": repeat,
    }
    given = {name: value for name, value in lists.items() if value is not None}
    if duration is not None:
        given |= {"duration": duration, "t_span": None, "outputs": 201}
    with wrong_input():
        Comparing(**({"duration": LARGEST} | given))  # so that the file is not blamed for an option
        task = Comparing(**(make_comparison(file, built, given) | given))
        observe(built, task.measure)
    folder = output_folder(output)
    show = not quiet and not as_json and sys.stderr.isatty()
    made = task.run(built, progress=show)
    files = _write(made, folder / file.path.stem, "svg" if svg else "png")
    code = DONE if made.complete and made.finished.any() else FAILED
    code = code if made.complete else INTERRUPTED
    if as_json:
        emit(_document(made, code, files))
    elif not quiet:
        _print(made, files)
        if task.formulations is None and task.integrators is None:
            print("  compare others by --formulations A,B --integrators C,D; see --help")
    if code == FAILED and quiet:
        print("Error: no run finished", file=sys.stderr)
    return code


def _split(text: str | None) -> list[str] | None:
    return None if text is None else [part.strip() for part in text.split(",") if part.strip()]


def _write(made: Comparison, base: Path, kind: str) -> list[Path]:
    import matplotlib as mpl

    files = [made.to_csv(base.with_name(f"{base.name}.compare.csv"))]
    if made.finished.any():
        mpl.use("Agg")
        files.append(made.save_plot(base.with_name(f"{base.name}.compare.{kind}")))
    return files


def _document(made: Comparison, code: int, files: list[Path]) -> dict[str, Any]:
    from dalembert.results.comparison.data import BETWEEN

    about = made.data.attrs
    uncertainty = {k: about[f"uncertainty_{k}"] for k in ("position", "velocity", "reaction")}
    return {
        "ok": code == DONE,
        "name": about["model"],
        "start": about["start"],
        "end": about["end"],
        "measure": about["measure"],
        "unit": about["measure_unit"],
        "reference": {"runs": about["reference"], "uncertainty": uncertainty},
        "complete": made.complete,
        "runs": [
            row | {"warnings": [text for text in row["warnings"].split(BETWEEN) if text]}
            for row in made.table().to_dict("records")
        ],
        "orders": made.orders().to_dict("records"),
        "files": [str(f) for f in files],
    }


def _print(made: Comparison, files: list[Path]) -> None:
    from rich import box
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    from dalembert.results.comparison.table import cells, notes, title

    out = console()
    limited = out.is_terminal or "COLUMNS" in os.environ
    chosen, rows = cells(made, out.width if limited else None)
    texts = zip([column.heading for column in chosen], *rows, strict=True)
    out.width = max(out.width, sum(max(map(len, column)) + 2 for column in texts))
    table = Table(
        title=Text(title(made)),
        title_justify="left",
        box=box.SIMPLE_HEAD,
        show_edge=False,
        pad_edge=False,
        collapse_padding=True,
    )
    for column in chosen:
        side: Any = "left" if column.text else "right"
        table.add_column(Text(column.heading), justify=side, no_wrap=True)
    warned = made.table()["warnings"].astype(bool).tolist()
    group = [column.heading for column in chosen].index("integrator")
    for k, (row, good) in enumerate(zip(rows, made.finished, strict=True)):
        if k and row[:group] != rows[k - 1][:group]:
            table.add_section()
        style = "red" if not good else "yellow" if warned[k] else None
        table.add_row(*(Text(cell) for cell in row), style=style)
    out.print(table)
    reasons = [f"[{number}] {reason}" for number, reason in enumerate(notes(made), 1)]
    if len(reasons) > SHOWN:
        reasons[SHOWN:] = [f"… and {len(reasons) - SHOWN} more in the table's file"]
    for line in [*reasons, *made.summary()]:
        out.print(Padding(Text(line), (0, 0, 0, 2)), soft_wrap=False)
    written(files)
