"""Table and summary of a comparison as text."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dalembert.results.comparison.data import BETWEEN
from dalembert.results.status import Outcome

if TYPE_CHECKING:
    import pandas as pd

    from dalembert.results.comparison.data import ComparisonData

TARGETS = (1e-3, 1e-6, 1e-9)
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Column:
    """A column of the table; columns of rank 0 stay if the width is limited."""

    heading: str
    cell: Callable[[Row], str]
    rank: int = 0
    text: bool = False


def brief(value: float, digits: int = 0) -> str:
    """``2.1e-6``."""
    return f"{value:.{digits}e}".replace("e-0", "e-").replace("e+0", "e")


def setting(row: Row) -> str:
    """``h = 0.01 s`` or ``tol 1e-6``."""
    if not math.isnan(row["tolerance"]):
        return f"tol {brief(row['tolerance'])}"
    return "" if math.isnan(row["step"]) else f"h = {row['step']:g} s"


def _name(kind: str) -> Callable[[Row], str]:
    return lambda row: row[kind].replace("Coordinates", "") if kind == "coordinates" else row[kind]


def _size(name: str, digits: int = 0) -> Callable[[Row], str]:
    return lambda row: "" if math.isnan(row[name]) else brief(row[name], digits)


def _count(name: str) -> Callable[[Row], str]:
    return lambda row: "" if math.isnan(row[name]) else str(int(row[name]))


def _time(name: str, factor: float) -> Callable[[Row], str]:
    def cell(row: Row) -> str:
        value = factor * row[name]
        return "" if math.isnan(value) else f"{value:.3g}" if value < 100 else f"{value:.0f}"

    return cell


def notes(comparison: ComparisonData) -> list[str]:
    """Reasons of failed runs, and warnings of runs, each text once."""
    table = comparison.table()
    failures = [str(message) for message in table[~comparison.finished]["message"]]
    warnings = [text for row in table["warnings"] for text in row.split(BETWEEN) if text]
    return list(dict.fromkeys([*failures, *warnings]))


def columns(comparison: ComparisonData) -> list[Column]:
    """Columns of the table without strategies that are equal in all rows."""
    data, footnotes = comparison.data, notes(comparison)
    floor = comparison.uncertainty

    def varies(name: str) -> bool:
        return len(set(data[name].values)) > 1

    def error(row: Row) -> str:
        if math.isnan(row["error_position"]):
            return ""
        return ("≤" if row["below_uncertainty"] else "") + brief(
            max(row["error_position"], floor), 1
        )

    def status(row: Row) -> str:
        texts = [text for text in row["warnings"].split(BETWEEN) if text]
        word = "ok"
        if row["outcome"] != Outcome.COMPLETED.value:
            word = row["outcome"].removesuffix("Error").partition(":")[0].lower()
            texts.insert(0, row["message"])
        return " ".join([word, *(f"[{footnotes.index(text) + 1}]" for text in texts)])

    strategies = [
        Column(name, _name(name), 0, True)
        for name in ("formulation", "coordinates", "stabilization", "integrator")
        if varies(name) or name == "integrator"
    ]
    return [
        *strategies,
        Column("setting", setting, 0, True),
        Column("steps", _count("steps"), 4),
        Column("rejected", _count("rejected"), 6),
        Column("time [ms]", _time("time", 1e3)),
        Column("µs/step", _time("time_per_step", 1), 3),
        Column("prep. [ms]", _time("preparation", 1e3), 7),
        Column("violation", _size("position_violation"), 1),
        Column("of speeds", _size("velocity_violation"), 8),
        Column("energy", _size("energy_error"), 2),
        Column("error", error),
        Column("of speeds", _size("error_velocity", 1), 5),
        Column("of forces", _size("error_reaction", 1), 9),
        Column("status", status, 0, True),
    ]


def cells(
    comparison: ComparisonData, width: int | None = None
) -> tuple[list[Column], list[list[str]]]:
    """Columns and their cells by row; columns of higher rank are dropped to fit ``width``."""
    available = columns(comparison)
    rows = [row.to_dict() for _, row in comparison.table().iterrows()]
    texts = [[column.cell(row) for row in rows] for column in available]
    sizes = [max(map(len, [c.heading, *f])) + 2 for c, f in zip(available, texts, strict=True)]
    visible = sorted(range(len(available)), key=lambda k: available[k].rank)
    while (
        width is not None and available[visible[-1]].rank and sum(sizes[k] for k in visible) > width
    ):
        visible.pop()
    visible.sort()
    return [available[k] for k in visible], [
        [texts[k][r] for k in visible] for r in range(len(rows))
    ]


def title(comparison: ComparisonData) -> str:
    """Title: model, time span and common strategies."""
    data = comparison.data
    shared = [
        str(data[name].values[0])
        for name in ("formulation", "coordinates", "stabilization")
        if len(set(data[name].values)) == 1
    ]
    attributes = data.attrs
    return ", ".join(
        [f"{attributes['model']}, {attributes['start']:g}…{attributes['end']:g} s", *shared]
    )


def summary(comparison: ComparisonData) -> list[str]:
    """The main findings of the table, in a few sentences."""
    attributes = comparison.data.attrs
    unit = f" [{attributes['measure_unit']}]" if attributes["measure_unit"] else ""
    floor = comparison.uncertainty
    lines = [
        f"error: of {attributes['measure']}{unit}, maximum over the run",
        f"reference: {attributes['reference']}; they differ by {brief(floor, 1)}",
    ]
    for target in TARGETS:
        best = comparison.fastest(target) if target > floor else None
        if best is not None:
            lines.append(f"best at error {brief(target)}: {_describe_run(comparison, best)}")
    orders = comparison.orders()
    if len(orders):
        groups = orders.groupby("integrator", sort=False)["order"]
        parts = [f"{name} {_range(values)}" for name, values in groups]
        lines.append(f"observed order: {', '.join(parts)}")
    failed = int((~comparison.finished).sum())
    if failed:
        lines.append(f"{failed} of {comparison.data.sizes['run']} runs did not finish")
    if not comparison.complete:
        lines.append("interrupted before all runs were completed")
    return lines


def _describe_run(comparison: ComparisonData, row: Row) -> str:
    names = [
        row[name]
        for name in ("integrator", "formulation", "coordinates", "stabilization")
        if name == "integrator" or len(set(comparison.data[name].values)) > 1
    ]
    error = max(row["error_position"], comparison.uncertainty)
    return (
        f"{', '.join(names)}, {setting(row)}: {1e3 * row['time']:.3g} ms (error {brief(error, 1)})"
    )


def _range(values: pd.Series) -> str:
    low, high = f"{values.min():.1f}", f"{values.max():.1f}"
    return low if low == high else f"{low}–{high}"


def html_table(comparison: ComparisonData) -> str:
    """Table and summary for notebooks."""
    header, rows = cells(comparison)
    head = "".join(f"<th>{html.escape(c.heading)}</th>" for c in header)
    body = "".join(
        "<tr>"
        + "".join(
            f'<td style="text-align:{"left" if c.text else "right"}">{html.escape(cell)}</td>'
            for c, cell in zip(header, row, strict=True)
        )
        + "</tr>"
        for row in rows
    )
    footnotes = [f"[{k}] {text}" for k, text in enumerate(notes(comparison), 1)]
    lines = "".join(f"<li>{html.escape(line)}</li>" for line in [*summary(comparison), *footnotes])
    return (
        f"<p><b>{html.escape(title(comparison))}</b></p><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{body}</tbody></table><ul>{lines}</ul>"
    )
