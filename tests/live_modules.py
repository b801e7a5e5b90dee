"""Live modules in Node, all of them in one process."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from browser import missing

from dalembert.report.scripts import RUNS

TESTS = Path(__file__).parent
ASSETS = TESTS.parent / "src/dalembert/report/assets"
SCRIPT = "live_modules.js"


@dataclass(frozen=True)
class Outcome:
    """Result of a live run.

    Attributes
    ----------
    status : outcome, message, time, residual and success
    times : (K,) instants, numbers or frequencies
    table : (rows, K) outputs
    values : (responses,)
    gradients : (responses, parameters)
    same : whether a second run has the same outputs, bit by bit, and takes no more memory, and
        a run of the first instant alone the same first outputs
    """

    status: Mapping[str, Any]
    times: np.ndarray | None = None
    table: np.ndarray | None = None
    values: np.ndarray | None = None
    gradients: np.ndarray | None = None
    same: bool = True


class Modules:
    """Modules with the parameters of their runs, calls of mathematical functions, and limits of
    quantities with numbers, of which a run sets the messages."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.cases: dict[str, Any] = {}
        self.calls: list[Any] = []
        self.limits: list[Any] = []
        self.messages: list[str] = []

    def add(
        self,
        name: str,
        data: Mapping[str, Any],
        parameters: np.ndarray,
        weights: Sequence[Mapping[int, np.ndarray]] = (),
        responses: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        """Add a run; ``weights`` are those of the samples of each gradient, by row.

        Values and gradients of ``responses`` come first.
        """
        pairs = [[[row, plain(values)] for row, values in entry.items()] for entry in weights]
        case = {"data": data, "parameters": parameters, "responses": responses}
        self.cases[name] = plain(case) | {"weights": pairs}

    def run(self) -> tuple[dict[str, Outcome], list[np.ndarray]]:
        """Outcomes of all runs, and values of all calls."""
        node = shutil.which("node")
        if node is None:
            missing("node")
        for script in ASSETS.glob("live_*.js"):
            shutil.copy(script, self.folder)
        shutil.copy(TESTS / SCRIPT, self.folder)
        (self.folder / "package.json").write_text('{"type": "module"}')
        entries = {"cases": self.cases, "calls": plain(self.calls), "runs": RUNS}
        entries["limits"] = plain(self.limits)
        (self.folder / "cases.json").write_text(json.dumps(entries))
        command = [node, str(self.folder / SCRIPT), str(self.folder)]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stderr[-3000:]
        text = json.loads((self.folder / "results.json").read_text())
        self.messages = text["messages"]
        results = {name: outcome(entry) for name, entry in text["results"].items()}
        return results, [np.array(values, float) for values in text["values"]]


def outcome(entry: Mapping[str, Any]) -> Outcome:
    if "table" not in entry:
        return Outcome(entry["status"])
    table = np.array(entry["table"], float).reshape(entry["rows"], -1)
    arrays = (np.array(entry[key], float) for key in ("values", "gradients"))
    return Outcome(entry["status"], np.array(entry["times"], float), table, *arrays, entry["same"])


def plain(value: Any) -> Any:
    """A value as plain data; numbers that are not finite as texts."""
    if isinstance(value, Mapping):
        return {name: plain(entry) for name, entry in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(entry) for entry in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not np.isfinite(value):
        return {np.inf: "Infinity", -np.inf: "-Infinity"}.get(value, "NaN")
    return value
