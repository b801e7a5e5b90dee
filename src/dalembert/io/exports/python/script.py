"""A Python script that builds and analyses the model of a file."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from dalembert.io.builder import Builder
from dalembert.io.documents import Document
from dalembert.io.exports.exported import Files
from dalembert.io.exports.python.analyses import analysis_code
from dalembert.io.exports.python.code import INDENT, Code, call, lines_of, literal, quoted
from dalembert.io.exports.python.declarations import declarations, histories
from dalembert.io.exports.python.elements import ElementCode
from dalembert.io.exports.python.formulas import FormulaCode
from dalembert.io.exports.python.names import Variables, imports
from dalembert.io.exports.python.structures import StructureCode
from dalembert.io.mechanism_elements import MechanismElements
from dalembert.io.model_file import ModelFile
from dalembert.io.omission import Omission

TASKS = (
    *("responses", "sensitivity", "combined", "robust", "optimize", "pareto", "random"),
    *("reliability", "tolerance", "identify", "sweep", "cases", "invert", "synthesis"),
    *("trajectory", "compare", "report"),
)
"""Sections that a script does not contain."""
LOAD_CASE = '''
def load_case(model, name):
    """Linear statics under one load case."""
    solution = da.Statics().run(model)
    return solution.at(np.array([solution.case(name)]))

'''


def python_file(source: ModelFile, name: str) -> Files:
    """A script with a function ``build`` of the model, and one of its analysis.

    Names, formulas and units are those of the file; sections of design tasks are left out.

    Raises
    ------
    ModelError, FileError, UnsupportedError
        The file has no model.
    """
    document: Any = source.document
    omissions = [
        Omission(section, "[" + section + "]", "design tasks and reports stay in the model file")
        for section in TASKS
        if section in document.model_fields_set
    ]
    text = _script(source)
    if "HERE" in text:
        reason = "keep the script beside them, in the folder of the model"
        omissions.append(Omission(source.path.name, "other files", reason))
    return Files({f"{name}.py": text.encode()}, omissions)


def _script(source: ModelFile) -> str:
    """Text of the script."""
    document: Any = source.document
    variables = Variables()
    body = [f"{INDENT}{line}" if line else "" for line in _body(source, variables)]
    result = analysis_code(document)
    text = "\n".join([f"def build() -> da.System:", *body])  # noqa: F541
    if isinstance(result, Code) and "load_case(" in str(result):
        text = f"{LOAD_CASE.lstrip()}\n{text}"
    main = [f"{INDENT}model = build().build()"]
    if result:
        statement = lines_of(result, INDENT, before="return ")
        doc = f'{INDENT}"""Result of the analysis."""'
        text += "\n".join(["\n\n\ndef analyse(model: da.Model):", doc, *statement])
        main += [f"{INDENT}print(analyse(model))"]
    else:
        main += [f"{INDENT}print(model)"]
    text += "\n".join(['\n\n\nif __name__ == "__main__":', *main, ""])
    here = ["HERE = Path(__file__).resolve().parent", ""] if "HERE" in text else []
    head = imports("\n".join([*here, text]))
    return "\n".join([_docstring(source), "", *head, "", *here, "", text])


def _docstring(source: ModelFile) -> str:
    """Description, or the name; no text can end the string."""
    title = source.document.description or source.name
    inner = quoted(title)[1:-1].replace("\\n", " ").strip()
    return f'"""{inner or "Model."}"""'


def _body(source: ModelFile, variables: Variables) -> Iterable[str]:
    """Lines of the function that builds the model."""
    document: Any = source.document
    reader = Builder(document, source.path)
    system = reader.build()
    is_mechanism = isinstance(document, Document)
    formulas = FormulaCode(system, variables, document.histories if is_mechanism else {})
    gravity = document.gravity or []
    plain = is_mechanism and bool(gravity) and all(isinstance(g, (int, float)) for g in gravity)
    keywords = {"gravity": literal(tuple(gravity))} if plain else {}
    keywords |= {"description": quoted(document.description)} if document.description else {}
    builder = call(f"da.{document.builder.__name__}", quoted(source.name), **keywords)
    structure = StructureCode(document, formulas)
    groups = [list(declarations(document, source.path, formulas))]
    if is_mechanism:
        parts = MechanismElements(
            document, system, reader.located, reader.formulas, reader.structure
        )
        elements = ElementCode(parts, formulas)
        groups += [
            list(histories(document, formulas)),
            list(elements.ground()),
            [*elements.section("bodies"), *elements.section("beams")],
            list(structure.parts()),
            list(elements.section("blocks")),
            [*elements.section("joints"), *elements.section("drivers")],
            list(elements.forces()),
        ]
    else:
        groups.append(list(structure.parts()))
    groups += [list(structure.conditions(plain)), list(structure.initial())]
    yield from lines_of(builder, "", before="system = ")
    for group in groups:
        if group:
            yield ""
        for variable, code in group:
            before = f"{variable} = " if variable in variables.used else ""
            yield from lines_of(code, "", before=before)
    yield "return system"
