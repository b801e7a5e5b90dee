"""Interactive report in one HTML file, rendered from a payload of plain data.

The page contains its style, scripts and data and makes no network request, so that it opens from a
disk or a mail attachment as well as from a web server.
"""

from __future__ import annotations

import base64
import html
import json
import math
import os
import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from dalembert.errors import FileError
from dalembert.files import atomic_path
from dalembert.report.packing import are_numbers, pack
from dalembert.report.scripts import (
    CHARTS,
    KINDS,
    PAGES,
    RUNS,
    asset,
    page_charts,
    page_kind,
    page_script,
    worker_script,
)
from dalembert.text.wording import visible

__all__ = ["PageFrame", "as_json", "embedded", "frame_of", "render_page", "write_page"]

#: Significant digits of the numbers of a page.
DIGITS = 10

INDENT = re.compile(r"^[ \n]+", re.MULTILINE)
"""Indentation of scripts and blank lines."""
PART = re.compile(r"\{\{(\w+)\}\}")
SEPARATOR = "~"
"""Separator of the parts of a name."""
CHARTS_OF_ALL = frozenset(CHARTS.values())

# Characters that could end the data element early; the text is ASCII.
_ESCAPES = {ord(c): f"\\u{ord(c):04x}" for c in "<>&"}


@dataclass(frozen=True)
class PageFrame:
    """Style and scripts of a kind of page, which pages of many payloads have in common.

    Parameters
    ----------
    kind : of the page, of ``PAGES``
    run : kind of the analysis that a live page repeats, of ``RUNS``; empty for a still page
    charts : modules of further charts, of ``CHARTS``
    """

    kind: str
    run: str = ""
    charts: tuple[str, ...] = ()

    def render(self, title: str = "", data: str = "") -> str:
        """The page with its data; without them it waits until ``receiveData`` is called in it.

        Parameters
        ----------
        title : text
        data : JSON that is safe inside a script element
        """
        # One pass over the template, so that inserted parts are not searched again.
        parts = _parts(self) | {"title": html.escape(title), "data": data}
        return PART.sub(lambda match: parts[match[1]], asset("template.html"))

    @property
    def name(self) -> str:
        """The frame as a part of an address."""
        words = (self.kind.replace(" ", "-"), self.run.replace(" ", "-"))
        return SEPARATOR.join((*words, *self.charts))

    @classmethod
    def named(cls, name: str) -> PageFrame | None:
        """Frame of a name; None if there is none."""
        kind, run, charts = (*name.split(SEPARATOR, 2), "", "")[:3]
        modules = tuple(filter(None, charts.split(SEPARATOR)))
        frame = cls(kind.replace("-", " "), run.replace("-", " "), modules)
        valid = frame.kind in PAGES and (not frame.run or frame.run in RUNS)
        return frame if valid and frame.name == name and set(modules) <= CHARTS_OF_ALL else None


def frame_of(payload: dict[str, Any]) -> PageFrame:
    """Frame of the page of a payload.

    Raises
    ------
    FileError
        There is no page of this kind.
    """
    kind = payload.get("kind", "mechanism")
    if not isinstance(kind, str) or kind not in KINDS:
        raise FileError(f"there is no page for {kind!r}; known: {', '.join(KINDS)}")
    if kind == "structure" and "scene" not in payload:
        raise FileError("this report was written by an earlier version; run the model again")
    live = payload.get("live", {})
    run = live["kind"] if "code" in live else ""
    return PageFrame(page_kind(payload), run, page_charts(payload))


@cache
def _parts(frame: PageFrame) -> dict[str, str]:
    """Parts of the template that do not depend on the data."""
    parts = {
        "style": asset("page.css") + asset("views.css"),
        "script": INDENT.sub("", page_script(frame.kind, frame.charts)),
        "worker": "",
        "rights": "",
    }
    if frame.run:
        script = INDENT.sub("", worker_script(frame.run))
        packed = base64.b64encode(zlib.compress(script.encode(), 9)).decode("ascii")
        parts["worker"] = f'<script type="text/plain" id="worker">{packed}</script>'
        parts["style"] += asset("live.css")
        parts["rights"] = " 'wasm-unsafe-eval' blob:; worker-src blob:"
    return parts


def render_page(payload: dict[str, Any]) -> str:
    """Return the whole report page of ``payload`` as one string of HTML."""
    title = visible(str(payload.get("title") or "Report"))
    return frame_of(payload).render(title, embedded(payload))


def write_page(payload: dict[str, Any], path: str | os.PathLike[str]) -> Path:
    """Write the page of ``payload`` to ``path`` atomically; return the path."""
    text = render_page(payload)
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")
    return Path(path)


def embedded(payload: dict[str, Any]) -> str:
    """Return ``payload`` as packed JSON that is safe inside a script element."""
    return as_json(pack(payload)).translate(_ESCAPES)


def as_json(value: Any) -> str:
    """Return ``value`` as ASCII JSON, with null for numbers that are not finite."""
    if hasattr(value, "tolist"):  # a numpy array or scalar
        value = value.tolist()
    if isinstance(value, float):
        return _numbers([value])
    if isinstance(value, str):
        return json.dumps(visible(value))
    if value is None or isinstance(value, (bool, int)):
        return json.dumps(value)
    if isinstance(value, dict):
        return (
            "{"
            + ",".join(f"{as_json(str(key))}:{as_json(item)}" for key, item in value.items())
            + "}"
        )
    if isinstance(value, (list, tuple)):
        if any(isinstance(item, float) for item in value) and are_numbers(value):
            return f"[{_numbers(value)}]"
        return "[" + ",".join(map(as_json, value)) + "]"
    raise TypeError(f"a report cannot hold a {type(value).__name__}")


def _numbers(values: Sequence[float | None]) -> str:
    """Return numbers separated by commas, formatted in one operation for speed."""
    numbers = tuple(math.nan if value is None else value for value in values)
    text = ",".join([f"%.{DIGITS}g"] * len(numbers)) % numbers
    return re.sub(r"-?(?:nan|inf)", "null", text) if "n" in text else text


@dataclass(frozen=True, repr=False)
class InlinePage:
    """A page that notebooks display in a frame, with player and plots.

    Attributes
    ----------
    payload : payload of the page
    height : of the frame [px]
    """

    payload: dict[str, Any]
    height: int = 680

    def __repr__(self) -> str:
        return f"<page of {self.payload.get('title', 'a result')!r}; notebooks show it>"

    def _repr_html_(self) -> str:
        page = html.escape(render_page(self.payload), quote=True)
        rights = "allow-scripts allow-downloads allow-modals"
        style = f"width:100%;height:{self.height}px;border:0"
        title = html.escape(str(self.payload.get("title", "Report")), quote=True)
        return (
            f'<iframe srcdoc="{page}" sandbox="{rights}" title="{title}" style="{style}"></iframe>'
        )
