"""``dalembert sensitivity``: gradients of the responses of a model file."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    FAILED,
    AsJson,
    Settings,
    print_files,
    print_json,
    wrong_input,
)
from dalembert.cli.deck import solve_deck
from dalembert.cli.loading import is_deck, load_model, output_folder
from dalembert.errors import ExpressionError, UnsupportedError
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.text.wording import unknown

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

    The output also contains relative derivatives, percent of the response per percent of the
    parameter, and notes on their accuracy.

    Parameters
    ----------
    model
        Model file with [analysis], [responses] and optionally [sensitivity]; or the text deck of a
        spring structure, .dat, with its sensitivity parameters.
    method
        auto, adjoint, direct or finite-difference, instead of the file's.
    response
        Name of a response, instead of the file's choice; for a deck a measure such as n4.ux, by
        default its compliance; repeatable.
    wrt
        Name of a parameter, instead of the file's choice; repeatable.
    certificate
        Check every derivative by all methods and a Taylor test; needs about twenty runs per
        parameter. Exit code 1 if the check fails.
    output
        Folder to write the table (.sensitivity.csv) and the tornado chart (.sensitivity.png) to;
        none are written by default.
    plot
        Write the tornado chart; without --output, to the current folder.
    svg
        Write the chart as .svg instead of .png.
    """
    from dalembert.cli.gradient_text import document, show
    from dalembert.sensitivity.gradient import sensitivity as compute_gradient

    task = _gradient_task(model, settings, response, wrt, method)
    folder = output_folder(output) if output or plot or svg else None
    result = task.run(not as_json and sys.stderr.isatty())
    if result.status.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    gradient = compute_gradient(result, task.responses, task.wrt, task.method, certificate)
    kind = "svg" if svg else "png"
    files = _write(gradient, folder / model.stem, kind, output is not None) if folder else []
    passed = not certificate or gradient.attrs["certificate"].passed
    code = DONE if passed else FAILED
    if as_json:
        summary = {"ok": passed, "name": task.name, "status": str(result.status)}
        print_json(summary | document(gradient) | {"files": [str(f) for f in files]})
    else:
        show(task.name, gradient)
        print_files(files)
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


Texts = list[str] | None


@dataclass(frozen=True)
class _GradientTask:
    """A run with the responses to differentiate and the parameters.

    Attributes
    ----------
    name : name of the system
    run : returns the result; True shows progress
    responses, wrt : responses to differentiate, and names of the parameters
    method : name of the sensitivity method
    """

    name: str
    run: Callable[[bool], Result]
    responses: list[Response]
    wrt: list[str]
    method: str


def _gradient_task(
    path: Path,
    settings: Texts,
    responses: Texts,
    wrt: Texts,
    method: str | None,
) -> _GradientTask:
    """The task of a model file or deck, with the replacements given by options.

    Raises
    ------
    WrongInput
        The file is invalid, or a name or the method is unknown.
    """
    if method is not None:
        with wrong_input():
            method = _method(method)
    make = _deck_task if is_deck(path) else _file_task
    return make(path, settings, responses, wrt, method)


def _file_task(
    path: Path, settings: Texts, responses: Texts, wrt: Texts, method: str | None
) -> _GradientTask:
    from dalembert.io.analyses import make_analysis
    from dalembert.io.decisions.tasks import make_gradient, make_responses

    file, built = load_model(path, settings)
    with wrong_input():
        analysis = make_analysis(file, built)
        if responses:
            declared = make_responses(file, built)
            selected = {
                name: declared[_checked_name("--response", name, declared)] for name in responses
            }
            parameters = list(built.parameters)
        else:
            selected, parameters = make_gradient(file, built)
        chosen_parameters = _parameters(wrt, built.parameters) or parameters

    def run(progress: bool) -> Result:
        with file.located("analysis"):
            return analysis.run(built, progress=progress)

    chosen_method = method or file.document.sensitivity.method
    return _GradientTask(file.name, run, list(selected.values()), chosen_parameters, chosen_method)


def _deck_task(
    path: Path, settings: Texts, responses: Texts, wrt: Texts, method: str | None
) -> _GradientTask:
    """Measures of the structure; its compliance by default."""
    from dalembert.responses.values import final

    result = solve_deck(path, settings)
    with wrong_input():
        if not result.model.parameters:
            raise UnsupportedError(
                f"{path}: has no sensitivity parameters; add their count and lines such as "
                "'spring', 1, 2.0 at its end"
            )
        names = responses or ["compliance"]
        for name in names:
            try:
                result.expression(name)
            except ExpressionError as error:
                raise UnsupportedError(f"--response {name!r}: {error}") from None
        chosen = _parameters(wrt, result.model.parameters) or list(result.model.parameters)
    measures: list[Response] = [final(name, name) for name in dict.fromkeys(names)]
    return _GradientTask(result.model.name, lambda _: result, measures, chosen, method or "auto")


def _parameters(wrt: Sequence[str] | None, available: Iterable[str]) -> list[str]:
    return [_checked_name("--wrt", name, available) for name in wrt or []]


def _checked_name(option: str, name: str, available: Iterable[str]) -> str:
    names = list(available)
    if name not in names:
        raise UnsupportedError(unknown(option, name, names))
    return name


def _method(name: str) -> str:
    from dalembert.sensitivity.methods import METHODS

    return _checked_name("--method", name, METHODS)
