"""Analysis that is shown without being written into the text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

from dalembert.analysis.explore import DURATION, OUTPUTS
from dalembert.errors import DalembertError, ModelError
from dalembert.io.fields import keyed_fields
from dalembert.io.strategies import ANALYSES, STRUCTURAL_ANALYSES
from dalembert.io.toml_places import line_and_column
from dalembert.studio.common_ends import common_ends
from dalembert.studio.drawing_edits import apply
from dalembert.studio.problems import Problem
from dalembert.text.wording import unknown

TIMES = ("duration", "t_span", "outputs")
"""Keys that analyses of other types share."""


def section_operation(section: str, fields: Any) -> dict[str, Any]:
    """Operation that changes keys of a section."""
    return {"op": "section", "section": section, "fields": fields}


def analysis_fields(data: Mapping[str, Any], kind: str, fields: Mapping[str, Any]) -> Any:
    """Keys of ``[analysis]`` for another type: those of the text that it has too, and new ones.

    Parameters
    ----------
    data : sections of the file
    kind : type of the analysis
    fields : key → value of new ones, None for a removed one

    Returns
    -------
    key → value for ``section_operation``, None for keys that the type does not have

    Raises
    ------
    ModelError
        Unknown type, or a key that it does not have.
    """
    classes = STRUCTURAL_ANALYSES if data.get("kind") == "structure" else ANALYSES
    if kind not in classes:
        raise ModelError(unknown("type", kind, classes), "analysis")
    keys = {field.name for field in keyed_fields(classes[kind], frozenset())}
    for key in fields:
        if key not in keys:
            raise ModelError(unknown("key", str(key), keys), "analysis")
    old = data.get("analysis")
    table: dict[str, Any] = old if isinstance(old, dict) else {}
    if kind != table.get("type"):
        table = {key: value for key, value in table.items() if key in TIMES or key == "type"}
    former = old if isinstance(old, dict) else {}
    removed = {key: None for key in former if key != "type" and not (key in keys and key in table)}
    shown = {"type": kind} | removed | dict(fields)
    times = table | {key: value for key, value in shown.items() if value is not None}
    if "duration" in keys and not {"duration", "t_span"} & times.keys():
        shown |= {"duration": DURATION, "outputs": OUTPUTS}
    return shown


class Preview:
    """Keys of ``[analysis]`` that replace those of the text in the picture."""

    def __init__(self) -> None:
        self.fields: dict[str, Any] | None = None
        self._text = ""

    def set(self, fields: dict[str, Any] | None) -> bool:
        """Show other keys; None for those of the text. Returns whether they differ."""
        changed = fields != self.fields
        self.fields = fields
        return changed

    def apply(self, text: str) -> str:
        """The text with the analysis that is shown; an invalid text stays as it is."""
        self._text = text
        if self.fields is not None:
            with suppress(DalembertError):  # such as a text that is not valid meanwhile
                self._text = apply(text, [section_operation("analysis", self.fields)])
        return self._text

    def in_text(self, problems: Iterable[Problem], text: str) -> Iterator[Problem]:
        """Problems of the picture at their places in the text without the preview.

        Parameters
        ----------
        problems : of the text with the analysis that is shown
        text : without it
        """
        shown = self._text
        head, tail = common_ends(shown, text)

        def moved(start: int, end: int) -> int | None:
            """Distance by which a range is moved; None for one that the text does not have."""
            if shown == text or end <= head:
                return 0
            return len(text) - len(shown) if start >= len(shown) - tail else None

        for problem in problems:
            by = [moved(fix.start, fix.end) for fix in problem.fixes]
            fixes = tuple(
                replace(fix, start=fix.start + d, end=fix.end + d)
                for fix, d in zip(problem.fixes, by, strict=True)
                if d is not None
            )
            start, end, line = problem.start, problem.end, problem.line
            d = None if start is None or end is None else moved(start, end)
            if start is None or end is None or d is None:
                start, end, line = None, None, 0
            else:
                start, end = start + d, end + d
                line = line_and_column(text, start)[0]
            yield replace(problem, start=start, end=end, line=line, fixes=fixes)

    def message(self) -> dict[str, Any]:
        """The keys as a message."""
        return {"kind": "preview", "fields": self.fields}
