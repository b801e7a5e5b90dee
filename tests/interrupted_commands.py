"""Ctrl-C at random moments of the long commands.

``python -m tests.interrupted_commands [repetitions] [seed]`` starts every command repeatedly, sends
SIGINT after a random time, and lists what breaks the law: exit code 130 (or 0 where the command had
finished), "interrupted" in the output unless it is whole, no traceback, no temporary or unreadable
file.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import dalembert as da

EXAMPLES = Path(__file__).parents[1] / "examples"
BEGIN = 0.5
"""Earliest signal [s]: Python itself has started."""
SEARCHES = {
    "run": ("run", "four_bar"),
    "sweep": ("sweep", "four_bar", "--workers", "2"),
    "pareto": ("pareto", "smooth_torque"),
    "reliability": ("reliability", "smooth_torque"),
    "tolerance": ("tolerance", "smooth_torque", "--samples", "400"),
    "trajectory": ("trajectory", "swing_up"),
    "synthesize": ("synthesize", "path_optimization", "--starts", "40"),
}
METHODS = (
    "slsqp",
    "ipopt",
    "trust-constr",
    "mma",
    "multistart",
    "differential-evolution",
)
OPTIMIZE = {
    f"optimize {method}": ("optimize", "smooth_torque", "--method", method) for method in METHODS
}
COMMANDS = SEARCHES | OPTIMIZE


def arguments(case: tuple[str, ...], folder: Path) -> list[str]:
    """The command line of a case; results go to ``folder/o``."""
    command, example, *options = case
    path = folder / f"{example}.toml"
    path.write_text((EXAMPLES / path.name).read_text(encoding="utf-8"), encoding="utf-8")
    return [command, str(path), "--json", "--output", str(folder / "o"), *options]


def interrupted_after(wait: float, case: tuple[str, ...], folder: Path) -> Iterator[str]:
    """Violations of the law by a command that gets SIGINT after ``wait`` seconds."""
    command = [sys.executable, "-m", "dalembert", *arguments(case, folder)]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL) and None,
    )
    try:
        out, err = process.communicate(timeout=wait)
        in_time = False
    except subprocess.TimeoutExpired:
        in_time = True
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to its workers, too
        try:
            out, err = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            yield "it did not end within 60 s"
            return
    yield from _judged(process.returncode, out, err, in_time)
    yield from _files(folder / "o")


def _judged(code: int, out: str, err: str, in_time: bool) -> Iterator[str]:
    whole = _document(out)
    finished = whole is not None and whole.get("interrupted") is False
    if code == 0 and (not in_time or finished):
        return  # the signal came while Python was ending
    if code not in (130, -signal.SIGINT):  # a shell sees both as 130
        yield f"exit code {code}: {err[-300:]}"
    if "Traceback" in err or "Exception ignored" in err:
        yield f"traceback: {err[-600:]}"
    if finished:
        return  # the whole output was written before the signal
    if "interrupted" not in err and "interrupted" not in str(whole and _said(whole)):
        yield f"'interrupted' is not in the output {out[:200]} {err[:200]}"


def _said(whole: dict) -> str:
    error = whole.get("error", {}).get("message", "")
    status = json.dumps(whole.get("status", ""))
    return f"{error} {status} {'interrupted' if whole.get('interrupted') else ''}"


def _document(out: str) -> dict | None:
    try:
        return json.loads(out)
    except ValueError:
        return None


def _files(folder: Path) -> Iterator[str]:
    for path in folder.rglob("*") if folder.exists() else ():
        if path.suffix == ".nc":
            da.load_results(path)
        elif path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        elif (path.name.startswith(".") and path.name != ".lock") or "tmp" in path.name:
            yield f"left behind: {path.name}"


def main() -> int:
    repetitions, seed = (int(a) for a in [*sys.argv[1:], "5", "0"][:2])
    chance, broken = random.Random(seed), 0
    for name, case in COMMANDS.items():
        with tempfile.TemporaryDirectory() as place:
            begin = time.monotonic()
            list(interrupted_after(600, case, Path(place)))
            whole = time.monotonic() - begin
        for _ in range(repetitions):
            wait = chance.uniform(BEGIN, whole)
            with tempfile.TemporaryDirectory() as place:
                for text in interrupted_after(wait, case, Path(place)):
                    broken += 1
                    print(f"{name}, {wait:.2f} s of {whole:.2f} s: {text}", flush=True)
        print(f"{name}: {repetitions} interrupts within {whole:.1f} s", flush=True)
    print(f"{broken} violations")
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main())
