"""``dalembert sweep``: responses of a model file at many designs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.cli.console import tell, wrong_input
from dalembert.cli.decision import PLAIN, Asked, Options, Run
from dalembert.cli.loading import loaded, output_folder

if TYPE_CHECKING:
    from dalembert.design.studies.study import Study
    from dalembert.design.studies.task import StudyTask
    from dalembert.io.model_file import ModelFile


@dataclass(frozen=True)
class FileTask:
    """Makes the task of a model file, here or on a worker that sees the same file."""

    path: Path
    settings: tuple[str, ...]

    def __call__(self) -> StudyTask:
        from dalembert.design.studies.task import StudyTask
        from dalembert.io.analyses import make_analysis
        from dalembert.io.decisions.tasks import make_sweep

        file, built = loaded(self.path, list(self.settings))
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
    options: Options = PLAIN,
) -> int:
    """Run the analysis of a model file at many designs and keep its responses.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and [sweep].
    output
        Folder of the study: answers are written there as they come, and a study that was ended
        goes on there. The whole is table.parquet (table.csv without pyarrow), its page report.html.
        By default the name of the file and '.study'.
    workers
        Processes; 0 for all cores.
    scheduler
        Address of a Dask scheduler, such as tcp://host:8786, whose workers see the same file.
    chunk
        Designs that a worker is given at once.
    """
    folder = output or model.with_name(f"{model.stem}.study")
    make = FileTask(model.resolve(), tuple(options.settings or ()))

    def read(file: ModelFile, built: Any) -> Run:
        from dalembert.design.studies.sweep import check_counts, run_study
        from dalembert.io.decisions.tasks import make_sweep

        design, _ = make_sweep(file, built)
        check_counts(workers or None, chunk)
        output_folder(folder)
        how = {"workers": workers or None, "scheduler": scheduler, "chunk": chunk}
        return lambda show: run_study(make, design, folder, progress=show, **how)  # type: ignore[arg-type]

    def write(found: Study) -> list[Path]:
        return [found.report(folder / "report.html")]

    return Asked(model, folder, options).decide(read, _show, write=write)


def _show(made: dict[str, Any]) -> None:
    if made["reused"]:
        tell(f"  {made['reused']} were there already")
    for name, numbers in made["responses"].items():
        told = ", ".join(f"{key} {value:.6g}" for key, value in numbers.items() if key != "unit")
        unit = "" if numbers["unit"] in ("", "1") else f" [{numbers['unit']}]"
        tell(f"  {name}{unit}: {told}")
    reasons, counts = np.unique(list(made["failed"].values()), return_counts=True)
    for k in np.argsort(-counts)[:3]:
        tell(f"  {counts[k]} failed: {reasons[k]}", "red")
    tell(f"  written {made['table']}")
    if made["note"]:
        tell(f"  note: {made['note']}", "yellow")
