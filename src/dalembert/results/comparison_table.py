"""A comparison in words: cells of its table for people, and a summary."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dalembert.results.status import Outcome

if TYPE_CHECKING:
    from dalembert.results.comparison import Comparison

TARGETS = (1e-3, 1e-6, 1e-9)
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Column:
    """A column for people; those of the lowest ``rank`` stay where space is short."""

    heading: str
    cell: Callable[[Row], str]
    rank: int = 0
    text: bool = False


def setting(row: Row) -> str:
    """``h = 0.01 s`` or ``tol 1e-06``."""
    if not math.isnan(row["step"]):
        return f"h = {row['step']:g} s"
    return "" if math.isnan(row["tolerance"]) else f"tol {row['tolerance']:.0e}"


def _number(name: str, form: str, factor: float = 1.0) -> Callable[[Row], str]:
    def cell(row: Row) -> str:
        return "" if math.isnan(row[name]) else format(factor * row[name], form)

    return cell


def _count(name: str) -> Callable[[Row], str]:
    return lambda row: "" if math.isnan(row[name]) else str(int(row[name]))


def _milliseconds(name: str) -> Callable[[Row], str]:
    def cell(row: Row) -> str:
        value = 1e3 * row[name]
        return "" if math.isnan(value) else f"{value:.3g}" if value < 100 else f"{value:.0f}"

    return cell


def notes(comparison: Comparison) -> list[str]:
    """Why runs did not finish, each reason once."""
    failed = comparison.table()[~comparison.finished]
    return list(dict.fromkeys(str(message) for message in failed["message"]))


def columns(comparison: Comparison) -> list[Column]:
    """Columns of the table; strategies that are the same in all rows are left out."""
    data, reasons = comparison.data, notes(comparison)
    floor = comparison.uncertainty

    def varies(name: str) -> bool:
        return len(set(data[name].values)) > 1

    def error(row: Row) -> str:
        if math.isnan(row["error_position"]):
            return ""
        return f"≤{floor:.1e}" if row["below_uncertainty"] else f"{row['error_position']:.1e}"

    def status(row: Row) -> str:
        if row["outcome"] == Outcome.COMPLETED.value:
            return "ok"
        return f"{row['outcome'].removesuffix('Error').lower()} [{reasons.index(row['message']) + 1}]"

    strategies = [
        Column(name, lambda row, name=name: row[name], 0, True)
        for name in ("formulation", "coordinates", "stabilization", "integrator")
        if varies(name) or name == "integrator"
    ]
    return [
        *strategies,
        Column("setting", setting, 0, True),
        Column("steps", _count("steps")),
        Column("rejected", _count("rejected"), 2),
        Column("time [ms]", _milliseconds("time")),
        Column("µs/step", _number("time_per_step", ".3g"), 1),
        Column("prep. [ms]", _milliseconds("preparation"), 2),
        Column("violation", _number("position_violation", ".0e"), 1),
        Column("of speeds", _number("velocity_violation", ".0e"), 3),
        Column("energy", _number("energy_error", ".0e"), 1),
        Column("error", error),
        Column("of speeds", _number("error_velocity", ".1e"), 2),
        Column("of forces", _number("error_reaction", ".1e"), 3),
        Column("status", status, 0, True),
    ]


def cells(comparison: Comparison, width: int | None = None) -> tuple[list[Column], list[list[str]]]:
    """Columns and their cells by row; columns that matter less give way to ``width``."""
    chosen = columns(comparison)
    rows = [row.to_dict() for _, row in comparison.table().iterrows()]
    found = [[column.cell(row) for row in rows] for column in chosen]
    sizes = [max(map(len, [c.heading, *f])) + 3 for c, f in zip(chosen, found, strict=True)]
    rank = max(c.rank for c in chosen)
    kept = range(len(chosen))
    while width is not None and rank > 0 and sum(sizes[k] for k in kept) + 1 > width:
        rank -= 1
        kept = [k for k in kept if chosen[k].rank <= rank]  # type: ignore[assignment]
    return [chosen[k] for k in kept], [[found[k][r] for k in kept] for r in range(len(rows))]


def title(comparison: Comparison) -> str:
    """What is compared, with what all rows share."""
    data = comparison.data
    shared = [
        str(data[name].values[0])
        for name in ("formulation", "coordinates", "stabilization")
        if len(set(data[name].values)) == 1
    ]
    a = data.attrs
    return ", ".join([f"{a['model']}, {a['start']:g}…{a['end']:g} s", *shared])


def summary(comparison: Comparison) -> list[str]:
    """What the table says, in a few sentences."""
    a = comparison.data.attrs
    unit = f" [{a['measure_unit']}]" if a["measure_unit"] else ""
    floor = comparison.uncertainty
    lines = [
        f"error: of {a['measure']}{unit}, largest over the run",
        f"reference: {a['reference']}; they differ by {floor:.1e}",
    ]
    for target in TARGETS:
        best = comparison.fastest(target) if target > floor else None
        if best is not None:
            lines.append(f"best at error {target:.0e}: {_told(comparison, best)}")
    orders = comparison.orders()
    if len(orders):
        found = orders.groupby("integrator", sort=False)["order"]
        parts = [f"{name} {_range(values)}" for name, values in found]
        lines.append(f"order seen in the errors: {', '.join(parts)}")
    failed = int((~comparison.finished).sum())
    if failed:
        lines.append(f"{failed} of {comparison.data.sizes['run']} runs did not finish")
    if not comparison.complete:
        lines.append(f"interrupted; {a['asked']} runs were asked for")
    return lines


def _told(comparison: Comparison, row: Row) -> str:
    names = [
        row[name]
        for name in ("integrator", "formulation", "coordinates", "stabilization")
        if name == "integrator" or len(set(comparison.data[name].values)) > 1
    ]
    error = max(row["error_position"], comparison.uncertainty)
    return f"{', '.join(names)}, {setting(row)}: {1e3 * row['time']:.3g} ms (error {error:.1e})"


def _range(values: Any) -> str:
    low, high = f"{values.min():.1f}", f"{values.max():.1f}"
    return low if low == high else f"{low}–{high}"


def html_table(comparison: Comparison) -> str:
    """Table and summary for notebooks."""
    chosen, rows = cells(comparison)
    head = "".join(f"<th>{html.escape(c.heading)}</th>" for c in chosen)
    body = "".join(
        "<tr>"
        + "".join(
            f'<td style="text-align:{"left" if c.text else "right"}">{html.escape(cell)}</td>'
            for c, cell in zip(chosen, row, strict=True)
        )
        + "</tr>"
        for row in rows
    )
    reasons = [f"[{k}] {text}" for k, text in enumerate(notes(comparison), 1)]
    lines = "".join(
        f"<li>{html.escape(line)}</li>" for line in [*comparison.summary(), *reasons]
    )
    return (
        f"<p><b>{html.escape(title(comparison))}</b></p><table><thead><tr>{head}</tr></thead>"
        f"<tbody>{body}</tbody></table><ul>{lines}</ul>"
    )
