"""Model files: reading, validation and construction of models."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from dalembert.elements.registry import SPACES
from dalembert.errors import ModelError
from dalembert.io.builder import Builder
from dalembert.io.choices import Record
from dalembert.io.documents import Document, StructureDocument, document_of
from dalembert.io.location import Located
from dalembert.io.messages import explain, key_path
from dalembert.io.reading import read_document, with_present_names
from dalembert.io.schema import ModelDocument
from dalembert.io.values import in_own_unit, short_repr
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.model.system import System
from dalembert.remedies import Advice, Insert, remedies_in
from dalembert.symbolic.formulas.declared import check_free
from dalembert.symbolic.formulas.inputs import is_formula
from dalembert.text.wording import misspelt, visible

KINDS = ("mechanism", "structure")
"""Values of ``kind`` in a file."""

VALUE_SECTIONS = ("parameters", "derived", "inputs", "outputs", "tables", "histories")
"""Sections whose entries are referred to in formulas by their bare names."""


@dataclass(frozen=True)
class ModelFile:
    """A checked model file.

    Attributes
    ----------
    path : Path
    document : validated contents
    """

    path: Path
    document: Document | StructureDocument

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.document.name or visible(self.path.stem)

    @property
    def located(self) -> Located:
        """Context manager that adds this file and the location to errors."""
        return Located(self.path, self.document)

    def build(self) -> System:
        """The system or structure, ready to be changed or built.

        Raises
        ------
        ModelError, FileError
            Names file, location, value and a fix.
        """
        return Builder(self.document, self.path).build()

    def model(self) -> Model | StructuralModel:
        """The assembled model.

        Raises
        ------
        ModelError, AssemblyError
            As ``build``, and errors of the assembly.
        """
        system = self.build()
        with self.located():
            return system.build()

    def with_parameters(self, values: Mapping[str, float | str]) -> ModelFile:
        """The same file with other values of some parameters and inputs.

        Raises
        ------
        ModelError
            Unknown parameter, or not a number.
        """
        sections: dict[str, dict[str, Any]] = {
            name: dict(getattr(self.document, name)) for name in ("parameters", "inputs")
        }
        known = {name: section for section, entries in sections.items() for name in entries}
        for name, value in values.items():
            if name not in known:
                listed = ", ".join(known) or "none"
                raise ModelError(
                    misspelt("unknown parameter", name, known, f"; the file has: {listed}", True),
                    f"{self.path}: {key_path('parameters', name)}",
                )
            entries = sections[known[name]]
            try:
                number = in_own_unit(value)
            except ValueError as error:
                raise self.located.error(str(error), known[name], name) from None
            old = entries[name]
            formula = getattr(old, "value", old)
            if known[name] == "inputs" and is_formula(formula):
                text = f"is the formula {formula!r}; change the formula in the file"
                raise self.located.error(text, "inputs", name)
            entries[name] = (
                old.model_copy(update={"value": number}) if isinstance(old, Record) else number
            )
        return replace(self, document=self.document.model_copy(update=sections))


def load_model_file(path: str | Path) -> ModelFile:
    """Read and check a model file, TOML or JSON.

    Raises
    ------
    FileError
        The file cannot be read, or is not TOML or JSON.
    ModelError
        Invalid contents; names all invalid locations.
    """
    path = Path(path)
    return check_model_data(read_document(path), path)


def check_model_data(data: dict[str, Any], path: Path) -> ModelFile:
    """The checked model file of plain data.

    Parameters
    ----------
    data : sections of the file
    path : of the file, for messages and relative paths

    Raises
    ------
    ModelError
        Invalid contents; names all invalid locations.
    """
    data = with_present_names(data)
    schema = _document_type(data, path)
    try:
        document = schema.model_validate(data)
    except ValidationError as error:
        explained = explain(error, data, path)
        raise ModelError(
            _with_dimension(explained.message, data, schema), explained.entity
        ) from None
    _check_names(document, path)
    return ModelFile(path, document)


def _with_dimension(message: str, data: dict[str, Any], schema: type) -> str:
    """A message with a hint for a file without a dimension that is valid with another one."""
    if "dimension" in data or not issubclass(schema, Document):
        return message
    for dimension in SPACES:
        try:
            document_of(dimension).model_validate(data)
        except ValidationError:
            continue
        hint = f"\n  as dimension = {dimension} it is valid; write that if it is intended"
        insert = Insert(key="dimension", value=dimension)
        return Advice(message + hint, [*remedies_in(message), insert])
    return message


def _document_type(data: dict[str, Any], path: Path) -> type[Document] | type[StructureDocument]:
    """Document type for the ``kind`` and ``dimension`` of a file."""
    kind = data.get("kind", "mechanism")
    if not isinstance(kind, str) or kind not in KINDS:
        known = f"; known: {', '.join(KINDS)}"
        message = misspelt(f"unknown kind {short_repr(kind)}", kind, KINDS, known)
        raise ModelError(message, f"{path}: kind")
    elastic = {"nodes", "elements", "meshes"} & set(data)
    moving = {"bodies", "beams", "joints", "drivers", "forces"} & set(data)
    if "kind" not in data and elastic and not moving:
        text = 'nodes and elements make a structure; add kind = "structure"'
        raise ModelError(Advice(text, [Insert(key="kind", value="structure")]), str(path))
    if kind == "structure":
        return StructureDocument
    gravity: Any = data.get("gravity")
    tables = isinstance(gravity, list) and any(isinstance(entry, dict) for entry in gravity)
    is_vector = isinstance(gravity, list) and len(gravity) in SPACES and not tables
    implied = len(gravity) if is_vector else 2
    dimension = data.get("dimension", implied)
    if isinstance(dimension, (bool, list, dict)) or dimension not in SPACES:
        kinds = ", ".join(map(str, SPACES))
        message = f"unknown dimension {short_repr(dimension)}; known: {kinds}"
        raise ModelError(message, f"{path}: dimension")
    return document_of(dimension)


def with_keys(file: ModelFile, section: str, changes: Mapping[str, Any]) -> ModelFile:
    """The same file with some keys of a section replaced; a missing section is added.

    Parameters
    ----------
    changes : key → value; None keeps the key, an empty text removes it

    Raises
    ------
    ModelError
        An invalid value.
    """
    values = {key: value for key, value in changes.items() if value is not None}
    if not values:
        return file
    document: Any = file.document
    table = getattr(document, section)
    kind = type(document).model_fields[section].annotation
    keys = {} if table is None else {k: getattr(table, k) for k in table.model_fields_set}
    keys = {k: v for k, v in (keys | values).items() if v != ""}
    try:
        section_table = _table_type(kind).model_validate(keys)
    except ValidationError as error:
        explained = explain(error, keys, file.path)
        raise file.located.error(explained.message, section) from None
    document = document.model_copy(update={section: section_table})
    document.__pydantic_fields_set__.add(section)
    return replace(file, document=document)


def _table_type(kind: Any) -> type[BaseModel]:
    types = [k for k in get_args(kind) if isinstance(k, type)] or [kind]
    return types[0]  # type: ignore[no-any-return]


def load_model(path: str | Path) -> System:
    """Read a mechanism or structure from a TOML or JSON model file; ``build()`` it to analyse it.

    Parameters
    ----------
    path : of the file

    Raises
    ------
    FileError, ModelError
        Names file, location, value and a fix.

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


def _check_names(document: ModelDocument, path: Path) -> None:
    """Refuse duplicate and reserved names, separately for values and for parts."""
    seen: dict[tuple[bool, str], str] = {}
    for section in document.sections:
        is_value = section in VALUE_SECTIONS
        reserved = document.builder.meanings if is_value else document.builder.reserved
        for name in getattr(document, section):
            location = f"{path}: {key_path(section, name)}"
            check_free(name, reserved, location, "formulas" if is_value else "mechanisms")
            first_section = seen.setdefault((is_value, name), section)
            if first_section != section:
                raise ModelError(
                    f"the name is already used by {key_path(first_section, name)}; choose another",
                    location,
                )
