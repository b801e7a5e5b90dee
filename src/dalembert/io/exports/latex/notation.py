"""LaTeX notation of numbers, names and sums."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from fractions import Fraction

from dalembert.io.exports.latex.sums import Factor, Product, Sum
from dalembert.io.exports.latex.texts import GREEK, latex_word, upright

COORDINATES = {
    "angle": r"\varphi",
    "displacement": "s",
    "angular_velocity": r"\omega",
    **{name: name for name in "xyz"},
}
"""Coordinates of bodies and joints → letter."""
OPERATORS = {"asin": r"\arcsin", "acos": r"\arccos", "atan": r"\arctan", "log": r"\ln"}
RELATIONS = {
    "lt": "<",
    "le": r"\leq",
    "eq": "=",
    "ne": r"\neq",
    "and": r"\ \mathrm{and}\ ",
    "or": r"\ \mathrm{or}\ ",
}
LARGEST_DENOMINATOR = 64


def latex_name(name: str) -> str:
    """Notation of a name: Greek letters, subscripts, and words in upright letters.

    Examples
    --------
    >>> from dalembert.io.exports.latex.notation import latex_name
    >>> latex_name("l1"), latex_name("omega_0"), latex_name("m_rod"), latex_name("crank.angle")
    ('l_{1}', '\\\\omega_{0}', 'm_{\\\\mathrm{rod}}', '\\\\varphi_{\\\\mathrm{crank}}')
    """
    owner, _, last = name.rpartition(".")
    if owner and last in COORDINATES:
        return f"{COORDINATES[last]}_{{{latex_word(owner)}}}"
    if owner:
        return f"{_head(last)}_{{{latex_word(owner)}}}"
    head, *rest = name.split("_")
    match = re.fullmatch(r"([A-Za-z]+)(\d+)", head)
    if match and (len(match[1]) == 1 or match[1] in GREEK):
        head, rest = match[1], [match[2], *rest]
    rest = [part for part in rest if part]
    if not head or not (len(head) == 1 or head in GREEK):
        return latex_word(name)
    return (
        f"{_head(head)}_{{{','.join(latex_word(part) for part in rest)}}}" if rest else _head(head)
    )


def _head(text: str) -> str:
    return f"\\{text}" if text in GREEK else latex_word(text)


def latex_number(value: float) -> str:
    """A positive number: a fraction if it is one, else the shortest text of the same number.

    Examples
    --------
    >>> from dalembert.io.exports.latex.notation import latex_number
    >>> latex_number(1 / 12), latex_number(9.81), latex_number(2.5e-7)
    ('\\\\frac{1}{12}', '9.81', '2.5 \\\\cdot 10^{-7}')
    """
    fraction = Fraction(value).limit_denominator(LARGEST_DENOMINATOR)
    exact = fraction.numerator / fraction.denominator == value
    if exact and fraction.denominator == 1 and abs(value) < 1e6:
        return str(fraction.numerator)
    short = f"{value:.15g}"
    text = short if float(short) == value else repr(value)
    if exact and len(text) > 5:
        return rf"\frac{{{fraction.numerator}}}{{{fraction.denominator}}}"
    mantissa, _, exponent = text.partition("e")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else text


def unambiguous(names: Mapping[str, str], reserved: Iterable[str]) -> dict[str, str]:
    """Notations by names; of those that are alike or reserved, the upright names.

    Examples
    --------
    >>> from dalembert.io.exports.latex.notation import unambiguous
    >>> unambiguous({"l1": "l_{1}", "l_1": "l_{1}", "M": "M", "m": "m"}, "M")
    {'l1': '\\\\mathrm{l1}', 'l_1': '\\\\mathrm{l\\\\_1}', 'M': '\\\\mathrm{M}', 'm': 'm'}
    """
    counts = Counter([*names.values(), *reserved])
    return {name: upright(name) if counts[text] > 1 else text for name, text in names.items()}


class Notation:
    """Notation of sums.

    Parameters
    ----------
    names : name of a symbol → its notation
    """

    def __init__(self, names: Mapping[str, str]):
        self.names = names

    def sum(self, total: Sum) -> str:
        """Terms with their signs, the simplest first."""
        return " ".join(self.terms(total))

    def terms(self, total: Sum) -> list[str]:
        """The terms of a sum with their signs."""
        ordered = sorted(total.terms.items(), key=lambda term: _order(term[0]))
        texts = []
        for k, (factors, coefficient) in enumerate(ordered):
            sign = ("- " if k else "-") if coefficient < 0 else "+ " if k else ""
            texts.append(sign + self.term(factors, abs(coefficient)))
        return texts or ["0"]

    def term(self, factors: Product, coefficient: float) -> str:
        """A product, with negative powers in a denominator."""
        above = [self.factor(f, power) for f, power in factors if power > 0]
        below = [self.factor(f, -power) for f, power in factors if power < 0]
        number = latex_number(coefficient)
        front = [number] if number != "1" or not above else []
        text = _joined([*front, *above])
        return rf"\frac{{{text}}}{{{_joined(below)}}}" if below else text

    def factor(self, factor: Factor, power: int) -> str:
        """A factor with its power."""
        exponent = f"^{{{power}}}" if power != 1 else ""
        if not factor.arguments:
            text = self.names[factor.name]
            return (
                rf"\left({text}\right){exponent}" if exponent and "dot" in text else text + exponent
            )
        texts = [self.sum(argument) for argument in factor.arguments]
        if factor.name == "sqrt":
            return _powered(rf"\sqrt{{{texts[0]}}}", exponent)
        if factor.name == "sum":
            return rf"\left({texts[0]}\right){exponent}"
        if factor.name == "abs":
            return rf"\left|{texts[0]}\right|{exponent}"
        if factor.name == "pow":
            return _powered(rf"\left({texts[0]}\right)^{{{texts[1]}}}", exponent)
        if factor.name in RELATIONS:
            return _powered(rf"[{texts[0]} {RELATIONS[factor.name]} {texts[1]}]", exponent)
        if factor.name in ("if", "not"):
            inside = texts[0] if factor.name == "if" else rf"\mathrm{{not}}\ {texts[0]}"
            rest = rf" \left({texts[1]}\right)" if factor.name == "if" else ""
            return _powered(rf"[{inside}]{rest}", exponent)
        operator = OPERATORS.get(factor.name, rf"\{factor.name}")
        if factor.name in ("sign", "asinh", "acosh", "atanh", "floor", "atan2", "erf", "copysign"):
            operator = rf"\mathrm{{{factor.name}}}"
        return rf"{operator}{exponent}\left({', '.join(texts)}\right)"


def _powered(text: str, exponent: str) -> str:
    return rf"\left({text}\right){exponent}" if exponent else text


def _joined(parts: list[str]) -> str:
    return r" \, ".join(parts) or "1"


def _order(factors: Product) -> tuple[int, str]:
    inner = sum(a.size for f, _ in factors for a in f.arguments)
    return inner + sum(abs(power) for _, power in factors), "·".join(f.key for f, _ in factors)
