"""Notebooks run as they stand, quickly and without warnings."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Any

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")

FOLDER = Path(__file__).parents[1] / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
PATIENCE = 20.0
"""Seconds that one cell may take on a busy machine; alone each takes two or less."""


def test_there_are_five() -> None:
    expected = {"start", "gradients", "structures", "flexible_and_contact", "design"}
    assert {path.stem for path in NOTEBOOKS} == expected


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(__import__("sys").path))
    notebook = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "is kept without outputs"
    begun: dict[int, float] = {}
    taken: dict[int, float] = {}
    client = nbclient.NotebookClient(
        notebook,
        timeout=120,
        resources={"metadata": {"path": str(FOLDER)}},
        on_cell_execute=lambda cell, cell_index: begun.setdefault(cell_index, time.monotonic()),
        on_cell_executed=lambda cell, cell_index, **_: taken.setdefault(
            cell_index, time.monotonic() - begun[cell_index]
        ),
    )
    client.execute()
    outputs: list[Any] = [o for cell in notebook.cells for o in cell.get("outputs", ())]
    assert not [o for o in outputs if o.output_type == "stream" and o.name == "stderr"]
    shown = [o for o in outputs if "text/html" in o.get("data", {})]
    assert shown and all("Traceback" not in o["data"]["text/html"] for o in shown)
    assert max(taken.values()) < PATIENCE
