"""Values of child elements of SDF."""

from __future__ import annotations

from dalembert.io.imports.xml.element import FALSE, TRUE, XmlElement


def number(element: XmlElement | None, tag: str, default: float | None = None) -> float:
    """The number in a child element."""
    child = None if element is None else element.only(tag)
    if child is not None:
        return child.content_numbers(1)[0]
    if default is None:
        assert element is not None
        raise element.error(f"has no <{tag}>; add one")
    return default


def flag(element: XmlElement, tag: str, default: bool = False) -> bool:
    """The switch in a child element."""
    child = element.only(tag)
    if child is None:
        return default
    text = child.value().lower()
    if text not in (*TRUE, *FALSE):
        raise child.error(f"the text is {text!r}, expected true or false")
    return text in TRUE


def text(element: XmlElement, tag: str) -> str:
    """The text in a child element."""
    return element.needed(tag).value()
