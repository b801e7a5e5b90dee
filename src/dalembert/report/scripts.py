"""Scripts of the pages: modules joined into one scope, in the order of their imports.

Modules use named imports of other files of this folder, and exports of declarations. The page has
neither imports nor comments nor indentation; names at the top level are unique among the modules of a page.
"""

from __future__ import annotations

import re
from functools import cache
from importlib import resources
from typing import Any

KINDS = ("mechanism", "spatial", "structure", "decision")
"""Kinds of pages."""

IMPORT = re.compile(r'^import (?:\{[^}]*\} from )?"\./([\w/.]+)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=const|let|class|function|async)", re.MULTILINE)
COMMENT = re.compile(
    r"^ */\*\*(?:(?!\*/).)*\*/\n|^ *// [^\n]*\n|/\*\* .*? \*/ ?", re.MULTILINE | re.DOTALL
)
INDENT = re.compile(r"^ +|^\n", re.MULTILINE)


def asset(name: str) -> str:
    """Text of a file of the pages."""
    return (resources.files(__package__) / "assets" / name).read_text(encoding="utf-8")


def main_module(payload: dict[str, Any]) -> str:
    """Main module of the page of a payload."""
    kind, scene = payload.get("kind"), payload.get("scene") or {}
    if kind == "decision":
        return "decision.js"
    spatial = kind == "spatial" or scene.get("dimension") == 3
    return "spatial_page.js" if spatial else "planar_page.js"


@cache
def page_script(main: str) -> str:
    """Script of a page: its main module after the modules that it imports."""
    scripts: dict[str, str] = {}
    _collect(main, scripts)
    return "\n".join(scripts.values())


def _collect(name: str, scripts: dict[str, str]) -> None:
    """Add a module after the modules that it imports."""
    text = asset(name)
    if not name.startswith("vendor/"):
        for imported in IMPORT.findall(text):
            if imported not in scripts:
                _collect(imported, scripts)
        for pattern in (IMPORT, EXPORT, COMMENT, INDENT):
            text = pattern.sub("", text)
    scripts[name] = text
