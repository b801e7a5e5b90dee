"""Common sequence of all design commands: read the file, run the task, write files, report."""

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
    print_files,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.loading import is_deck, load_model, output_folder, parse_settings
from dalembert.errors import FileError
from dalembert.interrupts import ctrl_c, defer_ctrl_c

if TYPE_CHECKING:
    from dalembert.design.decision import Decision
    from dalembert.io.model_file import ModelFile

Run = Callable[[bool], "Decision"]
"""Runs the task; the argument enables progress output."""


@dataclass(frozen=True)
class CommonOptions:
    """Options of all design commands."""

    settings: Settings | None = None
    quiet: Annotated[Quiet, Parameter(help="Do not show progress.")] = False
    as_json: AsJson = False


Options = Annotated[CommonOptions, Parameter(name="*")]
NO_OPTIONS = CommonOptions()
"""Default options."""


@dataclass(frozen=True)
class DecisionCommand:
    """A design command with its arguments.

    Attributes
    ----------
    path : the model file
    output : folder for the results; None writes no files
    options : ``--set``, and the options of the output
    """

    path: Path
    output: Path | None
    options: CommonOptions

    def execute(
        self,
        read: Callable[[ModelFile, Any], Run],
        show: Callable[[dict[str, Any]], None],
        assembled: bool = True,
        write: Callable[[Any], list[Path]] | None = None,
    ) -> int:
        """Read the file, run the task, write and print the result; returns the exit code.

        Parameters
        ----------
        read : ``(file, model) →`` function that runs the task; its errors are input errors
        show : prints the summary
        assembled : whether the task needs the model of the file
        write : writes the result; by default data, numbers and page into ``output``
        """
        file, model = (
            load_model(self.path, self.options.settings) if assembled else (self._read(), None)
        )
        with wrong_input():
            run, first_view = read(file, model), self._first_view(file, model)
        folder = output_folder(self.output) if self.output and write is None else None
        with ctrl_c(is_command=True) as signals:  # partial results are written
            decision = run(not (self.options.quiet or self.options.as_json))
            defer_ctrl_c()
            files = [] if write is None else write(decision)
            if folder is not None:
                live = file.document.report.live
                files = decision.write(folder / file.path.stem, live, **first_view)
            interrupted = decision.interrupted or signals.pressed
            summary = {"name": file.name, **decision.summary(), "files": [str(f) for f in files]}
            summary["interrupted"] = interrupted
            if self.options.as_json:
                print_json(summary)
            else:
                self._print_sentence(file.name, decision, interrupted)
                for text in summary["warnings"]:
                    print_line(f"  warning: {text}", "yellow")
                show(summary)
                print_files(files)
            if interrupted or signals.pressed:
                return INTERRUPTED
            return DONE if decision.ok else FAILED

    @staticmethod
    def _print_sentence(name: str, decision: Decision, interrupted: bool) -> None:
        unmentioned = interrupted and "interrupted" not in decision.sentence
        note = "; interrupted" if unmentioned else ""
        print_line(f"{name}: {decision.sentence}{note}", "green" if decision.ok else "red")

    def _read(self) -> ModelFile:
        from dalembert.io.model_file import load_model_file

        with wrong_input():
            if is_deck(self.path):
                raise FileError(f"{self.path}: is a deck; this command takes a model file")
            return load_model_file(self.path).with_parameters(parse_settings(self.options.settings))

    @staticmethod
    def _first_view(file: ModelFile, model: Any) -> dict[str, Any]:
        from dalembert.io.report import report_choices

        return {} if model is None else report_choices(file, model)


def iterations(show: bool) -> Callable[[int, float], None] | bool:
    """Function that prints each iteration on standard error; False without progress output."""
    if not show:
        return False

    def print_iteration(number: int, value: float) -> None:
        print(f"iteration {number}: {value:.8g}", file=sys.stderr)

    return print_iteration
