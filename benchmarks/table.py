"""The table, in Markdown, and its place in the readme."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.sample import Row, Sample

BEGIN, END = "<!-- benchmarks -->", "<!-- end: benchmarks -->"
OURS = "dalembert"


def markdown(rows: Sequence[Row], facts: Iterable[str]) -> str:
    """Facts about the run, then a line for each row; the last column says who is ahead."""
    solvers = list(dict.fromkeys(name for row in rows for name in row.samples))
    solvers.sort(key=lambda name: not name.startswith(OURS))
    head = ["case", "quantity", *solvers, "best peer ÷ best of ours"]
    lines = [_line(head), _line(["---"] * len(head))]
    for row in rows:
        cells = [str(row.samples[s]) if s in row.samples else "" for s in solvers]
        lines.append(_line([row.case, row.quantity, *cells, _ratio(row)]))
    return "\n".join([*(f"- {fact}" for fact in facts), "", *lines])


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _ratio(row: Row) -> str:
    """Below one where a peer is ahead."""
    ours = _best(s for name, s in row.samples.items() if name.startswith(OURS))
    theirs = _best(s for name, s in row.samples.items() if not name.startswith(OURS))
    return f"{theirs / ours:.3g}" if ours and theirs else ""


def _best(samples: Iterable[Sample]) -> float | None:
    """The smallest; of who has reached what was asked for."""
    return min((s.median for s in samples if "only" not in s.note), default=None)


def update(readme: Path, text: str) -> None:
    """Put the table between its markers.

    Raises
    ------
    SystemExit
        There are none.
    """
    old = readme.read_text(encoding="utf-8")
    if not (BEGIN in old and END in old.partition(BEGIN)[2]):
        raise SystemExit(f"{readme}: has no lines {BEGIN} and {END}; add them where the table goes")
    before, _, rest = old.partition(BEGIN)
    after = rest.partition(END)[2]
    readme.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")
