"""What all commands of decisions share: the file, the run, what is written, how it ends."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    FAILED,
    INTERRUPTED,
    AsJson,
    Quiet,
    Settings,
    emit,
    tell,
    written,
    wrong_input,
)
from dalembert.cli.loading import is_deck, loaded, output_folder, pairs
from dalembert.errors import FileError
from dalembert.interrupts import ctrl_c, defer_ctrl_c

if TYPE_CHECKING:
    from dalembert.design.decision import Decision
    from dalembert.io.model_file import ModelFile

Run = Callable[[bool], "Decision"]
"""Does the task; true shows how far it is."""


@dataclass(frozen=True)
class Common:
    """Options that all commands of decisions share."""

    settings: Settings | None = None
    quiet: Annotated[Quiet, Parameter(help="Do not show how far it is.")] = False
    as_json: AsJson = False


Options = Annotated[Common, Parameter(name="*")]
PLAIN = Common()
"""Where none of them is given."""


@dataclass(frozen=True)
class Asked:
    """What every command of a decision is given.

    Attributes
    ----------
    path : the model file
    output : folder for the results; none are written without
    options : ``--set``, and what is told
    """

    path: Path
    output: Path | None
    options: Common

    def decide(
        self,
        read: Callable[[ModelFile, Any], Run],
        show: Callable[[dict[str, Any]], None],
        assembled: bool = True,
        write: Callable[[Any], list[Path]] | None = None,
    ) -> int:
        """Read the file, do the task, write and tell what was found; returns the exit code.

        Parameters
        ----------
        read : ``(file, model) →`` what does the task; errors in it are those of the input
        show : prints the numbers found
        assembled : whether the task is on the file's model
        write : writes what was found; by default data, numbers and page into ``output``
        """
        file, model = (
            loaded(self.path, self.options.settings) if assembled else (self._read(), None)
        )
        with wrong_input():
            run, first_view = read(file, model), self._first_view(file, model)
        folder = output_folder(self.output) if self.output and write is None else None
        with ctrl_c(is_command=True) as signals:  # what there is by then is written
            found = run(not (self.options.quiet or self.options.as_json))
            defer_ctrl_c()
            files = [] if write is None else write(found)
            if folder is not None:
                files = found.write(folder / file.path.stem, **first_view)
            interrupted = found.interrupted or signals.pressed
            made = {"name": file.name, **found.summary(), "files": [str(f) for f in files]}
            made["interrupted"] = interrupted
            if self.options.as_json:
                emit(made)
            else:
                self._tell(file.name, found, interrupted)
                for text in made["warnings"]:
                    tell(f"  warning: {text}", "yellow")
                show(made)
                written(files)
            if interrupted or signals.pressed:
                return INTERRUPTED
            return DONE if found.ok else FAILED

    @staticmethod
    def _tell(name: str, found: Decision, interrupted: bool) -> None:
        late = interrupted and "interrupted" not in found.sentence
        note = "; interrupted" if late else ""
        tell(f"{name}: {found.sentence}{note}", "green" if found.ok else "red")

    def _read(self) -> ModelFile:
        from dalembert.io.model_file import load_model_file

        with wrong_input():
            if is_deck(self.path):
                raise FileError(f"{self.path}: is a deck; this command takes a model file")
            return load_model_file(self.path).with_parameters(pairs(self.options.settings))

    @staticmethod
    def _first_view(file: ModelFile, model: Any) -> dict[str, Any]:
        from dalembert.io.decisions.tasks import report_choices

        return {} if model is None else report_choices(file, model)


def iterations(show: bool) -> Callable[[int, float], None] | bool:
    """Prints each iteration of a search on standard error, or nothing."""
    if not show:
        return False

    def told(number: int, value: float) -> None:
        print(f"iteration {number}: {value:.8g}", file=sys.stderr)

    return told
