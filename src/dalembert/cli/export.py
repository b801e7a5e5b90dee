"""``dalembert export``: a model file, or its analysis, for other programs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    AsJson,
    Settings,
    print_files,
    print_heading,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.export_options import FormatOptions, format_options
from dalembert.cli.export_unit import FMU, UnitOptions, export_unit
from dalembert.cli.loading import load_model, output_folder, refuse_replacing
from dalembert.errors import ExpressionError, UnsupportedError
from dalembert.io.exports.export import write_files
from dalembert.io.exports.registry import FORMATS
from dalembert.report.exports import FORMATS as MODULES
from dalembert.text.wording import unknown

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile
    from dalembert.responses.base import Response

Names = Annotated[list[str], Parameter(negative=())]
Format = Annotated[str, Parameter(help=f"Format: {', '.join((*MODULES, *FORMATS))}.")]


def export(
    model: Path,
    /,
    *,
    to: Format = "js",
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    measure: Names | None = None,
    response: Names | None = None,
    analysis: str | None = None,
    settings: Settings | None = None,
    unit: UnitOptions | None = None,
    option: FormatOptions | None = None,
    as_json: AsJson = False,
) -> int:
    """Write a model file, or its analysis, for another program.

    The format js is a module that runs without Python: it simulates the model for any parameter
    values and differentiates its responses. The format fmu is a functional mock-up unit, which runs
    in other simulation programs. Other formats are files of the model (mjcf, urdf, dxf,
    latex, python) or of the results of its analysis; parts that a format cannot express are listed.

    Parameters
    ----------
    model
        Model file, TOML or JSON.
    output
        Folder for the files; the current folder by default.
    measure
        Output of a module over time, name or formula; by default the plots and traced points of
        the file, else the coordinates of all bodies; of modes the frequencies and damping ratios.
        Repeatable.
    response
        Name of a response of a module; all by default. Repeatable.
    analysis
        Type of analysis instead of the file's, e.g. Kinematics.
    """
    names = [*MODULES, *FORMATS]
    with wrong_input():
        if to not in names:
            raise UnsupportedError(unknown("format", to, names))
        options = format_options(option or ())
        if options and (to in MODULES or to == FMU):
            raise UnsupportedError(
                f"the format {to} has no --option {next(iter(options))}; remove it"
            )
    file, built = load_model(model, settings)
    folder = output_folder(output)
    if to in MODULES:
        return _export_module(file, built, to, folder, measure, response, analysis, as_json)
    if to == FMU:
        return export_unit(file, built, folder, measure, analysis, unit or UnitOptions(), as_json)
    return _export_file(file, built, to, folder, analysis, options, as_json)


def _export_file(
    file: ModelFile,
    model: Any,
    to: str,
    folder: Path,
    analysis: str | None,
    options: dict[str, Any],
    as_json: bool,
) -> int:
    """Write a file of the model, or of the result of its analysis; ``time`` is an instant of it."""
    from dalembert.io.analyses import make_analysis

    chosen, source = FORMATS[to], model
    target = folder / f"{file.path.stem}{chosen.suffix}"
    with wrong_input():
        chosen.check_options(options)
    if chosen.of_file:
        source = file
    elif not chosen.of_model or "time" in options:
        with wrong_input():
            task = make_analysis(file, model, analysis)
        with file.located("analysis"):
            source = task.run(model, progress=not as_json and sys.stderr.isatty())
    with wrong_input():
        contents = chosen.create(source, target.stem, options)
        refuse_replacing(file.path, [folder / name for name in contents.files])
        files = write_files(contents, target)
    omissions = [str(omission) for omission in contents.omissions]
    if as_json:
        summary = {"ok": True, "name": file.name, "to": to, "omissions": omissions}
        print_json(summary | {"files": [str(path) for path in files]})
    else:
        print_heading(file.name, chosen.contents)
        for omission in omissions:
            print_line(f"Not exported: {omission}")
        print_files(files)
    return DONE


def _export_module(
    file: ModelFile,
    built: Any,
    to: str,
    folder: Path,
    measure: list[str] | None,
    response: list[str] | None,
    analysis: str | None,
    as_json: bool,
) -> int:
    """Write the analysis as a module for another language."""
    from dalembert.io.analyses import make_analysis
    from dalembert.io.decisions.responses import make_responses
    from dalembert.io.report import exported_measures
    from dalembert.report.exports import write_export
    from dalembert.results.module import build_module

    with wrong_input():
        task = make_analysis(file, built, analysis)
        responses = make_responses(file, built)
        chosen = list(responses.values()) if response is None else _named(responses, response)
    with file.located("analysis"):
        result = task.run(built, progress=not as_json and sys.stderr.isatty())
    with wrong_input():
        measures = measure or exported_measures(file, built, result)
    module = build_module(result, measures, chosen)
    files = write_export(to, module.data(), folder, file.path.stem)
    size = len(module.code)
    if as_json:
        summary = {"ok": True, "name": file.name, "to": to, "bytes": size}
        names = [row["label"] for row in module.responses]
        outputs = {"measures": list(module.measures), "responses": names}
        print_json(summary | outputs | {"files": [str(path) for path in files]})
    else:
        print_heading(file.name, repr(module).strip("<>"))
        print_files(files)
    return DONE


def _named(responses: dict[str, Response], names: list[str]) -> list[Response]:
    for name in names:
        if name not in responses:
            raise ExpressionError(unknown("response", name, responses))
    return [responses[name] for name in names]
