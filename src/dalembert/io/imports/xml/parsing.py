"""Parsing of XML files with line numbers, without entities and document types.

The parser is expat of the standard library. Declarations of entities, by which small files grow
without limit or contain other files, are refused before they are expanded; parsers that build
trees do not report lines.
"""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

from dalembert.budget import check_budget
from dalembert.errors import FileError
from dalembert.files import readable
from dalembert.io.imports.xml.element import XmlElement
from dalembert.text.wording import visible

WEIGHT = 60
"""Memory per byte of an XML file [bytes]."""
PER_ELEMENT = 2
"""Estimated cost of an element, in the rounds of the budget."""
MAX_DEPTH = 250
"""Upper limit of nested elements."""
DRAWINGS = "-//W3C//DTD SVG "
"""Start of the public identifiers of document types that drawing programs write."""


def read_xml(path: Path) -> XmlElement:
    """The root element of a file.

    Raises
    ------
    FileError
        Unreadable, not XML, nested too deeply, or with a document type or entities.
    BudgetError
        Too large.
    """
    size = readable(path, WEIGHT)
    try:
        with path.open("rb") as stream:
            data = stream.read(size)
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({error.strerror or error})") from None
    if not data.strip():
        raise FileError(f"{path}: the file is empty")
    return parse_xml(path, data)


def parse_xml(path: Path, data: bytes) -> XmlElement:
    """The root element of the contents of a file."""
    reader = _Reader(path)
    try:
        reader.parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages[error.code]
        place = f"line {error.lineno}, column {error.offset + 1}"
        raise FileError(f"{path}: not valid XML: {reason} (at {place})") from None
    except (ValueError, LookupError) as error:  # encodings
        raise FileError(f"{path}: cannot be read as XML: {visible(str(error))[:200]}") from None
    assert reader.root is not None
    return reader.root


class _Reader:
    """Handlers of the parser, which build the tree of elements."""

    def __init__(self, path: Path):
        self.path, self.count = path, 0
        self.root: XmlElement | None = None
        self.open: list[XmlElement] = []
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.characters
        self.parser.StartDoctypeDeclHandler = self.check_document_type
        self.parser.EntityDeclHandler = self.refuse_document_type
        self.parser.SkippedEntityHandler = self.refuse_skipped_entity
        self.parser.ExternalEntityRefHandler = self.refuse_document_type

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count % 10_000 == 0:
            subject = f"{self.path}: {self.count} elements and more"
            check_budget(subject, rounds=PER_ELEMENT * self.count, cure="import a smaller file")
        if len(self.open) >= MAX_DEPTH:
            raise self._error(f"elements are nested more than {MAX_DEPTH} deep")
        parent = self.open[-1] if self.open else None
        element = XmlElement(
            self.path, self.parser.CurrentLineNumber, visible(tag), attributes, parent
        )
        if parent is None:
            self.root = element
        else:
            parent.children.append(element)
        self.open.append(element)

    def end(self, tag: str) -> None:
        self.open.pop()

    def characters(self, text: str) -> None:
        self.open[-1].content += text

    def check_document_type(
        self, name: str, system: str | None, public: str | None, has_declarations: int
    ) -> None:
        """Accept a bare name, or the type of SVG, without declarations; nothing is fetched."""
        is_drawing = (public or "").startswith(DRAWINGS)
        if has_declarations or ((system or public) and not is_drawing):
            self.refuse_document_type()

    def refuse_skipped_entity(self, name: str, is_parameter: bool) -> None:
        raise self._error(f"the entity &{visible(name[:60])}; is not declared; write its text")

    def refuse_document_type(self, *declaration: object) -> int:
        raise self._error(
            "document types and entities are not read, because they may contain other files or "
            "expand without limit; remove <!DOCTYPE …>"
        )

    def _error(self, message: str) -> FileError:
        return FileError(f"{self.path}: line {self.parser.CurrentLineNumber}: {message}")
