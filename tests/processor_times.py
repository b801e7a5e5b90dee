"""Processor time of each test with all processes that it starts: ``pytest --processor-times``."""

from __future__ import annotations

import os
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

NAME = "processor time"
"""Name of the property of a report, in seconds."""
TICKS = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100


def processor_time() -> float:
    """Seconds of this process, its running descendants and all descendants that ended."""
    times = os.times()
    total = times.user + times.system + times.children_user + times.children_system
    if sys.platform == "linux":
        total += sum(_ticks(child) for child in descendants(os.getpid())) / TICKS
    return total


def descendants(process: int) -> Iterator[int]:
    """Processes that a process has started, and theirs; on Linux."""
    try:
        for task in os.listdir(f"/proc/{process}/task"):
            for child in Path(f"/proc/{process}/task/{task}/children").read_text().split():
                yield int(child)
                yield from descendants(int(child))
    except OSError:  # ended meanwhile
        return


def _ticks(process: int) -> int:
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0
    return sum(int(ticks) for ticks in fields[11:15])


class ProcessorTimes:
    """Plugin that measures tests, in workers too, and lists the files at the end."""

    def __init__(self, path: Path | None):
        if path and path.suffix == ".py":
            raise pytest.UsageError(f"times would replace {path}; write --processor-times=FILE")
        self.path = path
        self.tests: dict[str, float] = defaultdict(float)
        self.start = 0.0
        if path and "PYTEST_XDIST_WORKER" not in os.environ:
            path.write_text("")

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.start = processor_time()
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self) -> Iterator[None]:
        report: Any = yield
        now = processor_time()
        spent = max(0.0, now - self.start)  # programs that no process awaits end uncounted
        report.user_properties = [*report.user_properties, (NAME, spent)]
        self.start = now
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if "PYTEST_XDIST_WORKER" in os.environ:
            return
        seconds = float(dict(report.user_properties).get(NAME, 0.0))
        self.tests[report.nodeid] += seconds
        if report.when == "teardown" and self.path:
            with self.path.open("a") as file:
                file.write(f"{self.tests[report.nodeid]:.3f}\t{report.nodeid}\n")

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        files: dict[str, list[float]] = defaultdict(list)
        for test, seconds in self.tests.items():
            files[test.partition("::")[0]].append(seconds)
        total = sum(self.tests.values())
        terminalreporter.section(f"processor time: {total:.0f} s")
        for file, times in sorted(files.items(), key=lambda pair: -sum(pair[1]))[:40]:
            terminalreporter.line(f"{sum(times):8.1f} s {len(times):6} tests  {file}")
