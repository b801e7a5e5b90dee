"""A report inside a notebook: the page in a frame of its own."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import Any

from dalembert.report.page import render_page


@dataclass(frozen=True, repr=False)
class InlinePage:
    """A page that notebooks show by themselves, with its player and its plots.

    Attributes
    ----------
    payload : what it shows
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
