"""Notebooks run as they stand, without warnings."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")

FOLDER = Path(__file__).parents[1] / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
HANGING = 120
"""Time after which a cell is taken to hang [s]; alone each takes two or less."""


def test_there_are_five() -> None:
    expected = {"start", "gradients", "structures", "flexible_and_contact", "design"}
    assert {path.stem for path in NOTEBOOKS} == expected


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.thorough] * (path.stem != "design"))
        for path in NOTEBOOKS
    ],
)
def test_notebook_runs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(__import__("sys").path))
    notebook = nbformat.read(path, as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "is kept without outputs"
    resources = {"metadata": {"path": str(FOLDER)}}
    nbclient.NotebookClient(notebook, timeout=HANGING, resources=resources).execute()
    outputs: list[Any] = [o for cell in notebook.cells for o in cell.get("outputs", ())]
    assert not [o for o in outputs if o.output_type == "stream" and o.name == "stderr"]
    shown = [o for o in outputs if "text/html" in o.get("data", {})]
    assert shown and all("Traceback" not in o["data"]["text/html"] for o in shown)
