"""A model file: read, checked, and turned into what Python users write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from dalembert.elements.registry import SPACES
from dalembert.errors import ModelError
from dalembert.io.builder import Builder
from dalembert.io.location import Located
from dalembert.io.messages import explain, place
from dalembert.io.reading import read_document
from dalembert.io.schema import Document, ParameterTable, document_of
from dalembert.io.structures.builder import StructureBuilder
from dalembert.io.structures.schema import StructureDocument
from dalembert.io.values import in_own_unit, shown
from dalembert.model.model import Model
from dalembert.model.system import ELEMENT_MEANINGS, System
from dalembert.structures.model import StructuralModel
from dalembert.structures.structure import Structure
from dalembert.symbolic.formulas.declared import CONSTANTS, VARIABLES, check_free
from dalembert.text.wording import nearest, visible

BUILDERS: dict[str, Any] = {"mechanism": Builder, "structure": StructureBuilder}
"""Value of ``kind`` in a file → what makes its contents."""

VALUES = ("parameters", "derived", "tables", "histories")
"""Sections whose entries stand in formulas by their names alone."""


@dataclass(frozen=True)
class ModelFile:
    """A checked model file.

    Attributes
    ----------
    path : Path
    document : what it holds: Document of a mechanism, StructureDocument
    """

    path: Path
    document: Document | StructureDocument

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.document.name or visible(self.path.stem)

    @property
    def located(self) -> Located:
        """Tells errors with this file and the place in it."""
        return Located(self.path, self.document)

    def build(self) -> System | Structure:
        """The system or structure, ready to be changed or built.

        Raises
        ------
        ModelError, FileError
            With file, place, value and cure.
        """
        return BUILDERS[self.document.kind](self.document, self.path).build()

    def model(self) -> Model | StructuralModel:
        """The assembled model.

        Raises
        ------
        ModelError, AssemblyError
            As ``build``, and what only shows when the model is put together.
        """
        system = self.build()
        with self.located():
            return system.build()

    def with_parameters(self, values: Mapping[str, float | str]) -> ModelFile:
        """The same file with other values of some parameters.

        Raises
        ------
        ModelError
            Unknown parameter, or not a number.
        """
        known: dict[str, Any] = self.document.parameters
        changed = dict(known)
        for name, value in values.items():
            if name not in known:
                listed = ", ".join(known) or "none"
                raise ModelError(
                    f"unknown parameter{nearest(name, known)}; the file has: {listed}",
                    f"{self.path}: {place('parameters', name)}",
                )
            try:
                number = in_own_unit(value)
            except ValueError as error:
                raise self.located.error(str(error), "parameters", name) from None
            old = known[name]
            new = {"value": number}
            changed[name] = (
                old.model_copy(update=new) if isinstance(old, ParameterTable) else number
            )
        return replace(self, document=self.document.model_copy(update={"parameters": changed}))


def load_model_file(path: str | Path) -> ModelFile:
    """Read and check a model file, TOML or JSON.

    Raises
    ------
    FileError
        The file cannot be read, or is not TOML or JSON.
    ModelError
        Its contents are not a model; names every place that is wrong.
    """
    path = Path(path)
    data = read_document(path)
    schema = _schema(data, path)
    try:
        document = schema.model_validate(data)
    except ValidationError as error:
        told = explain(error, data, path)
        raise ModelError(told.message + _other_dimension(data, schema), told.entity) from None
    _check_names(document, path)
    return ModelFile(path, document)


def _other_dimension(data: dict[str, Any], schema: type) -> str:
    """The cure for a file that does not say its dimension and fits another one."""
    if "dimension" in data or not issubclass(schema, Document):
        return ""
    for dimension in SPACES:
        try:
            document_of(dimension).model_validate(data)
        except ValidationError:
            continue
        return f"\n  as dimension = {dimension} it can be read; write that if it is meant"
    return ""


def _schema(data: dict[str, Any], path: Path) -> type[Document] | type[StructureDocument]:
    """What a file with this ``kind`` and this ``dimension`` may hold."""
    kind = data.get("kind", "mechanism")
    if not isinstance(kind, str) or kind not in BUILDERS:
        known, close = ", ".join(BUILDERS), nearest(kind, BUILDERS)
        raise ModelError(f"unknown kind {shown(kind)}{close}; known: {known}", f"{path}: kind")
    elastic = {"nodes", "elements", "meshes"} & set(data)
    if "kind" not in data and elastic and not {"bodies", "joints"} & set(data):
        raise ModelError('nodes and elements make a structure; add kind = "structure"', str(path))
    if kind == "structure":
        return StructureDocument
    gravity = data.get("gravity")
    spoken = len(gravity) if isinstance(gravity, list) and len(gravity) in SPACES else 2
    dimension = data.get("dimension", spoken)
    if isinstance(dimension, bool) or dimension not in SPACES:
        known = ", ".join(map(str, SPACES))
        told = f"unknown dimension {shown(dimension)}; known: {known}"
        raise ModelError(told, f"{path}: dimension")
    return document_of(dimension)


def load_model(path: str | Path) -> System | Structure:
    """Read a mechanism or structure from a TOML or JSON model file; ``build()`` it to analyse it.

    Parameters
    ----------
    path : of the file

    Raises
    ------
    FileError, ModelError
        With file, place, value and cure.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import dalembert as da
    >>> text = '''
    ... format = 1
    ... name = "stone"
    ... gravity = [0.0, -9.81]
    ... [bodies.stone]
    ... type = "Particle"
    ... mass = 2.0
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "stone.toml")
    ...     written = path.write_text(text)
    ...     model = da.load_model(path).build()
    >>> model.diagnosis.degrees_of_freedom
    2
    """
    return load_model_file(path).build()


def _check_names(document: Document | StructureDocument, path: Path) -> None:
    """Values that stand in formulas by themselves have different names, and so have parts."""
    of_structure = isinstance(document, StructureDocument)
    meanings = CONSTANTS if of_structure else VARIABLES
    seen: dict[tuple[bool, str], str] = {}
    for section in document.sections:
        alone = section in VALUES
        taken = meanings if alone else {} if of_structure else ELEMENT_MEANINGS
        for name in getattr(document, section):
            here = f"{path}: {place(section, name)}"
            check_free(name, taken, here, "formulas" if alone else "mechanisms")
            before = seen.setdefault((alone, name), section)
            if before != section:
                raise ModelError(
                    f"the name is already used by {place(before, name)}; choose another", here
                )
