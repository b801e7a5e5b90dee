"""``dalembert sensitivity``: gradients of the responses of a model file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from dalembert.cli.console import DONE, FAILED, AsJson, Settings, emit, written
from dalembert.cli.loading import output_folder
from dalembert.results.status import Outcome

if TYPE_CHECKING:
    import xarray as xr

Names = Annotated[list[str], Parameter(negative=())]


def sensitivity(
    model: Path,
    /,
    *,
    method: str | None = None,
    response: Names | None = None,
    wrt: Names | None = None,
    certificate: Annotated[bool, Parameter(negative=())] = False,
    output: Path | None = None,
    plot: Annotated[bool, Parameter(negative=())] = False,
    svg: Annotated[bool, Parameter(negative=())] = False,
    settings: Settings | None = None,
    as_json: AsJson = False,
) -> int:
    """Derivatives of the responses of a model file by its parameters, sorted by influence.

    Beside them stand relative ones, percent of the response per percent of the parameter, and notes
    on what is doubtful about them.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and optionally [sensitivity]; or the text deck of a
        spring structure, .dat, with its sensitivity parameters.
    method
        auto, adjoint, direct or finite-difference, instead of the file's.
    response
        Name of a response, instead of the file's choice; of a deck a measure such as n4.ux, its
        compliance by default; repeatable.
    wrt
        Name of a parameter, instead of the file's choice; repeatable.
    certificate
        Check every derivative by all methods and a Taylor test; takes about twenty runs per
        parameter. Exit code 1 where it does not pass.
    output
        Folder to write the table (.sensitivity.csv) and the tornado chart (.sensitivity.png) to;
        none are written by default.
    plot
        Write the tornado chart, without --output to this folder.
    svg
        Write the chart as .svg instead of .png.
    """
    from dalembert.cli.gradient_task import gradient_task
    from dalembert.cli.gradient_text import document, show
    from dalembert.sensitivity.gradient import sensitivity as gradient_of

    task = gradient_task(model, settings, response, wrt, method)
    folder = output_folder(output) if output or plot or svg else None
    result = task.run(not as_json and sys.stderr.isatty())
    if result.status.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    gradient = gradient_of(result, task.responses, task.wrt, task.method, certificate)
    kind = "svg" if svg else "png"
    files = _write(gradient, folder / model.stem, kind, output is not None) if folder else []
    passed = not certificate or gradient.attrs["certificate"].passed
    code = DONE if passed else FAILED
    if as_json:
        made = {"ok": passed, "name": task.name, "status": str(result.status)}
        emit(made | document(gradient) | {"files": [str(f) for f in files]})
    else:
        show(task.name, gradient)
        written(files)
    return code


def _write(gradient: xr.DataArray, base: Path, kind: str, table: bool) -> list[Path]:
    import matplotlib as mpl

    from dalembert.files import atomic_path
    from dalembert.results.pictures.influence import gradient_table
    from dalembert.results.pictures.tornado import save_tornado

    mpl.use("Agg")
    files = []
    if table:
        files.append(base.with_name(f"{base.name}.sensitivity.csv"))
        with atomic_path(files[0]) as temporary:
            gradient_table(gradient).to_csv(temporary, index=False)
    return [*files, save_tornado(gradient, base.with_name(f"{base.name}.sensitivity.{kind}"))]
