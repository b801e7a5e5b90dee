"""Contents of an imported file: sections of a model file, and what could not be converted."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dalembert.files import atomic_path
from dalembert.io.imports.toml_text import toml_text
from dalembert.io.model_file import ModelFile, check_model_data
from dalembert.io.omission import Omission
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.model.system import System


@dataclass(frozen=True)
class Imported:
    """Model of an imported file.

    Attributes
    ----------
    source : the imported file
    document : sections of a model file as plain data; other files as absolute ``Path``
    omissions : parts of the file that the model does not contain
    comments : dotted key of the document, such as ``"bodies.arm"`` → comment above it; the empty
        key is the heading of the file
    names : name of a joint in the imported file → its name in the document

    Examples
    --------
    >>> from pathlib import Path
    >>> from dalembert.io.imports.imported import Imported
    >>> stone = {"type": "Particle", "mass": 2.0}
    >>> document = {"format": 1, "dimension": 3, "bodies": {"stone": stone}}
    >>> imported = Imported(Path("stone.urdf"), document)
    >>> imported.build().diagnosis.degrees_of_freedom
    3
    >>> print(imported.text.partition("bodies")[2])
    .stone]
    type = "Particle"
    mass = 2.0
    <BLANKLINE>
    """

    source: Path
    document: dict[str, Any]
    omissions: list[Omission] = field(default_factory=list)
    comments: Mapping[str, str] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The model file as TOML; other files are relative to the folder of the source."""
        return self._text(self.source.parent)

    def _text(self, folder: Path) -> str:
        return toml_text(_with_paths(self.document, folder.resolve()), self.comments)

    def write(self, path: str | Path) -> Path:
        """Write the model file (TOML); other files are relative to its folder.

        Raises
        ------
        FileError
            The file cannot be written.
        """
        target = Path(path)
        text = self._text(target.parent)
        with atomic_path(target) as temporary:
            temporary.write_text(text, encoding="utf-8")
        return target

    def model_file(self) -> ModelFile:
        """The checked model file.

        Raises
        ------
        ModelError
            Invalid contents; names the source and the location.
        """
        folder = self.source.parent.resolve()
        return check_model_data(_with_paths(self.document, folder), self.source)

    def system(self) -> System:
        """The system, ready to be changed or built."""
        return self.model_file().build()

    def build(self) -> Model | StructuralModel:
        """The assembled model."""
        return self.model_file().model()


def _with_paths(entry: Any, folder: Path) -> Any:
    """The document with texts, relative to a folder where possible, for paths."""
    if isinstance(entry, dict):
        return {key: _with_paths(value, folder) for key, value in entry.items()}
    if isinstance(entry, list):
        return [_with_paths(value, folder) for value in entry]
    if not isinstance(entry, Path):
        return entry
    try:
        return Path(os.path.relpath(entry, folder)).as_posix()
    except ValueError:  # another drive
        return entry.as_posix()
