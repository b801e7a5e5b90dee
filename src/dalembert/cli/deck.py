"""``dalembert run`` for the text deck of spring structures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import DONE, emit, head, tell, written, wrong_input
from dalembert.cli.loading import output_folder, pairs
from dalembert.cli.opening import opened
from dalembert.errors import ModelError

if TYPE_CHECKING:
    from dalembert.results.structural.result import StructuralResult


def run_deck(
    path: Path,
    output: Path | None,
    settings: list[str] | None,
    report: bool,
    csv: bool,
    quiet: bool,
    as_json: bool,
    open_page: bool = False,
) -> int:
    """Solve the structure, write its results, and print what the book's program prints."""
    result = solved_deck(path, settings)
    files = result.write(output_folder(output) / path.stem, report, csv)
    made = _summary(result) | {"files": [str(f) for f in files]}
    if as_json:
        emit(made)
    elif not quiet:
        _print(made)
    opened(files, open_page)
    return DONE


def solved_deck(path: Path, settings: list[str] | None) -> StructuralResult:
    """The structure of a deck under its loads, with the values of ``--set``.

    Raises
    ------
    WrongInput
        Anything wrong with the deck, the structure or the settings.
    """
    from dalembert.analysis.structural.statics import solve_statics
    from dalembert.io.spring_deck import load_deck

    with wrong_input():
        model = load_deck(path).build()
        given = {name: _number(name, text) for name, text in pairs(settings).items()}
        return solve_statics(model, parameters=given)


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ModelError(f"{text!r} is not a number", f"--set {name}") from None


def _summary(result: StructuralResult) -> dict[str, Any]:
    import dalembert as da

    model = result.model
    springs = [name for block in model.blocks for name in block.names.names]
    made: dict[str, Any] = {
        "ok": True,
        "name": model.name,
        "status": str(result.status),
        "residual": result.status.residual,
        "displacements": {node: result[f"{node}.ux"] for node, _ in model.degrees},
        "reactions": {node: result[f"{node}.fx"] for node, _ in model.supports},
        "spring forces": {name: result[f"{name}.force"] for name in springs},
        "compliance": result["compliance"],
    }
    if model.parameters:
        gradient = da.sensitivity(result, da.final("compliance")).values[0]
        made["compliance gradient"] = dict(zip(model.parameters, map(float, gradient), strict=True))
    return made


def _print(made: dict[str, Any]) -> None:
    head(made["name"], made["status"])
    for what, unit in (
        ("displacements", "m"),
        ("reactions", "N"),
        ("spring forces", "N"),
        ("compliance gradient", "J per unit"),
    ):
        for name, value in made.get(what, {}).items():
            tell(f"  {what:<20} {name:<6} {value:12.6g} {unit}")
    tell(f"  compliance                  {made['compliance']:12.6g} J")
    written(made["files"])
