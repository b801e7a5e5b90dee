"""Meaning of the names of layers, groups and classes of a drawing, and of its texts."""

from __future__ import annotations

import re
from collections.abc import Iterable
from enum import Enum


class Role(Enum):
    """Meaning of an entity, by the name of its layer, group or class."""

    PART = "part"
    GROUND = "ground"
    SLOT = "slot"
    BLOCK = "block"
    MOTOR = "motor"
    IGNORED = "ignored"


WORDS = {
    Role.IGNORED: "construction dimension dimensions dim hidden center centre centerline "
    "centreline annotation annotations notes defpoints title border hatch ignore ignored",
    Role.MOTOR: "motor motors driver drivers drive input",
    Role.BLOCK: "block blocks piston pistons slider sliders",
    Role.SLOT: "slot slots rail rails guide guides",
    Role.GROUND: "ground grounded fixed frame",
}
"""Role → words in names of layers, groups and classes; the first role that matches counts."""
GENERIC = set(
    "link bar line part body bodie pin joint circle layer ebene calque capa livello camada laag "
    "warstwa слой 图层 group sketch drawing content projection mechanism linkage figure axes patch "
    "path main default root svg g st cls text label artboard page sheet view visible narrow wide "
    "iso ansi din jis copy kopie copie".split()
)
"""Words of which the names of layers and groups consist whose lines are bodies of their own."""
ROLE_OF = {word: role for role, words in WORDS.items() for word in words.split()}


def role_of(words: Iterable[str]) -> Role:
    """The role that layers, groups and classes state."""
    parts = {part for name in words for part in re.split(r"[\W_\d]+", name.lower())}
    stated = {ROLE_OF[part] for part in parts if part in ROLE_OF}
    return next((role for role in WORDS if role in stated), Role.PART)


def group_of(words: Iterable[str]) -> str:
    """The innermost layer or group whose connected lines are one body; empty for none."""
    for name in reversed(list(words)):
        own = [p for p in re.split(r"[\W_]+", name.lower()) if p and p not in ROLE_OF]
        if own and not is_generic(name):
            return name
    return ""


def is_generic(name: str) -> bool:
    """Whether a name consists of words that name nothing, with numbers and in the plural.

    >>> is_generic("Layer_1-2"), is_generic("Visible (ISO)"), is_generic("ProjectionView001")
    (True, True, True)
    >>> is_generic("crank 1")
    False
    """
    separated = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()
    words = [word.strip("0123456789") for word in re.split(r"[\W_]+", separated)]
    return all(
        not word or bool(GENERIC & {word, word.removesuffix("s"), word.removesuffix("es")})
        for word in words
    )


def speed_in(text: str) -> str | None:
    """The speed that a label of a motor states, empty if none; None for another label.

    >>> speed_in("motor 30 rpm"), speed_in("Motor"), speed_in("crank")
    ('30 rpm', '', None)
    """
    match = re.fullmatch(r"(?:motor|driver|drive|input)\b[\s:=]*(.*)", text.strip(), re.IGNORECASE)
    return match[1].strip() if match else None


def is_ground(text: str) -> bool:
    """Whether a label states that something is fixed."""
    return text.strip().lower() in WORDS[Role.GROUND].split()
