"""Style of SVG elements: fill, visibility and fonts, from attributes and style sheets."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from dalembert.io.imports.xml.element import XmlElement

PROPERTIES = (
    *("fill", "fill-opacity", "opacity", "display", "visibility", "font-size", "text-anchor"),
)
EMPTY = ("none", "transparent", "white", "#fff", "#ffffff", "rgb(255,255,255)")
"""Fills of an open circle."""
FONT = 16.0
"""Size of a font without a stated one [px]."""
Rules = list[tuple[str, dict[str, str]]]
_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)


@dataclass(frozen=True)
class Style:
    """Properties of an element, with those that it inherits."""

    fill: str = "black"
    opacity: str = "1"
    anchor: str = "start"
    font_size: float = FONT
    is_hidden: bool = False

    @property
    def is_filled(self) -> bool:
        """Whether the interior is coloured, and not white."""
        return self.fill.replace(" ", "").lower() not in EMPTY and not _is_clear(self.opacity)

    def of(self, element: XmlElement, rules: Rules) -> Style:
        """The style of an element inside of one with this style."""
        stated = {
            name: element.attributes[name] for name in PROPERTIES if name in element.attributes
        }
        for selector, properties in rules:
            if _matches(selector, element):
                stated |= properties
        stated |= _declarations(element.attributes.get("style", ""))
        stated = {name: value for name, value in stated.items() if value != "inherit"}
        hidden = stated.get("display") == "none" or stated.get("visibility") in (
            "hidden",
            "collapse",
        )
        hidden = hidden or _is_clear(stated.get("opacity", "1"))
        return replace(
            self,
            fill=stated.get("fill", self.fill),
            opacity=stated.get("fill-opacity", self.opacity),
            anchor=stated.get("text-anchor", self.anchor),
            font_size=_size(stated.get("font-size", ""), self.font_size),
            is_hidden=hidden,
        )


def read_style_sheets(root: XmlElement) -> Rules:
    """Selectors of tags, classes and names, with their properties, from ``<style>`` elements."""
    rules: Rules = []
    pending = [root]
    while pending:
        element = pending.pop()
        if element.tag.rpartition(":")[2] == "style":
            for selectors, body in _RULE.findall(_COMMENT.sub("", element.content)):
                properties = _declarations(body)
                rules += [(selector.strip(), properties) for selector in selectors.split(",")]
        pending.extend(element.children)
    return rules


def _declarations(text: str) -> dict[str, str]:
    """``fill:none; stroke:black`` → the properties that matter here."""
    pairs = (entry.partition(":") for entry in text.split(";"))
    values = {name.strip(): value.replace("!important", "").strip() for name, _, value in pairs}
    return {name: value for name, value in values.items() if name in PROPERTIES}


def _is_clear(opacity: str) -> bool:
    return re.fullmatch(r"0*\.?0*%?", opacity.strip()) is not None


def _matches(selector: str, element: XmlElement) -> bool:
    attributes = element.attributes
    if selector.startswith("#"):
        return attributes.get("id") == selector[1:]
    tag, _, name = selector.partition(".")
    is_tag = tag in ("", "*", element.tag.rpartition(":")[2])
    return is_tag and bool(selector) and (not name or name in attributes.get("class", "").split())


def _size(text: str, inherited: float) -> float:
    match = re.match(r"\s*(\d{1,6}(?:\.\d*)?|\.\d+)", text)
    return float(match[1]) if match else inherited
