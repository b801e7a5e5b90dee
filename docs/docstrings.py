"""Docstrings in the style of numpydoc, as Markdown."""

from __future__ import annotations

import dataclasses
import inspect
import re
from typing import Any

from reference.markdown import FIELD, field_texts

SECTION = re.compile(r"(?:\A|\n\n)(\w+)\n-{3,}\n")
WIDE = 88
"""Maximum length of a signature on one line."""


def markdown(thing: Any) -> str:
    """Text, lists of parameters and errors, and highlighted examples of a docstring."""
    intro, *rest = SECTION.split(inspect.getdoc(thing) or "")
    sections = dict(zip(rest[::2], rest[1::2], strict=True))
    if inspect.isclass(thing) and (inherited := further_entries(thing)):
        own = sections.pop("Parameters", "")
        sections = {"Parameters": "\n".join(filter(None, [own.strip(), *inherited]))} | sections
    parts = [prose(intro)]
    for title, body in sections.items():
        shown = f"```pycon\n{body.strip()}\n```" if title == "Examples" else entries(body)
        parts.append(f"**{title}**\n\n{shown}")
    return "\n\n".join(part for part in parts if part)


def further_entries(cls: type) -> list[str]:
    """Parameters described by base classes, or by the fields of an element."""
    texts = field_texts(cls)
    for field in dataclasses.fields(cls) if dataclasses.is_dataclass(cls) else ():
        if text := field.metadata.get("description"):
            unit = field.metadata.get("unit", "")
            texts.setdefault(field.name, f"{text} [{unit}]" if unit else text)
    own = inspect.cleandoc(vars(cls).get("__doc__") or "").splitlines()
    described = {n for line in own if (m := FIELD.match(line)) for n in m[1].split(", ")}
    try:
        parameters = list(inspect.signature(cls).parameters)
    except ValueError:  # errors have no signature
        return []
    return [f"{n} : {texts[n]}" for n in parameters if n in texts and n not in described]


def prose(text: str) -> str:
    """Paragraphs unchanged, a table between rules as text."""
    parts = []
    for paragraph in text.strip().split("\n\n"):
        ruled = paragraph.startswith("===")
        parts.append(f"```text\n{paragraph}\n```" if ruled else paragraph)
    return "\n\n".join(parts)


def entries(body: str) -> str:
    """List of ``name : text`` with the indented lines below each."""
    items = []
    for entry in re.split(r"\n(?=\S)", body.strip()):
        head, *lines = entry.split("\n")
        name, colon, text = head.partition(" : ")
        description = " ".join([text, *(line.strip() for line in lines)]).strip()
        if colon or lines:
            items.append(f"- `{name}`: {description}" if description else f"- `{name}`")
        else:
            items.append(f"- {head}")
    return "\n".join(items)


def signature_text(spoken: str, signature: str) -> str:
    """A call, with one argument per line if it is too long."""
    whole = spoken + signature
    if len(whole) <= WIDE or not signature.startswith("("):
        return whole
    inside, _, result = signature[1:].rpartition(")")
    return f"{spoken}(\n    " + ",\n    ".join(arguments(inside)) + f",\n){result}"


def arguments(text: str) -> list[str]:
    """Arguments, split at the commas outside brackets."""
    parts, depth = [""], 0
    for mark in text:
        depth += (mark in "([{") - (mark in ")]}")
        if mark == "," and not depth:
            parts.append("")
        else:
            parts[-1] += mark
    return [part.strip() for part in parts if part.strip()]
