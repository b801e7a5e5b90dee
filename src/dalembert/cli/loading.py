"""From the arguments of a command to a model."""

from __future__ import annotations

import sys
import tempfile
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import wrong_input
from dalembert.cli.teller import Teller
from dalembert.errors import AssemblyError, FileError, ModelError
from dalembert.text.wording import visible

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


@contextmanager
def shown_warnings() -> Iterator[None]:
    """Warnings inside go to standard error, unless it ends in an error."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)
        yield
    for warning in caught:
        print(f"Warning: {visible(str(warning.message))}", file=sys.stderr)


def loaded(
    path: Path, settings: list[str] | None, pages: Path | None = None
) -> tuple[ModelFile, Any]:
    """The file, with the values of ``--set``, and its assembled model.

    Parameters
    ----------
    pages : folder for the drawing of a mechanism that cannot be assembled, if wanted

    Raises
    ------
    WrongInput
        Anything wrong with the file, the mechanism or the settings.
    """
    from dalembert.io.model_file import load_model_file

    with wrong_input():
        if is_deck(path):
            raise FileError(
                f"{path}: is the deck of a spring structure, which only 'dalembert run' and "
                "'dalembert sensitivity' read; this command takes a model file, .toml or .json"
            )
        file = load_model_file(path).with_parameters(pairs(settings))
        with failure_drawn(path, pages):
            return file, file.model()


@contextmanager
def failure_drawn(path: Path, pages: Path | None) -> Iterator[None]:
    """Where a mechanism cannot be assembled, a page shows why; its path joins the message."""
    try:
        yield
    except AssemblyError as error:
        if pages is None or error.position is None:
            raise
        from dalembert.results.files.open_mechanism import assembly_report

        page = assembly_report(error, output_folder(pages) / f"{path.stem}.assembly.html")
        raise error.with_message(f"{error}; drawn in {page}") from None


def teller_of(model: Any) -> Teller:
    """What the commands write and tell of a mechanism, or of a structure."""
    from dalembert.cli.mechanisms import MechanismTeller
    from dalembert.cli.structures import StructureTeller
    from dalembert.structures.model import StructuralModel

    kind = StructureTeller if isinstance(model, StructuralModel) else MechanismTeller
    return kind(model)


def is_deck(path: Path) -> bool:
    """Whether the name is that of a text deck."""
    return path.suffix.lower() in (".dat", ".deck")


def pairs(settings: list[str] | None) -> dict[str, str]:
    """Name → text of the values given by ``--set``."""
    made = {}
    for setting in settings or []:
        name, equals, value = setting.partition("=")
        if not (equals and name.strip() and value.strip()):
            raise ModelError("write --set name=value, e.g. --set l1=0.25", f"--set {setting[:60]}")
        made[name.strip()] = value.strip()
    return made


def refuse_replacing(source: Path, files: Iterable[Path]) -> None:
    """What is read is not written over.

    Raises
    ------
    FileError
        One of the files is the source.
    """
    for path in files:
        if path.exists() and path.samefile(source):
            raise FileError(f"{path}: is what was read, and would be replaced; give another name")


def output_folder(folder: Path | None) -> Path:
    """The folder for results; made if missing, tried before anything is computed.

    Raises
    ------
    WrongInput
        It cannot be written.
    """
    folder = folder or Path()
    with wrong_input():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                pass
        except (OSError, ValueError) as error:  # ValueError: a name with a null character
            reason = getattr(error, "strerror", None) or error
            raise FileError(
                f"{folder}: cannot be written ({reason}); choose another folder with --output"
            ) from None
    return folder
