"""``dalembert sensitivity``: gradients of the responses of a model file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import DONE, AsJson, Settings, console, emit, wrong_input
from dalembert.cli.loading import loaded, output_folder

if TYPE_CHECKING:
    import xarray as xr


def sensitivity(
    model: Path,
    /,
    *,
    method: str | None = None,
    output: Path | None = None,
    settings: Settings | None = None,
    as_json: AsJson = False,
) -> int:
    """Derivatives of the responses of a model file by its parameters.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and optionally [sensitivity].
    method
        auto, adjoint, direct or finite-difference, instead of the file's.
    output
        Folder to write the table to (.sensitivity.csv); none is written by default.
    settings
        New value of a parameter, name=value; repeatable.
    as_json
        Print one JSON document instead of text.
    """
    from dalembert.io.analyses import make_analysis
    from dalembert.io.tasks import make_gradient
    from dalembert.responses.base import evaluate
    from dalembert.sensitivity.gradient import sensitivity as gradient_of

    file, built = loaded(model, settings)
    with wrong_input():
        task = make_analysis(file, built)
        responses, wrt = make_gradient(file, built)
        chosen = _method(method or file.document.sensitivity.method)
    folder = output_folder(output) if output else None
    with file.located("analysis"):
        motion = task.run(built, progress=not as_json and sys.stderr.isatty())
    gradient = gradient_of(motion, list(responses.values()), wrt, chosen)
    values = {name: evaluate(motion, response) for name, response in responses.items()}
    files = [_write(gradient, folder / f"{file.path.stem}.sensitivity.csv")] if folder else []
    if as_json:
        emit(_document(gradient, values, motion.status, files))
    else:
        _print(file.name, gradient, values, files)
    return DONE


def _method(name: str) -> str:
    from dalembert.errors import UnsupportedError
    from dalembert.io.messages import nearest
    from dalembert.sensitivity.methods import METHODS

    if name not in METHODS:
        known = ", ".join(METHODS)
        raise UnsupportedError(
            f"--method {name!r} is unknown{nearest(name, METHODS)}; known: {known}"
        )
    return name


def _write(gradient: xr.DataArray, path: Path) -> Path:
    from dalembert.atomic import atomic_path

    with atomic_path(path) as temporary:
        gradient.to_pandas().to_csv(temporary)
    return path


def _document(
    gradient: xr.DataArray, values: dict[str, float], status: Any, files: list[Path]
) -> dict[str, Any]:
    parameters = [str(p) for p in gradient["parameter"].values]
    return {
        "ok": True,
        "status": str(status),
        "method": gradient.attrs.get("method"),
        "responses": {
            name: {
                "value": value,
                "unit": str(gradient["response_unit"].sel(response=name).item()),
                "gradient": dict(
                    zip(parameters, gradient.sel(response=name).values.tolist(), strict=True)
                ),
            }
            for name, value in values.items()
        },
        "files": [str(f) for f in files],
    }


def _print(name: str, gradient: xr.DataArray, values: dict[str, float], files: list[Path]) -> None:
    from rich.table import Table

    table = Table(title=f"{name}: derivatives ({gradient.attrs.get('method', '')})")
    for heading in ("response", "value", *(f"d/d {p}" for p in gradient["parameter"].values)):
        table.add_column(str(heading), justify="left" if heading == "response" else "right")
    for label, value in values.items():
        unit = str(gradient["response_unit"].sel(response=label).item())
        row = [f"{x:.6g}" for x in gradient.sel(response=label).values]
        table.add_row(label, f"{value:.6g} {unit}", *row)
    console().print(table)
    for path in files:
        console().print(f"  written {path}", markup=False)
