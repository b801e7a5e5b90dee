"""``dalembert sweep``: responses of a model file at many designs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.cli.console import print_line, wrong_input
from dalembert.cli.decision import NO_OPTIONS, DecisionCommand, Options, Run
from dalembert.cli.loading import load_model, output_folder

if TYPE_CHECKING:
    from dalembert.design.studies.sweep_result import SweepResult
    from dalembert.design.studies.task import StudyTask
    from dalembert.io.model_file import ModelFile


@dataclass(frozen=True)
class FileTask:
    """Builds the study of a model file, in this process or on a worker with access to the file."""

    path: Path
    settings: tuple[str, ...]

    def __call__(self) -> StudyTask:
        from dalembert.design.studies.task import StudyTask
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.tasks import make_sweep

        file, built = load_model(self.path, list(self.settings))
        with wrong_input():
            return StudyTask(built, make_analysis(file, built), make_sweep(file, built)[1])


def sweep(
    model: Path,
    /,
    *,
    output: Path | None = None,
    workers: int = 0,
    scheduler: str | None = None,
    chunk: int | None = None,
    options: Options = NO_OPTIONS,
) -> int:
    """Run the analysis of a model file at many designs and store its responses.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [sweep].
    output
        Folder of the study: responses are written as they are computed, and an interrupted study
        is resumed. The result is table.parquet (table.csv without pyarrow), its page report.html.
        By default the name of the file with '.study'.
    workers
        Number of processes; 0 for all cores.
    scheduler
        Address of a Dask scheduler, such as tcp://host:8786, whose workers can read the file.
    chunk
        Number of designs sent to a worker at once.
    """
    folder = output or model.with_name(f"{model.stem}.study")
    make = FileTask(model.resolve(), tuple(options.settings or ()))

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.studies.sweep import check_counts, run_study
        from dalembert.io.decisions.tasks import make_sweep

        design, _ = make_sweep(file, built)
        check_counts(workers or None, chunk)
        output_folder(folder)
        schedule = {"workers": workers or None, "scheduler": scheduler, "chunk": chunk}
        return lambda show: run_study(make, design, folder, progress=show, **schedule)  # type: ignore[arg-type]

    def write(study: SweepResult) -> list[Path]:
        return [study.report(folder / "report.html")]

    return DecisionCommand(model, folder, options).execute(read, _show, write=write)


def _show(summary: dict[str, Any]) -> None:
    if summary["reused_count"]:
        print_line(f"  {summary['reused_count']} were there already")
    for name, numbers in summary["responses"].items():
        statistics = ", ".join(
            f"{key} {value:.6g}" for key, value in numbers.items() if key != "unit"
        )
        unit = "" if numbers["unit"] in ("", "1") else f" [{numbers['unit']}]"
        print_line(f"  {name}{unit}: {statistics}")
    reasons, counts = np.unique(list(summary["failed"].values()), return_counts=True)
    for k in np.argsort(-counts)[:3]:
        print_line(f"  {counts[k]} failed: {reasons[k]}", "red")
    if summary["table"] is not None:
        print_line(f"  written {summary['table']}")
    if summary["note"]:
        print_line(f"  note: {summary['note']}", "yellow")
