"""Time from a changed topology to its picture in the studio, with a timeline.

``PYTHONPATH=$PWD/src:tests python -m benchmarks.studio_changes`` adds springs to a four-bar, and
particles, and prints for each kind of change the time after the request at which its answer, the
message about its picture, the page of the picture and the drawn picture arrive, with the processor
time of the server, of its processes and of the browser up to then.
"""

from __future__ import annotations

import os
import statistics
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

from browser import chromium
from studio_desk import Desk, opened
from studio_runs import Studio, running_studio

FOUR_BAR = """format = 1
name = "four-bar"
gravity = [0.0, -9.81]

[parameters]
crank = { value = 0.12, unit = "m", bounds = [0.08, 0.16] }
coupler = { value = 0.4, unit = "m", bounds = [0.3, 0.5] }

[bodies]
bar1 = { type = "Bar", length = "crank", mass = 0.316, position = [0.05, 0.05], angle = 1.0 }
bar2 = { type = "Bar", length = "coupler", mass = 0.728, position = [0.25, 0.25], angle = 0.4 }
bar3 = { type = "Bar", length = 0.3, mass = 0.51, position = [0.45, 0.15], angle = -1.2 }

[joints]
A = { type = "Revolute", connect = ["bar1.end", "bar2.start"] }
B = { type = "Revolute", connect = ["bar2.end", "bar3.start"] }
C = { type = "Revolute", connect = [{ body = "ground", at = [0, 0] }, "bar1.start"] }
D = { type = "Revolute", connect = [{ body = "ground", at = [0.42, 0] }, "bar3.end"] }

[drivers]
motor = { type = "RotationalDriver", connect = ["ground", "bar1"], law = "1.0 + 2*pi*t" }
"""
SPRING = """{ op: "add", section: "forces", base: "s", fields: { type: "Spring",
    connect: ["bar2.end", { body: "ground", at: [0, 0.3] }], stiffness: 10 + k } }"""
PARTICLE = """{ op: "add", section: "bodies", base: "p",
    fields: { type: "Particle", mass: 1, position: [0.1 * k, 0.5] } }"""
CHANGES = {"spring": SPRING, "particle": PARTICLE}
"""Kind of change → its operation number k."""
STEPS = ("answer", "message", "loaded", "shown", "drawn")
TIMELINE = """(k) => new Promise((done) => {
    const begin = performance.now(), marks = {}, number = studio.pictures.shown;
    const mark = (name) => { marks[name] ??= performance.now() - begin; };
    const receive = studio.receive;
    studio.receive = function (message) {
        if (message.kind === "text") mark("answer");
        if (message.kind === "picture" && !message.live) mark("message");
        receive.call(this, message);
        if (message.kind === "picture" && !message.live)
            this.pictures.next?.addEventListener("load", () => mark("loaded"));
    };
    const shown = () => {
        mark("shown");
        studio.pictures.onShow.splice(studio.pictures.onShow.indexOf(shown), 1);
        studio.receive = receive;
        requestAnimationFrame(() => setTimeout(() => { mark("drawn"); done(marks); }));
    };
    studio.pictures.onShow.push(shown);
    studio.change({ label: "add", operations: [OPERATION] });
})"""
REPEATS = 8
REST = 2.0
"""Time after a change, in which its live picture is made [s]."""


def processes(root: int) -> dict[int, tuple[str, float]]:
    """Processes below one: name and processor time [s]."""
    children: dict[int, list[int]] = {}
    times: dict[int, tuple[str, float]] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
            command = (folder / "cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        pid = int(folder.name)
        children.setdefault(int(fields[1]), []).append(pid)
        ticks = int(fields[11]) + int(fields[12])
        times[pid] = role(command), ticks / os.sysconf("SC_CLK_TCK")
    found, waiting = {}, [root]
    while waiting:
        pid = waiting.pop()
        found[pid] = times[pid]
        waiting += children.get(pid, [])
    return found


def role(command: str) -> str:
    """Part of a process in a change, by its command line."""
    if "chrom" in command:
        kind = command.partition("--type=")[2].split("\0")[0].split(" ")[0]
        return f"browser {kind or 'main'}"
    return "server" if "-m\0dalembert" in command else "building" if "forkserver" in command else ""


def measure(desk: Desk, operation: str) -> tuple[dict[str, list[float]], Counter[str]]:
    """Marks of changes of one kind [ms], and processor times of all of them [s]."""
    marks: dict[str, list[float]] = {step: [] for step in STEPS}
    spent: Counter[str] = Counter()
    for k in range(REPEATS):
        before = processes(os.getpid())
        one: dict[str, Any] = desk.page.evaluate(TIMELINE.replace("OPERATION", operation), k)
        for pid, (name, seconds) in processes(os.getpid()).items():
            spent[name] += seconds - before.get(pid, ("", 0.0))[1]
        for step in STEPS:
            marks[step].append(one.get(step, one["shown"]))
        time.sleep(REST)
        desk.press("Control+z")
        time.sleep(REST)
    return marks, spent


def report(studio: Studio, browser: Any) -> None:
    """Print the timelines of all kinds of changes."""
    with opened(browser, studio, look="0") as desk:
        desk.show(FOUR_BAR)
        time.sleep(3 * REST)
        for kind, operation in CHANGES.items():
            marks, spent = measure(desk, operation)
            print(f"{kind}: ms after the request, median (smallest–largest) of {REPEATS}")
            for step, values in marks.items():
                low, high = min(values), max(values)
                print(f"  {step:8} {statistics.median(values):5.0f}  ({low:.0f}–{high:.0f})")
            shares = {name: 1e3 * total / REPEATS for name, total in sorted(spent.items())}
            print("  processor ms: " + ", ".join(f"{n} {t:.0f}" for n, t in shares.items() if n))


def main() -> None:
    with (
        tempfile.TemporaryDirectory() as folder,
        running_studio(Path(folder)) as studio,
        chromium() as browser,
    ):
        report(studio, browser)


if __name__ == "__main__":
    main()
