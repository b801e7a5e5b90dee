"""A page whose program has ended says so, and what is done there then leads to no error."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from browser import Visit
from studio_desk import WAIT
from studio_runs import running_studio


@pytest.mark.thorough
def test_the_page_says_that_the_program_has_ended(browser: Any, tmp_path: Path) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    visit = Visit(page)
    page.on("pageerror", lambda error: visit.errors.append(str(error)))
    try:
        with running_studio(tmp_path) as studio:
            page.goto(studio.address)
            visit.until("window.studio?.pictures.shown >= 1", WAIT)
            studio.process.kill()
            studio.process.wait()
        visit.until("document.getElementById('link').textContent.includes('program has ended')")
        assert "is kept" in page.inner_text("#link")
        page.click("text=Export…")
        visit.until("document.getElementById('notice').textContent.includes('not connected')")
        visit.js("studio.photo.read()")
        visit.js("(studio.reading = null, studio.readSchema(), studio.reading)")
        assert visit.errors == []
        box = page.locator("#link").bounding_box()
        assert box["x"] + box["width"] <= 1280
    finally:
        page.close()
