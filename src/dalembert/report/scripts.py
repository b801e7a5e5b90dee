"""Scripts of the pages: modules joined into one scope, in the order of their imports.

Modules use named imports of other files of this folder, and exports of declarations. The page has
neither imports nor comments; names at the top level are unique among the modules of a page.
"""

from __future__ import annotations

import re
from functools import cache
from importlib import resources

PAGES = {
    "mechanism": "plane.js",
    "spatial": "space.js",
    "structure": "structure_page.js",
    "decision": "decision.js",
}
"""Kind of page → its main module."""

IMPORT = re.compile(r'^import (?:\{[^}]*\} from )?"\./([\w/.]+)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=const|let|class|function|async)", re.MULTILINE)
COMMENT = re.compile(r"^ *// .*\n|^ */\*\*[\s\S]*?\*/\n|/\*\* .*? \*/ ?", re.MULTILINE)


def asset(name: str) -> str:
    """Text of a file of the pages."""
    return (resources.files(__package__) / "assets" / name).read_text(encoding="utf-8")


@cache
def page_script(kind: str) -> str:
    """Script of a kind of page."""
    scripts: dict[str, str] = {}
    _collect(PAGES[kind], scripts)
    return "\n".join(scripts.values())


def _collect(name: str, scripts: dict[str, str]) -> None:
    """Add a module after the modules that it imports."""
    text = asset(name)
    if not name.startswith("vendor/"):
        for imported in IMPORT.findall(text):
            if imported not in scripts:
                _collect(imported, scripts)
        for pattern in (IMPORT, EXPORT, COMMENT):
            text = pattern.sub("", text)
    scripts[name] = text
