"""A file that is renamed while the studio shows it: the page asks where to save it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from studio_desk import opened, reset
from studio_runs import Studio
from test_studio_space import BOXES


@pytest.mark.thorough
def test_a_renamed_file_is_saved_where_one_chooses(
    browser: Any, studio_server: Studio, tmp_path: Path
) -> None:
    path, renamed = tmp_path / "boxes.toml", tmp_path / "moved.toml"
    path.write_text(BOXES)
    reset(studio_server, path=str(path))
    with opened(browser, studio_server, "0") as desk:
        desk.show(BOXES + "# more\n")
        path.rename(renamed)
        page = desk.page
        page.keyboard.press("Control+s")
        page.wait_for_selector("#ask[open] >> text=renamed to moved.toml")
        assert not path.exists() and renamed.read_text() == BOXES
        page.click("#ask >> text=Save as…")
        page.fill("#ask input", str(renamed))
        page.keyboard.press("Enter")
        page.click("#ask >> text=/^Replace$/")
        desk.until("studio.file.name === 'moved.toml'", 20)
        assert renamed.read_text() == BOXES + "# more\n" and not path.exists()
        renamed.unlink()
        desk.show(BOXES + "# again\n")
        page.keyboard.press("Control+s")
        page.click("#ask >> text=Write it under its former name")
        desk.until("!studio.file.changed", 20)
        assert renamed.read_text() == BOXES + "# again\n"
