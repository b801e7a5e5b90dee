"""Frames of pictures: pages of the report without data, which are loaded before they are needed."""

from __future__ import annotations

from functools import lru_cache

from dalembert.report.page import PageFrame

EMBEDDED = """header.top, #footer, #panels { display: none }
body { padding: 8px } main, .single main { padding: 0 }
.stage, .single .stage { height: auto; min-height: 0 }
.view, .single .view { flex: none; height: max(280px, 100vh - 200px) }
@media (min-width: 941px) { .board { min-height: 0 } }
.toolbar { order: 1; border-bottom: 0; border-top: 1px solid var(--line) }
.toolbar .menu-box { top: auto; bottom: calc(100% + 6px) }
#ghosts { order: 99 }
@media (max-width: 560px), (max-height: 430px) {
  .view, .single .view { height: max(170px, calc(100dvh - 150px)) }
  .toolbar { flex-wrap: nowrap; overflow-x: auto; padding: 5px 8px }
  .toolbar > *, .toolbar .chips { flex: none; flex-wrap: nowrap; max-height: none }
  .player { padding: 4px 8px } .player select { max-width: 72px }
}"""
"""Style of a page in the studio, which has its own heading. Legend and buttons are below the
drawing, whose place and height depend on the window only: no row of them moves what is clicked. On
a phone the tools are in one line."""


@lru_cache(maxsize=4)
def frame_page(name: str) -> str:
    """HTML of the frame of a picture; empty if there is none of this name."""
    frame = PageFrame.named(name)
    style = f"<style>{EMBEDDED}</style>\n</head>"
    return "" if frame is None else frame.render().replace("</head>", style, 1)
