"""Journal of verdicts: one JSON line each, so that an interrupted run can be resumed."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from stress.verdict import DEFECTS, SOUND, Verdict


class Journal:
    """Verdicts on disk.

    Parameters
    ----------
    path : of the JSON-lines file; kept in memory only where None
    """

    def __init__(self, path: Path | None):
        self.path, self.verdicts = path, {}
        for line in path.read_text(encoding="utf-8").splitlines() if path and path.exists() else ():
            try:
                verdict = Verdict(**json.loads(line))
            except (ValueError, TypeError):
                continue  # a line that a kill has cut
            self.verdicts[verdict.family, verdict.seed] = verdict

    def add(self, verdict: Verdict) -> None:
        self.verdicts[verdict.family, verdict.seed] = verdict
        if self.path:
            with self.path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps(verdict.row) + "\n")

    def remaining(self, tasks: Iterable[tuple[str, int]]) -> list[tuple[str, int]]:
        return [task for task in tasks if task not in self.verdicts]

    def of(self, tasks: Iterable[tuple[str, int]]) -> list[Verdict]:
        return [self.verdicts[task] for task in tasks if task in self.verdicts]


def table(verdicts: Iterable[Verdict]) -> str:
    """Counts by family and kind, and seconds: median and maximum."""
    rows: dict[str, list[Verdict]] = {}
    for verdict in verdicts:
        rows.setdefault(verdict.family, []).append(verdict)
    kinds = (*SOUND, *DEFECTS)
    lines = [f"{'family':10}" + "".join(f"{k:>15}" for k in (*kinds, "median [s]", "max [s]"))]
    for family, judged in rows.items():
        counts, times = Counter(v.kind for v in judged), sorted(v.seconds for v in judged)
        cells = [*(str(counts[k]) for k in kinds), f"{times[len(times) // 2]:.2f}"]
        lines.append(f"{family:10}" + "".join(f"{c:>15}" for c in (*cells, f"{times[-1]:.1f}")))
    return "\n".join(lines)
