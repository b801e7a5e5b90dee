"""``kill -9`` at random moments of every command that writes files.

``python -m tests.killed_commands [repetitions] [seed] [COMMAND …]`` runs every command repeatedly.
Half of the kills come before a random file operation, half after a random time; in turn the folder
is empty or holds the files of an earlier run. The law: every file with a final name is whole, and
files of the earlier run are those or the new ones; the same command then works, and leaves nothing
hidden. Commands run in forks of one process, which has imported everything.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from test_decision_files import PUSH, ROD, SYNTHESIS, TASKS

import dalembert as da
import tests.stress  # noqa: F401  puts the folder of the tests on the path
from dalembert.cli import main as dalembert

EXAMPLES = Path(__file__).parents[1] / "examples"
OPERATIONS = {"open", "os.rename", "os.remove", "os.chmod", "os.mkdir", "tempfile.mkstemp"}
"""Events of Python's audit before which a command is killed."""
LONGEST = 300.0
"""Seconds that a command may take."""
SPRING = """
format = 1
name = "spring"
gravity = [0, -9.81]
[parameters]
k = { value = 50.0, bounds = [10.0, 100.0] }
[bodies.b]
type = "Particle"
mass = 1.0
position = [0.0, -0.2]
[forces.s]
type = "Spring"
connect = ["ground", "b"]
stiffness = "k"
free_length = 0.1
[analysis]
type = "Dynamics"
duration = 0.1
step = 0.01
[responses.low]
type = "Final"
measure = "b.y"
[optimize]
maximize = "low"
vary = ["k"]
[sweep]
samples = 6
"""
FIT = PUSH.replace("[histories.push]", "[parameters]\nm = 3.0\n[histories.push]\nvalue = 1")
FIT = FIT.replace("mass = 2.0", 'mass = "m"').partition("[invert]")
FIT = FIT[0] + '[identify]\nvary = ["m"]' + FIT[2].replace("smoothing = 1e-9", "")
SEEN = "time,sensor\n" + "".join(f"{k / 20},{(k / 20) ** 2 / 4}\n" for k in range(21))
FILES = {
    "spring.toml": SPRING,
    "rod.toml": ROD + "".join(TASKS.values()),
    "path.toml": SYNTHESIS,
    "push.toml": PUSH,
    "fit.toml": FIT,
    "push.csv": SEEN,
    **{n: (EXAMPLES / n).read_text(encoding="utf-8") for n in ("swing_up.toml", "bridge.dat")},
}
FEW = ["--formulations", "RangeSpace", "--integrators", "RK4", "--steps", "0.01,0.005"]
COMMANDS = {
    "run": ["run", "spring.toml", "--csv", "--output", "o"],
    "deck": ["run", "bridge.dat", "--csv", "--output", "o"],
    "structure": ["run", "rod.toml", "--output", "o"],
    "sensitivity": ["sensitivity", "spring.toml", "--output", "o"],
    "compare": ["compare", "spring.toml", *FEW, "--output", "o"],
    "optimize": ["optimize", "spring.toml", "--output", "o", "--history", "o/h.jsonl"],
    "sweep": ["sweep", "spring.toml", "--output", "o"],
    **{task: [task, "rod.toml", "--output", "o"] for task in TASKS},
    "trajectory": ["trajectory", "swing_up.toml", "--output", "o"],
    "synthesize": ["synthesize", "path.toml", "--output", "o"],
    "identify": ["identify", "fit.toml", "--output", "o"],
    "invert": ["invert", "push.toml", "--output", "o"],
    "report": ["report", "spring.nc", "--output", "o/page.html"],
    "film": ["film", "spring.nc", "--output", "o/film.gif", "--seconds", "0.5"],
    "schema": ["schema", "--output", "o/schema.json"],
    "examples": ["examples", "four_bar", "--force", "--output", "o"],
}


def ended(arguments: list[str], folder: Path, kill: int | None = None, wait: float = 0.0) -> int:
    """Exit code of a command in a fork; it is killed before an operation or after a time."""
    child = os.fork()
    if child == 0:
        _run(arguments, folder, kill)
    end = time.monotonic() + (wait or LONGEST)
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        if time.monotonic() > end:
            os.killpg(child, signal.SIGKILL)
            end += LONGEST
        time.sleep(0.002)


def _run(arguments: list[str], folder: Path, kill: int | None) -> None:
    """In the fork: write the count of operations, or end at one of them."""
    code = 70
    try:
        os.setsid()
        os.chdir(folder)
        nowhere = os.open("log", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        count = 0
        place = (f"{folder}/o/", "o/")

        def watch(event: str, arguments: tuple) -> None:
            nonlocal count
            if event in OPERATIONS and arguments and str(arguments[0]).startswith(place):
                count += 1
                if count == kill:
                    os.kill(os.getpid(), signal.SIGKILL)

        sys.addaudithook(watch)
        code = dalembert(arguments)
        Path("count").write_text(str(count))
    finally:
        os._exit(code)


def shown(folder: Path) -> dict[str, Path]:
    """Files with their final names."""
    files = (path for path in (folder / "o").rglob("*") if path.is_file())
    return {str(p.relative_to(folder / "o")): p for p in files if not p.name.startswith(".")}


def hidden(folder: Path) -> list[str]:
    """Temporary files of the commands."""
    return [p.name for p in folder.rglob(".*") if p.is_file() and p.name != ".lock"]


def torn(path: Path, earlier: Path) -> str:
    """What is wrong with a file; ``earlier`` is the one of an undisturbed run."""
    content = path.read_bytes()
    if content == earlier.read_bytes():
        return ""
    try:
        if path.suffix == ".nc":
            da.load_results(path)
        elif path.suffix == ".json":
            json.loads(content)
        elif path.suffix == ".jsonl":
            [json.loads(line) for line in content.splitlines()[:-1]]
        elif path.suffix == ".parquet":
            import pyarrow.parquet as parquet

            parquet.read_table(path)
        elif path.suffix == ".csv":
            lines = len(content.splitlines()), len(earlier.read_bytes().splitlines())
            return "" if content.endswith(b"\n") and lines[0] == lines[1] else "rows are missing"
        else:
            last = {".html": b"</html>", ".png": b"IEND\xaeB`\x82", ".gif": b";"}[path.suffix]
            return "" if content.rstrip(b"\n").endswith(last) else "its end is missing"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return ""


def violations(folder: Path, complete: Path, again: bool) -> Iterator[str]:
    """What breaks the law in a folder; ``again``: every file has to be there, nothing hidden."""
    computed, reference = shown(folder), shown(complete)
    for name in computed.keys() - reference.keys():
        yield f"{name} is no file of this command"
    for name in computed.keys() & reference.keys():
        wrong = torn(computed[name], reference[name])
        if wrong:
            yield f"{name}: {wrong}"
    if again:
        yield from (f"{name} is missing" for name in reference.keys() - computed.keys())
        yield from (f"{name} is left behind" for name in hidden(folder))


def trial(
    arguments: list[str], start: Path, complete: Path, earlier: bool, **moment: float
) -> Iterator[str]:
    """One kill, and the run after it."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "f"
        shutil.copytree(complete if earlier else start, folder)
        code = ended(arguments, folder, **moment)  # type: ignore[arg-type]
        if code not in (0, -signal.SIGKILL):
            yield f"exit code {code}: {(folder / 'log').read_text()[-300:]}"
        yield from violations(folder, complete, again=False)
        if earlier:
            missing = shown(complete).keys() - shown(folder).keys()
            yield from (f"{name} of the earlier run is missing" for name in missing)
        code = ended(arguments, folder)
        if code:
            yield f"exit code {code} afterwards: {(folder / 'log').read_text()[-300:]}"
        yield from violations(folder, complete, again=True)


def prepared(folder: Path) -> Path:
    """The files that commands read, and an empty folder for what they write."""
    (folder / "o").mkdir(parents=True)
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    code = ended(["run", "spring.toml", "--no-report", "--output", "."], folder)
    assert code == 0, (folder / "log").read_text()
    return folder


def main() -> int:
    options = sys.argv[1:]
    repetitions, seed = (int(a) for a in [*options[:2], "8", "0"][:2])
    chance, broken = random.Random(seed), 0
    with tempfile.TemporaryDirectory() as place:
        start = prepared(Path(place) / "start")
        for name in options[2:] or COMMANDS:
            target = Path(place) / name
            shutil.copytree(start, target)
            begin = time.monotonic()
            code = ended(COMMANDS[name], target)
            whole = time.monotonic() - begin
            assert code == 0, f"{name}: {code} {(target / 'log').read_text()[-500:]}"
            count = int((target / "count").read_text())
            for k in range(repetitions):
                moment = (
                    {"wait": chance.uniform(0.0, whole)}
                    if k % 2
                    else {"kill": chance.randint(1, count)}
                )
                for text in trial(COMMANDS[name], start, target, k % 4 > 1, **moment):
                    broken += 1
                    print(f"{name}, {moment} of {count}, {whole:.2f} s: {text}", flush=True)
            print(f"{name}: {repetitions} kills, {count} operations, {whole:.1f} s", flush=True)
    print(f"{broken} violations")
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main())
