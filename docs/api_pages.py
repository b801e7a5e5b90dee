"""Pages with the signature and the docstring of every public name, generated with the site."""

from __future__ import annotations

import functools
import importlib
import inspect
import re
from pathlib import Path
from typing import Any

from docstrings import markdown, signature_text

PAGES = {
    "dalembert": "Analyses, results, gradients, design",
    "dalembert.planar": "Planar elements",
    "dalembert.spatial": "Spatial elements",
    "dalembert.planar.contact": "Planar contact",
    "dalembert.spatial.contact": "Spatial contact",
    "dalembert.structures": "Structures",
    "dalembert.blocks": "States of first order and controllers",
    "dalembert.laws": "Motion laws",
    "dalembert.rotation": "Rotations",
}
"""Public name of a module → title of its page."""


def write(folder: Path) -> None:
    """Write one page for each module, and one that lists them."""
    folder.mkdir(exist_ok=True)
    for name in PAGES:
        put(folder / f"{name}.md", page(name, module_of(name)))
    listed = "\n".join(f"{title} <{name}>" for name, title in PAGES.items())
    tree = f"```{{toctree}}\n:maxdepth: 1\n\n{listed}\n```"
    put(folder / "all.md", f"# Names in detail\n\n{tree}\n")


@functools.cache
def entries() -> dict[str, tuple[str, str]]:
    """Name as written in prose, ``da.X``, ``X`` or ``planar.X`` → its page and heading."""
    named: dict[str, tuple[str, str]] = {}
    for page_name in PAGES:
        short = "da" if page_name == "dalembert" else page_name.removeprefix("dalembert.")
        for name in names_of(module_of(page_name)):
            named[f"{short}.{name}"] = (page_name, f"{short}.{name}")
            if short == "da":
                named[name] = (page_name, f"{short}.{name}")
    return named


def entry_of(literal: str) -> tuple[str, str] | None:
    """Page and heading of a name or a call in prose; None for other text."""
    match = re.fullmatch(r"((?:\w+\.)*\w+)(\(.*\))?", literal)
    return entries().get(match[1]) if match else None


def put(path: Path, text: str) -> None:
    """Write a page only if it has changed, so that others are not rebuilt."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def module_of(name: str) -> Any:
    """``dalembert.planar`` is an attribute of ``dalembert``, and so on."""
    first, *rest = name.split(".")
    module = importlib.import_module(first)
    for part in rest:
        module = getattr(module, part)
    return module


def names_of(module: Any) -> list[str]:
    """Public names of a module, except modules, which have pages of their own."""
    names = getattr(module, "__all__", None) or [n for n in vars(module) if n[0] != "_"]
    return [n for n in sorted(names, key=str.lower) if not inspect.ismodule(getattr(module, n))]


def page(name: str, module: Any) -> str:
    """Title, docstring of the module, then each name."""
    about = (inspect.getdoc(module) or "").partition("\n\n")[0]
    parts = [f"# {PAGES[name]}", f"`{name}`: {fenced(about)}"]
    short = "da" if name == "dalembert" else name.removeprefix("dalembert.")
    parts += [entry(f"{short}.{n}", getattr(module, n)) for n in names_of(module)]
    return "\n\n".join(parts) + "\n"


def entry(spoken: str, thing: Any) -> str:
    """Name, signature and docstring."""
    signature = ""
    if callable(thing):
        try:
            signature = re.sub(r"(:|->) '([^']*)'", r"\1 \2", str(inspect.signature(thing)))
            signature = re.sub(r"<class '[\w.]*?(\w+)'>", r"\1", signature)
            signature = signature.removesuffix(" -> None")
        except (ValueError, TypeError):
            signature = "(...)"
    shown = f"## `{spoken}`\n\n```python\n{signature_text(spoken, signature)}\n```"
    text = markdown(thing) if callable(thing) else f"`{thing!r}`"
    return f"{shown}\n\n{text}"


def fenced(text: str) -> str:
    return " ".join(text.split()) or "public names"
