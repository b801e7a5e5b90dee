"""Benchmark tables in Markdown and their place in the documentation."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from pathlib import Path

from benchmarks.sample import Row, Sample

BEGIN, END = "<!-- benchmarks -->", "<!-- end: benchmarks -->"
OURS = "dalembert"
RATIO = "best peer ÷ dalembert"


def markdown(rows: Sequence[Row], facts: Iterable[str]) -> str:
    """Facts about the machine, then one table for each group of cases with the same solvers."""
    tables = [_table(list(group)) for _, group in groupby(rows, key=_solvers_of_cases(rows))]
    return "\n\n".join(["\n".join(f"- {fact}" for fact in facts), *tables])


def ratio(row: Row) -> float | None:
    """Time of the fastest peer divided by the time of dalembert; below 1 the peer is faster."""
    ours = _best(s for name, s in row.samples.items() if name.startswith(OURS))
    peers = _best(s for name, s in row.samples.items() if not name.startswith(OURS))
    return peers / ours if ours and peers else None


def ratio_text(row: Row) -> str:
    """The ratio with three digits, such as ``1,170``; empty without a peer."""
    value = ratio(row)
    return f"{float(f'{value:.3g}'):,g}" if value else ""


def _solvers_of_cases(rows: Sequence[Row]):
    """A function that returns the solvers with a sample in any row of the case of a row."""
    solvers: dict[str, dict[str, None]] = {}
    for row in rows:
        solvers.setdefault(row.case, {}).update(dict.fromkeys(row.samples))
    return lambda row: sorted(solvers[row.case], key=lambda name: not name.startswith(OURS))


def _table(rows: Sequence[Row]) -> str:
    solvers = list(_solvers_of_cases(rows)(rows[0]))
    compared = any(ratio(row) for row in rows)
    head = ["case", "quantity", *solvers, *([RATIO] if compared else [])]
    lines = [_line(head), _line(["---"] * len(head))]
    previous = ""
    for row in rows:
        case, previous = ("" if row.case == previous else row.case), row.case
        cells = [str(row.samples.get(solver, "")) for solver in solvers]
        lines.append(_line([case, row.quantity, *cells, *([ratio_text(row)] * compared)]))
    return "\n".join(lines)


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _best(samples: Iterable[Sample]) -> float | None:
    """Smallest median of the solvers that reached the requested error."""
    return min((s.median for s in samples if "only" not in s.note), default=None)


def update(page: Path, text: str) -> None:
    """Put the tables between their markers.

    Raises
    ------
    SystemExit
        The page has no markers.
    """
    old = page.read_text(encoding="utf-8")
    if not (BEGIN in old and END in old.partition(BEGIN)[2]):
        raise SystemExit(f"{page}: has no lines {BEGIN} and {END}; add them where the tables go")
    before, _, rest = old.partition(BEGIN)
    after = rest.partition(END)[2]
    page.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}", encoding="utf-8")
