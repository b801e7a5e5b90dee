"""Estimation from measurements: ``[identify]`` and ``[invert]`` of a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dalembert.design.identification.experiment import Experiment
from dalembert.design.identification.least_squares import LOSSES
from dalembert.design.inverse.input_history import InputHistory
from dalembert.design.inverse.smoothing import CHOICES
from dalembert.elements.laws.table import Table
from dalembert.errors import AnalysisError
from dalembert.io.decisions.responses import read_measures, require_parameter, select_parameters
from dalembert.io.model_file import ModelFile
from dalembert.io.values import constant
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown


def make_identification(
    file: ModelFile, model: ParametricModel, data: list[Path] | None = None
) -> dict:
    """Arguments of ``identify`` from ``[identify]``.

    Parameters
    ----------
    data : files of measurements instead of the file's own

    Raises
    ------
    ModelError
        No ``[identify]``, or invalid names; states the location.
    """
    table = file.document.identify
    if table is None:
        raise file.located.error("is missing; add [identify] with data and vary", "identify")
    if table.loss not in LOSSES:
        raise file.located.error(unknown("loss", table.loss, LOSSES), "identify", "loss")
    if table.starts < 1:
        raise file.located.error(f"is {table.starts}; give one or more", "identify", "starts")
    measures = read_measures(file, model, table.measures, "identify", "measures")
    bounded = [n for n, p in model.parameters.items() if p.bounds[0] > -float("inf")]
    own_names = [name for experiment in table.experiments for name in experiment.own]
    vary = table.vary or [n for n in bounded if n not in own_names]
    for column, pair in table.delays.items():
        if pair is None or not pair[0] < pair[1]:
            raise file.located.error("give [lower, upper]", "identify", "delays", column)
    arguments: dict[str, Any] = {
        "data": [Experiment(data=str(path)) for path in data]
        if data
        else _experiments(file, model),
        "measures": measures or None,
        "vary": select_parameters(file, vary, "identify", "vary") if vary else [],
        "noise": dict(table.noise),
        "delays": {column: tuple(pair) for column, pair in table.delays.items()},
    }
    return arguments | {
        key: getattr(table, key) for key in ("time", "loss", "starts", "rng", "max_iterations")
    }


def _experiments(file: ModelFile, model: ParametricModel) -> list[Experiment]:
    """Experiments of the file, with data files in its folder."""
    table, folder = file.document.identify, file.path.parent
    if (table.data is None) == (not table.experiments):
        raise file.located.error("give data, or a list of experiments", "identify", "data")
    if table.data is not None:
        return [Experiment(data=str(folder / table.data))]
    experiments = []
    for k, row in enumerate(table.experiments):
        for key in ("parameters", "own"):
            for name in getattr(row, key):
                require_parameter(file, model, name, "identify", "experiments", k, key)
        with file.located("identify", "experiments", k):
            options = {"parameters": row.parameters, "own": row.own, "name": row.name}
            experiments.append(Experiment(data=str(folder / row.data), **options))
    return experiments


def make_inversion(
    file: ModelFile, model: ParametricModel, data: list[Path] | None = None
) -> dict[str, Any]:
    """Arguments of ``invert`` from ``[invert]``.

    Parameters
    ----------
    data : file of measurements instead of the file's own

    Raises
    ------
    ModelError
        No ``[invert]``, no histories, or invalid names; states the location.
    """
    document: Any = file.document
    table = getattr(document, "invert", None)
    if table is None:
        raise file.located.error("is missing; add [invert] with data and measures", "invert")
    if not document.histories:
        cure = "is missing; add e.g. [histories.push] with knots = { end = 1.0, count = 20 }"
        raise file.located.error(cure, "histories")
    if table.data is None and not data:
        raise file.located.error("give data, a file of measurements", "invert", "data")
    measures = read_measures(file, model, table.measures, "invert", "measures")
    for k, name in enumerate(table.vary):
        require_parameter(file, model, name, "invert", "vary", k)
    if table.order not in (1, 2, 3):
        raise file.located.error(f"is {table.order}; give 1, 2 or 3", "invert", "order")
    arguments: dict[str, Any] = {
        "data": str(data[0]) if data else str(file.path.parent / table.data),
        "measures": measures or None,
        "histories": [_history(file, model, name) for name in document.histories],
        "vary": list(table.vary),
        "smoothing": _smoothing(file, table.smoothing),
        "noise": dict(table.noise),
    }
    return arguments | {key: getattr(table, key) for key in ("order", "time", "max_iterations")}


def _smoothing(file: ModelFile, entry: Any) -> str | float:
    """Name of a method to choose the smoothing, or a number above zero."""
    if entry in CHOICES:
        return str(entry)
    try:
        value = constant(entry)
    except ValueError:
        text = unknown("smoothing", entry, CHOICES)
        raise file.located.error(text, "invert", "smoothing") from None
    if not value > 0:
        raise file.located.error(f"is {value:g}; it must be above zero", "invert", "smoothing")
    return value


def _history(file: ModelFile, model: ParametricModel, name: str) -> InputHistory:
    """History of a built model, from its parameters."""
    document: Any = file.document
    times = document.histories[name].times()
    parameters = tuple(model.parameters[f"{name}_{k}"] for k in range(times.size))
    return InputHistory(
        name,
        times,
        parameters,
        Table(times.tolist(), list(parameters), ends=document.histories[name].ends),
    )


def check_files(files: list[Any]) -> None:
    """Check that the files of measurements exist.

    Raises
    ------
    AnalysisError
        A file does not exist; names it.
    """
    for path in files:
        if not Path(path).is_file():
            raise AnalysisError(f"{path}: there is no such file of data")
