"""``dalembert check``: explain a model without solving anything."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import (
    DONE,
    AsJson,
    Settings,
    print_heading,
    print_json,
    print_line,
    wrong_input,
)
from dalembert.cli.loading import is_deck, load_model, model_printer

if TYPE_CHECKING:
    from dalembert.analysis.assembly import AllAssemblies
    from dalembert.io.model_file import ModelFile

Assemblies = Annotated[
    bool,
    Parameter(negative=(), help="Also search for all assembly configurations."),
]


def check(
    model: Path,
    /,
    *,
    settings: Settings | None = None,
    assemblies: Assemblies = False,
    as_json: AsJson = False,
) -> int:
    """Explain a model: degrees of freedom, parts, parameters and warnings.

    Nothing is simulated. A mechanism is assembled, which reveals wrong lengths; if assembly fails,
    a page with a drawing is written (.assembly.html).

    Parameters
    ----------
    model
        Model file, TOML or JSON.
    """
    from dalembert.io.decisions.tasks import check_tasks

    if (synthesis_file := _synthesis_file(model)) is not None:
        return _print_synthesis(synthesis_file, as_json)
    file, built = load_model(model, settings, Path())
    printer = model_printer(built)
    with wrong_input():
        check_tasks(file, built)
    configurations = _all_assemblies(built) if assemblies else None
    if as_json:
        entries = {} if configurations is None else {"assemblies": configurations.to_dict()}
        print_json({"ok": True, "name": file.name, **printer.description, **entries})
    else:
        printer.explain()
        if configurations is not None:
            print_line(f"  {configurations}")
    return DONE


def _all_assemblies(model: Any) -> AllAssemblies:
    """All assembly configurations of a mechanism at its initial time."""
    from dalembert.analysis.assembly import solve_assembly

    with wrong_input():
        return solve_assembly(model, all=True)


def _synthesis_file(path: Path) -> ModelFile | None:
    """The file if it contains a synthesis task but no bodies."""
    from dalembert.io.model_file import load_model_file

    if is_deck(path):
        return None
    with wrong_input():
        file = load_model_file(path)
    document: Any = file.document
    has_synthesis = getattr(document, "synthesis", None) is not None
    return file if has_synthesis and not document.bodies else None


def _print_synthesis(file: ModelFile, as_json: bool) -> int:
    from dalembert.io.decisions.synthesis import make_synthesis

    with wrong_input():
        target = make_synthesis(file).args[0]
    synthesis: Any = file.document.synthesis  # type: ignore[union-attr]
    kind, count = synthesis.linkage, len(target)
    if as_json:
        print_json({"ok": True, "name": file.name, "linkage": kind, "entries": count})
    else:
        print_heading(file.name, f"a {kind} for a {synthesis.type} of {count} entries")
    return DONE
