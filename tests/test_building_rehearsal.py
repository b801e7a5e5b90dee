"""The model that a building process draws while there is nothing to do."""

from __future__ import annotations

from pathlib import Path

from dalembert.studio.building import REHEARSAL
from dalembert.studio.pictures import picture_of


def test_the_rehearsal_is_a_whole_picture() -> None:
    for live in (False, True):
        picture = picture_of(REHEARSAL, Path("rehearsal.toml"), live)
        assert picture.page
        assert picture.problems == ()
        assert picture.is_live == live
