"""``dalembert check``: explain a model without solving anything."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.cli.console import DONE, AsJson, Settings, emit, wrong_input
from dalembert.cli.loading import loaded, teller_of

if TYPE_CHECKING:
    from dalembert.io.model_file import ModelFile


def check(model: Path, /, *, settings: Settings | None = None, as_json: AsJson = False) -> int:
    """Explain a model: its freedom, parts, parameters, and what is doubtful about it.

    Nothing is simulated. A mechanism is assembled, so that wrong lengths show here; where it
    cannot be, a page draws why (.assembly.html).

    Parameters
    ----------
    model
        Model file, TOML or JSON.
    """
    file, built = loaded(model, settings, Path())
    teller = teller_of(built)
    with wrong_input():
        _check_tasks(file, built)
    if as_json:
        emit({"ok": True, "name": file.name, **teller.description})
    else:
        teller.explain()
    return DONE


def _check_tasks(file: ModelFile, model: Any) -> None:
    """What the file asks to compute can be made."""
    from dalembert.io.identification import make_identification
    from dalembert.io.tasks import check_tasks

    check_tasks(file, model)
    if file.document.identify is not None:
        make_identification(file, model)
