"""What ``dalembert sensitivity`` computes: the run of a file or deck, responses, parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from dalembert.cli.console import wrong_input
from dalembert.cli.deck import solved_deck
from dalembert.cli.loading import is_deck, loaded
from dalembert.errors import ExpressionError, UnsupportedError
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.text.wording import unknown

Texts = list[str] | None


@dataclass(frozen=True)
class GradientTask:
    """A run to make, and what to differentiate by what.

    Attributes
    ----------
    name : of the system
    run : makes the result; True shows its progress
    responses, wrt : which derivatives
    method : name
    """

    name: str
    run: Callable[[bool], Result]
    responses: list[Response]
    wrt: list[str]
    method: str


def gradient_task(
    path: Path,
    settings: Texts,
    responses: Texts,
    wrt: Texts,
    method: str | None,
) -> GradientTask:
    """The task of a model file or deck, with what the options replace.

    Raises
    ------
    WrongInput
        Anything wrong with the file, unknown names, an unknown method.
    """
    if method is not None:
        with wrong_input():
            method = _method(method)
    make = _of_deck if is_deck(path) else _of_file
    return make(path, settings, responses, wrt, method)


def _of_file(
    path: Path, settings: Texts, responses: Texts, wrt: Texts, method: str | None
) -> GradientTask:
    from dalembert.io.analyses import make_analysis
    from dalembert.io.decisions.tasks import make_gradient, make_responses

    file, built = loaded(path, settings)
    with wrong_input():
        analysis = make_analysis(file, built)
        if responses:
            made = make_responses(file, built)
            found = {name: made[_known("--response", name, made)] for name in responses}
            parameters = list(built.parameters)
        else:
            found, parameters = make_gradient(file, built)
        chosen = _parameters(wrt, built.parameters) or parameters

    def run(progress: bool) -> Result:
        with file.located("analysis"):
            return analysis.run(built, progress=progress)

    how = method or file.document.sensitivity.method
    return GradientTask(file.name, run, list(found.values()), chosen, how)


def _of_deck(
    path: Path, settings: Texts, responses: Texts, wrt: Texts, method: str | None
) -> GradientTask:
    """Measures of the structure; its compliance where none are named."""
    from dalembert.responses.values import final

    result = solved_deck(path, settings)
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
    listed: list[Response] = [final(name, name) for name in dict.fromkeys(names)]
    return GradientTask(result.model.name, lambda _: result, listed, chosen, method or "auto")


def _parameters(wrt: Sequence[str] | None, known: Iterable[str]) -> list[str]:
    return [_known("--wrt", name, known) for name in wrt or []]


def _known(option: str, name: str, known: Iterable[str]) -> str:
    names = list(known)
    if name not in names:
        raise UnsupportedError(unknown(option, name, names))
    return name


def _method(name: str) -> str:
    from dalembert.sensitivity.methods import METHODS

    return _known("--method", name, METHODS)
