"""``dalembert check``: explain a model without solving anything."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from dalembert.cli.console import DONE, AsJson, Settings, emit, head, tell, wrong_input
from dalembert.cli.loading import is_deck, loaded, teller_of

if TYPE_CHECKING:
    from dalembert.analysis.assembly import AllAssemblies
    from dalembert.io.model_file import ModelFile

Assemblies = Annotated[
    bool,
    Parameter(negative=(), help="Search for all assembly configurations, too."),
]


def check(
    model: Path,
    /,
    *,
    settings: Settings | None = None,
    assemblies: Assemblies = False,
    as_json: AsJson = False,
) -> int:
    """Explain a model: its freedom, parts, parameters, and what is doubtful about it.

    Nothing is simulated. A mechanism is assembled, so that wrong lengths show here; where it
    cannot be, a page draws why (.assembly.html).

    Parameters
    ----------
    model
        Model file, TOML or JSON.
    """
    from dalembert.io.decisions.tasks import check_tasks

    if (alone := _synthesis_alone(model)) is not None:
        return _tell_synthesis(alone, as_json)
    file, built = loaded(model, settings, Path())
    teller = teller_of(built)
    with wrong_input():
        check_tasks(file, built)
    found = _all_assemblies(built) if assemblies else None
    if as_json:
        extra = {} if found is None else {"assemblies": found.to_dict()}
        emit({"ok": True, "name": file.name, **teller.description, **extra})
    else:
        teller.explain()
        if found is not None:
            tell(f"  {found}")
    return DONE


def _all_assemblies(model: Any) -> AllAssemblies:
    """All assembly configurations of a mechanism at its start."""
    from dalembert.analysis.assembly import solve_assembly

    with wrong_input():
        return solve_assembly(model, all=True)


def _synthesis_alone(path: Path) -> ModelFile | None:
    """The file where it asks for linkages and has no model of its own."""
    from dalembert.io.model_file import load_model_file

    if is_deck(path):
        return None
    with wrong_input():
        file = load_model_file(path)
    document: Any = file.document
    asked = getattr(document, "synthesis", None) is not None
    return file if asked and not document.bodies else None


def _tell_synthesis(file: ModelFile, as_json: bool) -> int:
    from dalembert.io.decisions.synthesis import make_synthesis

    with wrong_input():
        target = make_synthesis(file).args[0]
    asked: Any = file.document.synthesis  # type: ignore[union-attr]
    kind, count = asked.linkage, len(target)
    if as_json:
        emit({"ok": True, "name": file.name, "linkage": kind, "entries": count})
    else:
        head(file.name, f"a {kind} for a {asked.type} of {count} entries")
    return DONE
