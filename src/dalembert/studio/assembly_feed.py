"""Other assembly configurations of the present text, sent to the pages while one shows them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from dalembert.studio.building import BuildingProcess, Request
from dalembert.studio.event_loop import in_loop
from dalembert.studio.pictures import Picture


class AssemblyFeed:
    """Searches of configurations in a process of their own, which starts with the first one.

    Parameters
    ----------
    broadcast : sends a message to all pages
    """

    def __init__(self, broadcast: Callable[[dict[str, Any]], None]):
        self._broadcast = broadcast
        self.shown = False
        """Whether a page shows them."""
        self._revision = -1
        self._latest: dict[str, Any] | None = None
        self._builder: BuildingProcess | None = None

    def build(self, text: str, path: Path, revision: int) -> None:
        """Search the configurations of a text, if a page shows them.

        Parameters
        ----------
        text, path : of the model file
        revision : of the text
        """
        if not self.shown:
            return
        self._revision = revision
        if self._builder is None:
            self._builder = BuildingProcess("assemblies", in_loop(self.receive))
        self._builder.request(Request(revision, text, path))

    def receive(self, revision: int, picture: Picture) -> None:
        """Send the configurations to the pages, if their text is the present one."""
        if revision != self._revision:
            return
        problems = [problem.message for problem in picture.problems]
        self._latest = {
            "kind": "assemblies",
            "revision": revision,
            "poses": picture.facts.get("assemblies", []),
            "text": problems[0] if problems else picture.facts.get("note", ""),
        }
        self._broadcast(self._latest)

    def present(self) -> list[dict[str, Any]]:
        """Messages for a new page."""
        return [self._latest] if self.shown and self._latest is not None else []

    def close(self) -> None:
        """End the process."""
        if self._builder is not None:
            self._builder.close()
