"""Contents of the text for the drawing; those of a long text are read in a thread."""

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


class TextContents:
    """Contents of the last text."""

    def __init__(self) -> None:
        self._read: tuple[str, dict[str, Any] | None] = ("", None)

    def of(self, draft: Draft) -> dict[str, Any] | None:
        """Contents of the text of a draft; None if it is not valid."""
        if self._read[0] != draft.text:
            self._read = draft.text, _contents(draft.name, draft.text)
        return self._read[1]

    async def read(self, draft: Draft) -> None:
        """Read the contents of a long text, while the event loop goes on."""
        name, text = draft.name, draft.text
        if len(text) > LONG and self._read[0] != text:
            self._read = text, await in_thread(lambda: _contents(name, text))


def _contents(name: str, text: str) -> dict[str, Any] | None:
    try:
        data: dict[str, Any] = parse_document(Path(name), text)
        json.dumps(data, allow_nan=False)
    except (DalembertError, TypeError, ValueError):  # dates, and numbers that are not finite
        return None
    return data
