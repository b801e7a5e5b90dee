"""Runs of the examples, each asked for once."""

from __future__ import annotations

import importlib
import math
import sys
from functools import cache
from pathlib import Path

import matplotlib as mpl

import dalembert as da
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.responses import make_responses
from dalembert.io.model_file import load_model_file

EXAMPLES = Path(__file__).parents[1] / "examples"
EVERY = {p.stem: 'kind = "structure"' in p.read_text("utf-8") for p in EXAMPLES.glob("*.toml")}
FILES = sorted(name for name, structure in EVERY.items() if not structure)
SMOOTH = [name for name in FILES if name not in ("crates_and_ball", "dominoes")]
"""Files with gradients, which ``AnticipatedImpacts`` does not have."""
OPTIMISED = [
    name for name in FILES if "\n[optimize]" in (EXAMPLES / f"{name}.toml").read_text("utf-8")
]
STRUCTURES = sorted(name for name, structure in EVERY.items() if structure)
SCRIPTS = sorted(path.stem for path in EXAMPLES.glob("*.py") if path.stem != "style")


@cache
def file(name: str):
    return load_model_file(EXAMPLES / f"{name}.toml")


@cache
def model(name: str) -> da.Model:
    return file(name).model()


@cache
def motion(name: str) -> da.Motion:
    """The file's analysis, as the command line runs it."""
    return make_analysis(file(name), model(name)).run(model(name))


def value(name: str, response: str) -> float:
    return da.evaluate(motion(name), make_responses(file(name), model(name))[response])


@cache
def script(name: str):
    mpl.use("Agg")
    if str(EXAMPLES) not in sys.path:
        sys.path.insert(0, str(EXAMPLES))
    return importlib.import_module(name)


@cache
def numbers(name: str, folder: Path) -> dict[str, float]:
    """What the script prints; it draws its picture too."""
    results = script(name).main(folder)
    assert all(math.isfinite(number) for number in results.values())
    assert (folder / f"{name}.png").stat().st_size > 10_000
    return results
