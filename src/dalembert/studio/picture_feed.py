"""Pictures of the present text, sent to the pages in order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from dalembert.studio.building import BuildingProcess, Request
from dalembert.studio.event_loop import in_loop
from dalembert.studio.pictures import Picture
from dalembert.studio.problems import Problem

KINDS = ("still", "live")
"""Kinds of pictures, in the order in which they are made."""
KEPT = 8
"""Number of the last pages that are kept."""


class PictureFeed:
    """Still and live pictures of a text, made in processes of their own.

    Parameters
    ----------
    broadcast : sends a message to all pages
    in_text : problems of a picture → those of the text, with their places in it
    """

    def __init__(
        self,
        broadcast: Callable[[dict[str, Any]], None],
        in_text: Callable[[Iterable[Problem]], Iterable[Problem]],
    ):
        self._broadcast, self._in_text = broadcast, in_text
        self.pages: dict[int, str] = {}
        """Number of a picture → data of its page."""
        self.number = 0
        self._revision = 0
        self._latest: dict[str, dict[str, Any]] = {}
        """Kind of picture → the last message about it."""
        self._early: tuple[int, Picture] | None = None
        """A live picture that is made before the still one, and its number."""
        self._builders: dict[str, BuildingProcess] = {}

    def start(self) -> None:
        """Start the building processes; call inside the event loop."""
        for kind in KINDS:
            show = in_loop(partial(self.show, kind))
            self._builders[kind] = BuildingProcess(kind, show)

    def build(self, text: str, path: Path, revision: int) -> None:
        """Make pictures of a text, in place of those that are being made.

        Parameters
        ----------
        path : of the file, for relative paths in it
        revision : of the text
        """
        self.number += 1
        self._revision = revision
        for builder in self._builders.values():
            builder.request(Request(self.number, text, path))

    def cancel(self) -> None:
        """Stop making pictures."""
        for builder in self._builders.values():
            builder.cancel()

    def close(self) -> None:
        """End the processes."""
        for builder in self._builders.values():
            builder.close()

    def present(self) -> list[dict[str, Any]]:
        """Messages about the pictures of the present text."""
        latest = (self._latest.get(kind) for kind in KINDS)
        return [message for message in latest if message and message["number"] == self.number]

    def is_outdated(self, number: int) -> bool:
        """Whether the page of this number has been replaced by those of later pictures."""
        return 0 <= number <= max(self.pages, default=-1) - KEPT

    def show(self, kind: str, number: int, picture: Picture) -> None:
        """Send a picture to the pages, the still one before the live one."""
        if number != self.number:
            return
        if kind == "live" and self._latest.get("still", {}).get("number") != number:
            self._early = number, picture
            return
        message: dict[str, Any] = {"kind": "picture", "number": number, "live": kind == "live"}
        message["revision"] = self._revision
        if kind == "still":
            message["problems"] = [asdict(p) for p in self._in_text(picture.problems)]
            message |= {"summary": picture.summary, "facts": picture.facts}
        elif picture.late:
            late = [asdict(p) for p in self._in_text(picture.late)]
            message["problems"] = [*self._latest["still"]["problems"], *late]
        message["page"] = ""
        if picture.page:
            name = 2 * number + (kind == "live")
            kept = {k: v for k, v in self.pages.items() if k > name - KEPT}
            self.pages = kept | {name: picture.page}
            message |= {"page": f"picture/{name}", "frame": f"frame/{picture.frame}"}
        self._latest[kind] = message
        self._broadcast(message)
        if kind == "still" and self._early is not None:
            early, self._early = self._early, None
            self.show("live", *early)
