"""Docstrings in the style of numpydoc, as Markdown."""

from __future__ import annotations

import dataclasses
import inspect
import re
from typing import Any

from reference.markdown import FIELD, field_texts

SECTION = re.compile(r"(?:\A|\n\n)(\w+)\n-{3,}\n")
WIDE = 88
"""Characters of a signature on one line."""


def markdown(thing: Any) -> str:
    """What it says, lists of parameters and errors, and the examples in colours."""
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
    """Parameters that its bases describe, or the fields of an element themselves."""
    texts = field_texts(cls)
    for field in dataclasses.fields(cls) if dataclasses.is_dataclass(cls) else ():
        if text := field.metadata.get("description"):
            unit = field.metadata.get("unit", "")
            texts.setdefault(field.name, f"{text} [{unit}]" if unit else text)
    own = inspect.cleandoc(vars(cls).get("__doc__") or "").splitlines()
    told = {n for line in own if (m := FIELD.match(line)) for n in m[1].split(", ")}
    try:
        taken = list(inspect.signature(cls).parameters)
    except ValueError:  # of errors
        return []
    return [f"{n} : {texts[n]}" for n in taken if n in texts and n not in told]


def prose(text: str) -> str:
    """Paragraphs as they are, a table between rules as text."""
    found = []
    for paragraph in text.strip().split("\n\n"):
        ruled = paragraph.startswith("===")
        found.append(f"```text\n{paragraph}\n```" if ruled else paragraph)
    return "\n\n".join(found)


def entries(body: str) -> str:
    """``name : text`` with what is indented below it, as a list."""
    found = []
    for entry in re.split(r"\n(?=\S)", body.strip()):
        head, *lines = entry.split("\n")
        name, colon, text = head.partition(" : ")
        said = " ".join([text, *(line.strip() for line in lines)]).strip()
        if colon or lines:
            found.append(f"- `{name}`: {said}" if said else f"- `{name}`")
        else:
            found.append(f"- {head}")
    return "\n".join(found)


def signature_text(spoken: str, signature: str) -> str:
    """A call with one argument in each line where it would be too long."""
    whole = spoken + signature
    if len(whole) <= WIDE or not signature.startswith("("):
        return whole
    inside, _, result = signature[1:].rpartition(")")
    return f"{spoken}(\n    " + ",\n    ".join(arguments(inside)) + f",\n){result}"


def arguments(text: str) -> list[str]:
    """Split at the commas that are in no bracket."""
    found, depth = [""], 0
    for mark in text:
        depth += (mark in "([{") - (mark in ")]}")
        if mark == "," and not depth:
            found.append("")
        else:
            found[-1] += mark
    return [one.strip() for one in found if one.strip()]
