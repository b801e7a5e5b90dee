"""Hostile and damaged files: read correctly, or refused by one error message."""

from __future__ import annotations

import contextlib
import functools
import io
import re
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from good_model import GOOD
from hostile_results import HOSTILE

import dalembert as da
from dalembert.cli import main
from dalembert.errors import DalembertError, FileError
from dalembert.text.wording import HIDDEN

EXAMPLES = sorted(path for path in (Path(__file__).parents[2] / "examples").glob("*.toml"))
NUMBERS = ["nan", "-1", "0", "1e308", "-1e308", "5e-324", "1e9", "inf", "1e-300", "true"]
TEXTS = ['""', '"t"', '"."', '"l1 - l1"', '"\\u202e"', '"' + "x" * 5000 + '"', '"<script>"', "{}"]


def judge(seed: int) -> tuple[str, str, str]:
    rng = np.random.default_rng([seed, 6])
    kinds: list[Callable] = [example, example, model, deck, result, result, hostile]
    with tempfile.TemporaryDirectory(prefix="stress-") as folder:
        return kinds[seed % len(kinds)](rng, Path(folder))


def called(*arguments: str) -> tuple[int, str, str]:
    """Exit code and what the command line wrote."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(list(arguments))
    return code, out.getvalue(), err.getvalue()


def judged_command(case: str, *arguments: str) -> tuple[str, str, str]:
    """Exit code 0, 1 with a status, or 2 with one message of reasonable length."""
    code, _, err = called(*arguments)
    wrong = [
        ("a traceback", "Traceback" in err),
        (f"exit code {code}", code not in (0, 1, 2)),
        (f"{err.count('Error: ')} messages", code == 2 and err.count("Error: ") != 1),
        (f"{len(err)} characters", len(err) > 3000),
        ("hidden characters", bool(HIDDEN.search(err))),
    ]
    joint = ", ".join(name for name, is_wrong in wrong if is_wrong)
    if joint:
        return "crash", case, f"{joint}: {err[:500]}"
    return ("completed", "ended", "refused")[code], case, err.strip()[:500]


def damaged(text: str, rng: np.random.Generator) -> str:
    """Numbers, texts and lines replaced at random."""
    lines = text.splitlines()
    for _ in range(int(rng.integers(1, 4))):
        k, j = rng.integers(0, len(lines), 2)
        act = rng.integers(6)
        if act == 0:
            number = str(rng.choice(NUMBERS))
            lines[k] = re.sub(r"(?<=[ =\[,])[\d.]+(?=[ ,\]}]|$)", number, lines[k])
        elif act == 1:
            words = str(rng.choice(TEXTS))
            lines[k] = re.sub(r'"[^"]*"', lambda _, words=words: words, lines[k])
        elif act == 2:
            lines[k] = ""
        elif act == 3:
            lines.insert(j, lines[k])
        elif act == 4:
            lines[k], lines[j] = lines[j], lines[k]
        else:
            lines[k] = lines[k][: len(lines[k]) // 2]
    return "\n".join(lines)


def example(rng: np.random.Generator, folder: Path) -> tuple[str, str, str]:
    """A damaged example is checked; files beside it are missing, which is one more damage."""
    path = EXAMPLES[rng.integers(len(EXAMPLES))]
    source = folder / "damaged.toml"
    source.write_text(damaged(path.read_text(encoding="utf-8"), rng), encoding="utf-8")
    return judged_command(f"check of a damaged {path.name}", "check", str(source))


def model(rng: np.random.Generator, folder: Path) -> tuple[str, str, str]:
    """A damaged model is run; a success has finite numbers and its own equations."""
    source = folder / "damaged.toml"
    source.write_text(damaged(GOOD, rng), encoding="utf-8")
    kind, case, message = judged_command(
        "run of a damaged model", "run", str(source), "--output", str(folder), "--no-report"
    )
    if kind != "completed":
        return kind, case, message
    for path in folder.glob("*.nc"):
        data = da.load_results(path)
        for name, limit in (("position_violation", 1e-6), ("balance_error", 1e-3)):
            if name in data and not np.all(np.abs(data[name].values) < limit * 1e3):
                return "false success", case, f"{name}: {np.abs(data[name].values).max():.2g}"
        if not np.isfinite(data["coordinates"].values).all():
            return "false success", case, "coordinates are not finite"
    return kind, case, message


def deck(rng: np.random.Generator, folder: Path) -> tuple[str, str, str]:
    """Random bytes and random words where a deck, a table or a model in JSON is expected."""
    ending = str(rng.choice([".dat", ".json", ".csv", ".toml", ".nc", ".inp", ".bdf"]))
    source = folder / f"noise{ending}"
    if rng.random() < 0.5:
        source.write_bytes(rng.bytes(int(rng.integers(0, 5000))))
    else:
        words = ["GRID", "CBAR", "1", "{", "}", "[", '"kind"', ":", "1e400", ",", "\n", "PBAR", "*"]
        source.write_text(" ".join(rng.choice(words, 200)), encoding="utf-8")
    return judged_command(f"noise in {ending}", "check", str(source))


@functools.cache
def saved() -> tuple[bytes, dict[str, np.ndarray], dict]:
    """A good result file, its arrays and its attributes."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "good.toml"
        source.write_text(GOOD, encoding="utf-8")
        assert called("run", str(source), "--output", folder)[0] == 0
        (path,) = Path(folder).glob("*.nc")
        data = da.load_results(path)
        return path.read_bytes(), arrays(data), dict(data.attrs)


def arrays(data) -> dict[str, np.ndarray]:
    return {str(name): data[name].values for name in data.variables}


def result(rng: np.random.Generator, folder: Path) -> tuple[str, str, str]:
    """A bit of a result file flips: the same numbers, or an error."""
    content, expected, attributes = saved()
    broken = bytearray(content)
    at, bit = int(rng.integers(len(content))), int(rng.integers(8))
    broken[at] ^= 1 << bit
    case, path = f"bit {bit} of byte {at} of a result", folder / "flipped.nc"
    path.write_bytes(broken)
    try:
        data = da.load_results(path)
    except FileError as error:
        return "refused", case, str(error)
    computed = arrays(data)
    same = computed.keys() == expected.keys() and dict(data.attrs) == attributes
    if not same or any(
        not np.array_equal(computed[k], v, equal_nan=v.dtype.kind == "f")
        for k, v in expected.items()
    ):
        return "false success", case, "other values are loaded"
    return "completed", case, ""


def hostile(rng: np.random.Generator, folder: Path) -> tuple[str, str, str]:
    """Results that point elsewhere or unpack to too much."""
    name = str(rng.choice(list(HOSTILE)))
    path = folder / "hostile.nc"
    HOSTILE[name](path)
    try:
        da.load_results(path)
    except DalembertError as error:
        return "refused", name, str(error)
    return "false success", name, "a hostile file is loaded"
