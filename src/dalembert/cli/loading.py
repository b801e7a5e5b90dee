"""Loading of model files, settings and output folders for the commands."""

from __future__ import annotations

import sys
import tempfile
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import wrong_input
from dalembert.errors import AssemblyError, FileError, ModelError
from dalembert.text.wording import visible

if TYPE_CHECKING:
    from dalembert.cli.model_printer import ModelPrinter
    from dalembert.io.model_file import ModelFile


@contextmanager
def print_warnings() -> Iterator[None]:
    """Print warnings of the block on standard error, unless it raises an error."""
    with warnings.catch_warnings(record=True) as caught_warnings:
        warnings.simplefilter("always", UserWarning)
        yield
    for warning in caught_warnings:
        print(f"Warning: {visible(str(warning.message))}", file=sys.stderr)


def load_model(
    path: Path, settings: list[str] | None, pages: Path | None = None
) -> tuple[ModelFile, Any]:
    """The file with the values of ``--set``, and its assembled model.

    Parameters
    ----------
    pages : folder for the drawing of a mechanism that cannot be assembled; None for no drawing

    Raises
    ------
    WrongInput
        The file, the mechanism or a setting is invalid.
    """
    from dalembert.io.model_file import load_model_file

    with wrong_input():
        if is_deck(path):
            raise FileError(
                f"{path}: is the deck of a spring structure, which only 'dalembert run' and "
                "'dalembert sensitivity' read; this command takes a model file, .toml or .json"
            )
        file = load_model_file(path).with_parameters(parse_settings(settings))
        with draw_assembly_failure(path, pages):
            return file, file.model()


@contextmanager
def draw_assembly_failure(path: Path, pages: Path | None) -> Iterator[None]:
    """Draw a mechanism that cannot be assembled on a page; its path is appended to the message."""
    try:
        yield
    except AssemblyError as error:
        if pages is None or error.position is None:
            raise
        from dalembert.results.files.assembly_report import assembly_report

        page = assembly_report(error, output_folder(pages) / f"{path.stem}.assembly.html")
        raise error.with_message(f"{error}; drawn in {page}") from None


def model_printer(model: Any) -> ModelPrinter[Any]:
    """The printer of a mechanism or a structure."""
    from dalembert.cli.model_printer import MechanismPrinter, StructurePrinter
    from dalembert.model.assembled.model import StructuralModel

    kind = StructurePrinter if isinstance(model, StructuralModel) else MechanismPrinter
    return kind(model)


def is_deck(path: Path) -> bool:
    """Whether a file name is that of a text deck."""
    return path.suffix.lower() in (".dat", ".deck")


def parse_settings(settings: list[str] | None) -> dict[str, str]:
    """Parameter → value as text, from ``--set`` options."""
    values = {}
    for setting in settings or []:
        name, equals, value = setting.partition("=")
        if not (equals and name.strip() and value.strip()):
            raise ModelError("write --set name=value, e.g. --set l1=0.25", f"--set {setting[:60]}")
        values[name.strip()] = value.strip()
    return values


def refuse_replacing(source: Path, files: Iterable[Path]) -> None:
    """Prevent a command from overwriting its input.

    Raises
    ------
    FileError
        One of the files is the source.
    """
    for path in files:
        if path.exists() and path.samefile(source):
            raise FileError(f"{path}: is the input file, and would be replaced; give another name")


def output_folder(folder: Path | None) -> Path:
    """The folder for results, created if missing; write access is checked before the run.

    Raises
    ------
    WrongInput
        The folder cannot be written to.
    """
    folder = folder or Path()
    with wrong_input():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                pass
        except (OSError, ValueError) as error:  # ValueError: null character in the name
            reason = getattr(error, "strerror", None) or error
            raise FileError(
                f"{folder}: cannot be written ({reason}); choose another folder with --output"
            ) from None
    return folder
