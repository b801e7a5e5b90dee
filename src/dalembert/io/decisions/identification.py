"""What ``[identify]`` of a file asks: data, measures and unknown parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dalembert.design.identification.experiment import Experiment
from dalembert.design.identification.least_squares import LOSSES
from dalembert.errors import AnalysisError
from dalembert.io.decisions.responses import chosen_parameters
from dalembert.io.measures import measure_reader
from dalembert.io.model_file import ModelFile
from dalembert.text.wording import unknown


def make_identification(file: ModelFile, model: Any, data: list[Path] | None = None) -> dict:
    """The arguments of ``identify`` that the file gives.

    Parameters
    ----------
    data : files of measurements instead of the file's own

    Raises
    ------
    ModelError
        No ``[identify]``, or names that cannot work, with their place.
    """
    asked = file.document.identify
    if asked is None:
        raise file.located.error("is missing; add [identify] with data and vary", "identify")
    if asked.loss not in LOSSES:
        raise file.located.error(unknown("loss", asked.loss, LOSSES), "identify", "loss")
    if asked.starts < 1:
        raise file.located.error(f"is {asked.starts}; give one or more", "identify", "starts")
    read, measures = measure_reader(file.document), {}
    for column, text in asked.measures.items():
        with file.located("identify", "measures", column):
            measures[column] = read(model, text)
    bounded = [n for n, p in model.parameters.items() if p.bounds[0] > -float("inf")]
    owned = [name for experiment in asked.experiments for name in experiment.own]
    vary = asked.vary or [n for n in bounded if n not in owned]
    for column, pair in asked.delays.items():
        if pair is None or not pair[0] < pair[1]:
            raise file.located.error("give [least, most]", "identify", "delays", column)
    made: dict[str, Any] = {
        "data": [Experiment(data=str(path)) for path in data] if data else _own(file, model),
        "measures": measures or None,
        "vary": chosen_parameters(file, vary, "identify", "vary") if vary else [],
        "noise": dict(asked.noise),
        "delays": {column: tuple(pair) for column, pair in asked.delays.items()},
    }
    return made | {
        key: getattr(asked, key) for key in ("time", "loss", "starts", "rng", "max_iterations")
    }


def _own(file: ModelFile, model: Any) -> list[Experiment]:
    """The experiments that the file names; their data lie beside it."""
    asked, folder = file.document.identify, file.path.parent
    if (asked.data is None) == (not asked.experiments):
        raise file.located.error("give data, or a list of experiments", "identify", "data")
    if asked.data is not None:
        return [Experiment(data=str(folder / asked.data))]
    made = []
    for k, table in enumerate(asked.experiments):
        for key in ("parameters", "own"):
            for name in getattr(table, key):
                if name not in model.parameters:
                    text = unknown("parameter", name, model.parameters)
                    raise file.located.error(text, "identify", "experiments", k, key)
        with file.located("identify", "experiments", k):
            given = {"parameters": table.parameters, "own": table.own, "name": table.name}
            made.append(Experiment(data=str(folder / table.data), **given))
    return made


def check_files(files: list[Any]) -> None:
    """The files of measurements are there.

    Raises
    ------
    AnalysisError
        Names the file.
    """
    for path in files:
        if not Path(path).is_file():
            raise AnalysisError(f"{path}: there is no such file of data")
