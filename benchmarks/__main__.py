"""Measure dalembert beside its peers and print tables.

    pip install "dalembert[bench]"
    python -m benchmarks                        everything, an hour or so
    python -m benchmarks arm loop               these cases
    python -m benchmarks --quick                small sizes, a minute
    python -m benchmarks --update-docs          tables and chart of the documentation

Peers that are not installed are left out. Motions are compared at equal measured error of one point
of the mechanism, against a reference that is not that of the contestant where there is one.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.cases.all import CASES
from benchmarks.cases.base import Effort
from benchmarks.machine import facts
from benchmarks.picture import speed_chart
from benchmarks.sample import Row
from benchmarks.solvers.ours import fastest
from benchmarks.table import markdown, update
from dalembert.symbolic.evaluation.backends import BACKENDS

ROOT = Path(__file__).parents[1]


def main(arguments: list[str] | None = None) -> int:
    about = (__doc__ or "").split("\n")[0]
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=about)
    parser.add_argument("cases", nargs="*", metavar="CASE", help=", ".join(c.name for c in CASES))
    parser.add_argument("--quick", action="store_true", help="small sizes, to see that it works")
    parser.add_argument("--rounds", type=int, default=5, help="repetitions of every measurement")
    parser.add_argument("--limit", type=float, default=20.0, help="seconds that one run may take")
    parser.add_argument("--sizes", type=int, default=1000, help="largest number of four-bars …")
    parser.add_argument("--backend", nargs="+", default=None, choices=sorted(BACKENDS))
    parser.add_argument("--output", type=Path, default=ROOT / "benchmark-results")
    parser.add_argument("--update-docs", action="store_true", help="renew docs/benchmarks.md")
    given = parser.parse_args(arguments)
    known = {case.name: case for case in CASES}
    if unknown := [name for name in given.cases if name not in known]:
        parser.error(f"no case {', '.join(unknown)}; there are {', '.join(known)}")
    effort = Effort(
        rounds=2 if given.quick else given.rounds,
        limit=0.5 if given.quick else given.limit,
        sizes=given.sizes,
        quick=given.quick,
        backends=tuple(given.backend or (["vm"] if given.quick else fastest())),
        pictures=given.output,
    )
    rows: list[Row] = []
    given.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as empty:
        os.environ["DALEMBERT_CACHE"] = empty  # nothing is compiled beforehand
        for name in given.cases or known:
            for row in known[name].measure(effort):
                rows.append(row)
                shown = "; ".join(f"{solver} {sample}" for solver, sample in row.samples.items())
                print(f"{row.case}, {row.quantity}: {shown}", flush=True)
    text = markdown(rows, facts(effort.rounds))
    (given.output / "table.md").write_text(text + "\n", encoding="utf-8")
    print(f"\n{text}")
    if given.update_docs:
        update(ROOT / "docs" / "benchmarks.md", text)
        speed_chart(rows, ROOT / "docs" / "gallery" / "speed.svg")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
