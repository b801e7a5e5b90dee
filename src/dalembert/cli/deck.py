"""``dalembert run`` for the text deck of spring structures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import (
    DONE,
    open_pages,
    print_files,
    print_heading,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.loading import output_folder, parse_settings
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
    """Solve the structure, write its results, and print the output of the book's program."""
    result = solve_deck(path, settings)
    files = result.write(output_folder(output) / path.stem, report, csv)
    summary = _summary(result) | {"files": [str(f) for f in files]}
    if as_json:
        print_json(summary)
    elif not quiet:
        _print(summary)
    open_pages(files, open_page)
    return DONE


def solve_deck(path: Path, settings: list[str] | None) -> StructuralResult:
    """Static solution of a deck, with the parameter values of ``--set``.

    Raises
    ------
    WrongInput
        The deck, the structure or a setting is invalid.
    """
    from dalembert.analysis.equilibrium.statics import solve_statics
    from dalembert.io.spring_deck import load_deck

    with wrong_input():
        model = load_deck(path).build()
        parameters = {name: _number(name, text) for name, text in parse_settings(settings).items()}
        return solve_statics(model, parameters=parameters)


def _number(name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ModelError(f"{text!r} is not a number", f"--set {name}") from None


def _summary(result: StructuralResult) -> dict[str, Any]:
    import dalembert as da

    model = result.model
    springs = [name for block in model.blocks for name in block.names.names]
    summary: dict[str, Any] = {
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
        summary["compliance gradient"] = dict(
            zip(model.parameters, map(float, gradient), strict=True)
        )
    return summary


def _print(summary: dict[str, Any]) -> None:
    print_heading(summary["name"], summary["status"])
    for quantity, unit in (
        ("displacements", "m"),
        ("reactions", "N"),
        ("spring forces", "N"),
        ("compliance gradient", "J per unit"),
    ):
        for name, value in summary.get(quantity, {}).items():
            print_line(f"  {quantity:<20} {name:<6} {value:12.6g} {unit}")
    print_line(f"  compliance                  {summary['compliance']:12.6g} J")
    print_files(summary["files"])
