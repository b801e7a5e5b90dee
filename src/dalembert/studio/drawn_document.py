"""Contents of the text of a draft for the drawing."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from dalembert.errors import DalembertError
from dalembert.io.reading import parse_document
from dalembert.studio.draft import Draft
from dalembert.studio.event_loop import in_thread

LONG = 50_000
"""Length of a text above which it is read and changed in a thread [characters]."""


class DrawnDocument:
    """Contents of the last text, which is read once."""

    def __init__(self) -> None:
        self._last: tuple[str, dict[str, Any] | None] = ("", None)

    def of(self, draft: Draft) -> dict[str, Any] | None:
        """Contents of a draft; None if its text is not valid."""
        if self._last[0] != draft.text:
            self._last = draft.text, _contents(draft.name, draft.text)
        return self._last[1]

    async def read(self, draft: Draft) -> None:
        """Read a long text in a thread, while the event loop goes on."""
        name, text = draft.name, draft.text
        if len(text) > LONG and self._last[0] != text:
            self._last = text, await in_thread(lambda: _contents(name, text))


def _contents(name: str, text: str) -> dict[str, Any] | None:
    """Contents of a text; None if it is not valid."""
    try:
        data: dict[str, Any] = parse_document(Path(name), text)
        json.dumps(data, allow_nan=False)
    except (DalembertError, TypeError, ValueError):  # dates, and numbers that are not finite
        return None
    return data
