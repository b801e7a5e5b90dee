"""Names, units and texts of a model in LaTeX, with any characters."""

from __future__ import annotations

import re
import unicodedata

ESCAPES = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedbl{}",
    **{character: f"\\{character}" for character in "#$%&_{}"},
}
"""Characters of LaTeX → their notation in texts."""
GREEK = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau "
    "upsilon phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"
).split()
LETTERS = {
    unicodedata.lookup(
        f"GREEK {'SMALL' if name.islower() else 'CAPITAL'} LETTER "
        f"{'LAMDA' if name.lower() == 'lambda' else name.upper()}"
    ): rf"\{name}"
    for name in GREEK
} | {"µ": r"\mu", "°": r"^{\circ}", "·": r"\cdot", "²": "^{2}", "³": "^{3}"}
"""Characters that LaTeX sets in formulas → their commands."""
TYPESET = "ßøØæÆœŒåÅłŁ"
"""Letters without a decomposition that every LaTeX sets."""


def latex_text(text: str) -> str:
    """A text outside of formulas, on one line.

    Examples
    --------
    >>> from dalembert.io.exports.latex.texts import latex_text
    >>> latex_text("100 % of a_b")
    '100 \\\\% of a\\\\_b'
    """
    return "".join(ESCAPES.get(c, c) for c in " ".join(text.split()))


def latex_word(text: str) -> str:
    """A word of a formula in upright letters; numbers and single letters as they are.

    Examples
    --------
    >>> from dalembert.io.exports.latex.texts import latex_word
    >>> latex_word("rod"), latex_word("x"), latex_word("Ω"), latex_word("Länge")
    ('\\\\mathrm{rod}', 'x', '\\\\Omega', '\\\\text{Länge}')
    """
    if text in LETTERS:
        return LETTERS[text]
    if text.isascii() and (text.isdigit() or (len(text) == 1 and text not in ESCAPES)):
        return text
    return upright(text)


def upright(text: str) -> str:
    """A text of a formula in upright letters."""
    simple = re.fullmatch(r"[A-Za-z0-9_]*", text)
    return rf"\{'mathrm' if simple else 'text'}{{{latex_text(text)}}}"


def latex_unit(unit: str) -> str:
    """A unit in a formula; nothing for numbers without one.

    Examples
    --------
    >>> from dalembert.io.exports.latex.texts import latex_unit
    >>> latex_unit("kg m^2/s"), latex_unit("1/s"), latex_unit("1")
    ('\\\\mathrm{kg\\\\,m^{2}/s}', '\\\\mathrm{1/s}', '')
    """
    if unit in ("", "1"):
        return ""
    text = re.sub(r"(?:\^|\*\*)\(?(-?[\d.]+)\)?", r"^{\1}", unit)
    text = re.sub(r"\s*[* ]\s*", r"\\,", text.replace("%", r"\%"))
    return rf"\mathrm{{{''.join(LETTERS.get(c, c) for c in text)}}}"


def declarations(text: str) -> list[str]:
    """Lines of a preamble by which pdfLaTeX sets the other characters of a document.

    Greek letters are those of formulas; characters of scripts without a font are their numbers.
    """
    lines = []
    for character in sorted(set(text)):
        base = unicodedata.normalize("NFD", character)[0]
        if character.isascii() or character in TYPESET or (base.isascii() and base != character):
            continue
        number = f"{ord(character):04X}"
        command = LETTERS.get(character)
        shown = rf"\ensuremath{{{command}}}" if command else rf"\text{{\texttt{{U+{number}}}}}"
        lines.append(rf"\DeclareUnicodeCharacter{{{number}}}{{{shown}}}")
    if not lines:
        return []
    return [r"\ifdefined\DeclareUnicodeCharacter % pdfLaTeX", *lines, r"\fi"]
