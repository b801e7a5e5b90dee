"""Building processes: the model drawn while there is nothing to do, and pauses during edits."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest

from dalembert.studio.building import PAUSES, REHEARSAL, BuildingProcess, Request
from dalembert.studio.pictures import Picture, picture_of


def test_the_rehearsal_is_a_whole_picture() -> None:
    for live in (False, True):
        picture = picture_of(REHEARSAL, Path("rehearsal.toml"), live)
        assert picture.page
        assert picture.problems == ()
        assert picture.is_live == live


class WithoutProcess(BuildingProcess):
    """Makes the pictures itself."""

    def _start(self) -> None:
        pass

    def _picture(self, request: Request) -> Picture:
        return Picture(summary=request.text)


def test_quick_edits_make_one_live_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    """The one of the last edit: the others would be outdated before they are shown."""
    monkeypatch.setitem(PAUSES, "live", 1.0)  # also where this process waits for a busy processor
    numbers: list[int] = []
    arrived = threading.Event()

    def receive(number: int, picture: Picture) -> None:
        assert picture.summary == str(number)
        numbers.append(number)
        arrived.set()

    builder = WithoutProcess("live", receive)
    try:
        for number in range(1, 6):
            builder.request(Request(number, str(number), Path("model.toml")))
            time.sleep(0.02)
        assert arrived.wait(60)
        assert numbers == [5]
    finally:
        builder.close()
