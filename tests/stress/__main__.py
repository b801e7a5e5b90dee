"""``python -m tests.stress``: try thousands of cases and report every defect with its seed."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import tests.stress  # noqa: F401  puts the folder of the tests on the path
from stress.families import FAMILIES, judge
from stress.journal import Journal, table
from stress.verdict import Verdict
from stress.workers import Task, in_this_process, verdicts

SPATIAL = 3
"""One in so many mechanisms is spatial."""


def parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m tests.stress", description=__doc__)
    parser.add_argument("--mechanisms", type=int, default=0, help="planar and spatial, 2 : 1")
    parser.add_argument("--models", type=int, default=0, help="flexible and contact, 1 : 1")
    parser.add_argument("--numbers", type=int, default=0, help="extreme numbers")
    parser.add_argument("--files", type=int, default=0, help="hostile files")
    parser.add_argument("--first", type=int, default=100_000, help="first seed")
    parser.add_argument("--only", nargs="*", default=[], metavar="FAMILY:SEED", help="these cases")
    parser.add_argument("--workers", type=int, default=1, help="processes; 0: in this process")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds for a case")
    parser.add_argument("--journal", type=Path, help="JSON lines; an existing one is resumed")
    return parser


def tasks(settings: argparse.Namespace) -> list[Task]:
    """Families take turns, so that an interrupted run has tried some of each."""
    counts = {
        "planar": settings.mechanisms - settings.mechanisms // SPATIAL,
        "spatial": settings.mechanisms // SPATIAL,
        "flexible": settings.models - settings.models // 2,
        "contact": settings.models // 2,
        "numbers": settings.numbers,
        "files": settings.files,
    }
    ranked = [
        ((k + 0.5) / count, family, settings.first + k)
        for family, count in counts.items()
        for k in range(count)
    ]
    chosen = [one.rsplit(":", 1) for one in settings.only]
    return [
        *((family, int(seed)) for family, seed in chosen),
        *((family, seed) for _, family, seed in sorted(ranked)),
    ]


def shown(verdicts_so_far: Iterator[Verdict], total: int) -> Iterator[Verdict]:
    """The same, with defects and progress on standard error."""
    begin, last = time.monotonic(), 0.0
    for k, verdict in enumerate(verdicts_so_far, 1):
        if not verdict.sound:
            print(verdict, file=sys.stderr, flush=True)
        now = time.monotonic()
        if now - last > 10:
            last, left = now, (total - k) * (now - begin) / k
            print(f"{k} of {total}, about {left / 60:.0f} min left", file=sys.stderr, flush=True)
        yield verdict


def main(arguments: Sequence[str] | None = None) -> int:
    """0: every case is sound; 1: some are not; 130: interrupted."""
    options = parser().parse_args(arguments)
    every, journal, code = tasks(options), Journal(options.journal), 0
    if not every or any(family not in FAMILIES for family, _ in every):
        parser().error("choose how many cases, e.g. --mechanisms 100, or --only planar:7")
    left = journal.remaining(every)
    computed = (
        verdicts(left, judge, options.workers, options.limit)
        if options.workers
        else in_this_process(left, judge)
    )
    try:
        for verdict in shown(computed, len(left)):
            journal.add(verdict)
    except KeyboardInterrupt:
        print("interrupted; the same command with --journal resumes", file=sys.stderr)
        code = 130
    done = journal.of(every)
    print(table(done))
    defects = [verdict for verdict in done if not verdict.sound]
    for verdict in defects:
        print(verdict)
    print(f"{len(done)} of {len(every)} cases, {len(defects)} defects")
    return code or int(bool(defects))


if __name__ == "__main__":
    sys.exit(main())
