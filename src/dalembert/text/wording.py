"""Text for terminals, result files, pages and notebooks, and suggestions for unknown names.

``RENAMED`` lists the former public names and their successors.
"""

from __future__ import annotations

import difflib
import html
import json
import math
import re
from collections.abc import Iterable, Sequence
from typing import Any

from dalembert.errors import ModelError
from dalembert.remedies import Advice, Rename

HIDDEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]"
)
"""Control characters except tab and newline, direction marks, Unicode line separators, lone
surrogates."""


LONGEST_NAME = 200
"""Upper limit of the length of a name; tables, pages and files repeat it for every quantity."""
MOST = 24
"""Upper limit of the number of names in a message."""


def visible(text: str) -> str:
    """The text with invisible and control characters escaped as ``\\x1b``, ``\\u202e``."""
    return HIDDEN.sub(lambda match: match[0].encode("unicode_escape").decode(), text)


def check_length(name: str, owner: str) -> None:
    """Refuse a name that is too long for tables and pages.

    Raises
    ------
    ModelError
        States the first characters, the length and the limit.
    """
    if len(name) > LONGEST_NAME:
        raise ModelError(
            f"the name '{visible(name[:40])}…' has {len(name)} characters; {LONGEST_NAME} at most",
            owner,
        )


def plain_text(text: Any, entity: str) -> str:
    """Check that a value is a text without hidden characters.

    Raises
    ------
    ModelError
        Not a text, or a hidden character; names the entity and the character.
    """
    if not isinstance(text, str):
        raise ModelError(f"expected a text, got {text!r:.60}", entity)
    match = HIDDEN.search(text)
    if match:
        raise ModelError(
            f"the text '{visible(text[:60])}' has the hidden character U+{ord(match[0]):04X} at "
            f"place {match.start() + 1}; remove it",
            visible(entity),
        )
    return text


def as_document(data: Any) -> str:
    """JSON text; numbers that are not finite are null, hidden characters escaped."""
    text = json.dumps(plain(data), indent=2, ensure_ascii=False, allow_nan=False)
    return HIDDEN.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def plain(data: Any) -> Any:
    """Data converted to built-in types."""
    if isinstance(data, dict):
        return {str(key): plain(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [plain(item) for item in data]
    if hasattr(data, "tolist"):
        return plain(data.tolist())
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    return data if data is None or isinstance(data, (bool, int, str)) else str(data)


PLURAL = re.compile(r"ies$")
"""End of the plural of a name that ends with y."""
SIMILAR, NEAREST = 0.4, 0.5
"""Minimum similarity of several suggested names, and of a single one: one wrong letter of two."""
WORD = re.compile(r"[^\W_]{3,}")
"""A word of a name; words are separated by underscores, points or spaces."""


def similar(
    name: Any, known: Iterable[str], count: int = 3, similarity: float = SIMILAR
) -> list[str]:
    """The known names that are similar to a name, the nearest first."""
    return difflib.get_close_matches(str(name)[:80], list(known), count, similarity)


def suggestions(name: Any, known: Iterable[str]) -> str:
    """``; nearest: …`` with the similar known names, or ``; known: …`` with the first of all."""
    names = list(known)
    close = similar(name, names)
    return f"; nearest: {', '.join(close)}" if close else f"; known: {listed(names)}"


def nearest(name: Any, known: Iterable[str]) -> str:
    """``(did you mean …?)`` with the nearest known name, if one is close; renamed ones first."""
    names = list(known)
    right = _nearest(name, names)
    if not right:
        return ""
    return f" (renamed: {right!r})" if successor(name, names) else f" (did you mean {right!r}?)"


def _nearest(name: Any, names: list[str]) -> str:
    """The nearest known name, if one is close; empty otherwise."""
    close = (known for known in similar(name, names, 3, NEAREST) if _is_slip(str(name), known))
    return successor(name, names) or next(close, "")


def _is_slip(name: str, known: str) -> bool:
    """Whether few letters differ, or a name abbreviates or contains the other, or a word of it."""
    if name in known or known in name:
        return True
    if PLURAL.sub("y", name) == PLURAL.sub("y", known):
        return True
    if {*WORD.findall(name)} & {*WORD.findall(known)}:
        return True
    blocks = difflib.SequenceMatcher(None, name, known).get_matching_blocks()
    longest = max(len(name), len(known))
    return longest - sum(block.size for block in blocks) <= max(1, longest // 3)


def misspelt(before: str, name: Any, known: Iterable[str], after: str, is_key: bool = False) -> str:
    """A message about an unknown name, with the nearest known one between its parts.

    Parameters
    ----------
    before, after : parts of the message
    name : unknown name
    known : names that may be meant
    is_key : whether it is the key of its entry

    Returns
    -------
    The message as ``Advice`` to write the nearest name
    """
    names = list(known)
    text = f"{before}{nearest(name, names)}{after}"
    right = _nearest(name, names)
    remedy = Rename(wrong="" if is_key else str(name), right=right)
    return Advice(text, [remedy] if right else ())


def unknown(kind: str, name: Any, known: Iterable[str]) -> str:
    """``unknown body 'crnk' (did you mean 'crank'?); known: ground, crank``."""
    names = list(known)
    return misspelt(f"unknown {kind} {name!r}", name, names, f"; known: {listed(names)}")


def no_attribute(module: str, name: str, known: Iterable[str]) -> str:
    """``module 'dalembert' has no attribute 'Optimum' (renamed: 'OptimizationResult')``."""
    return f"module {module!r} has no attribute {name!r}{nearest(name, known)}"


def counted(count: int, noun: str) -> str:
    """A count with its noun, such as ``1 iteration`` or ``3 iterations``."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def listed(names: Iterable[str]) -> str:
    """The first names, separated by commas."""
    names = list(names)
    return (", ".join(names[:MOST]) + (", …" if len(names) > MOST else "")) or "none"


COLOURS = {"info": "#5a6774", "warning": "#8a5a00", "error": "#b3261e"}


def card(title: str, sentence: str, *parts: str) -> str:
    """A title, a sentence and further HTML below."""
    head = f"<b>{escaped(title)}</b> <span style='opacity:.75'>{escaped(sentence)}</span>"
    return f"<div style='margin:.4em 0'>{head}{''.join(parts)}</div>"


def table(rows: Iterable[Sequence[Any]], head: Sequence[str] = ()) -> str:
    """Table whose first column holds names; an empty text without rows."""
    cells = [[escaped(display_text(cell)) for cell in row] for row in rows]
    if not cells:
        return ""
    align = "style='text-align:left'"
    header = "".join(f"<th {align}>{escaped(name)}</th>" for name in head)
    body = "".join(
        f"<tr><th {align}>{row[0]}</th>{''.join(f'<td {align}>{c}</td>' for c in row[1:])}</tr>"
        for row in cells
    )
    header = f"<thead><tr>{header}</tr></thead>" if header else ""
    return f"<table>{header}<tbody>{body}</tbody></table>"


def messages(entries: Iterable[tuple[str, str]]) -> str:
    """Lines of (level, text), coloured by level."""
    return "".join(
        f"<div style='color:{COLOURS.get(level, COLOURS['info'])}'>{level}: {escaped(text)}</div>"
        for level, text in entries
    )


def folded(name: str, content: str) -> str:
    """Content that is hidden until the reader opens it."""
    return f"<details><summary>{escaped(name)}</summary>{content}</details>"


def display_text(value: Any) -> str:
    """A value as text; numbers with six digits."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def escaped(text: str) -> str:
    """Text with HTML escapes."""
    return html.escape(visible(text))


RENAMED: dict[str, str] = {
    # elements of the plane
    "Moment": "Torque",
    "RotationalSpring": "TorsionSpring",
    "Translational": "Prismatic",
    # strategies and responses
    "Bdf": "BDF",
    "Ccsaq": "CCSAQ",
    "CmaEs": "CMAES",
    "Cvodes": "CVODES",
    "Dae": "DAE",
    "Ida": "IDA",
    "Kkt": "KKT",
    "Mma": "MMA",
    "Rms": "RMS",
    "Slsqp": "SLSQP",
    # design tasks
    "Design": "DesignTable",
    "Front": "ParetoResult",
    "History": "InputHistory",
    "Identification": "IdentificationResult",
    "Inversion": "InversionResult",
    "OptimalTrajectory": "TrajectoryResult",
    "Optimum": "OptimizationResult",
    "Reliability": "ReliabilityResult",
    "ReliableOptimum": "ReliableOptimizationResult",
    "Study": "SweepResult",
    "Synthesis": "SynthesisResult",
    "Toleranced": "ToleranceResult",
    # analyses
    "Linearization": "Modal",
    "NonlinearStatics": "Equilibrium",
    "Transient": "Dynamics",
    # functions and variables
    "history": "input_history",
    "table": "Interpolation",
    "u": "curves.u",
    # methods and attributes of results
    "allotted": "allocated",
    # keywords, methods and keys of files
    "allot": "allocate",
    "apart": "minimum_distance",
    "given": "inputs",
    "least_crank": "minimum_crank_ratio",
    "least_radius": "minimum_radius",
    "rescued": "ipopt_fallback",
}
"""Former name → present name; each is unique among the names of its place."""


def successor(name: object, known: Iterable[str]) -> str | None:
    """The present name of a former one, if it is known where the former one was used."""
    new = RENAMED.get(name) if isinstance(name, str) else None
    return new if new and new.partition(".")[0] in known else None
