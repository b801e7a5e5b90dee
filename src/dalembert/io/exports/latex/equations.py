"""LaTeX documents with the equations of motion of small mechanisms."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.io.exports.exported import Files
from dalembert.io.exports.latex.graph import WithoutNotation, sums_of
from dalembert.io.exports.latex.notation import Notation, latex_name, latex_number, unambiguous
from dalembert.io.exports.latex.sums import Sum
from dalembert.io.exports.latex.texts import declarations, latex_text, latex_unit
from dalembert.model.graph.coordinates import AbsoluteCoordinates
from dalembert.model.graph.model import Model
from dalembert.model.graph.tree.joint_coordinates import JointCoordinates

CHOICES = {"joint": JointCoordinates, "absolute": AbsoluteCoordinates}
LARGEST = 300
"""Upper limit of the terms of all equations."""
TITLES = {
    "M": "Mass matrix",
    "h": "Forces, without those of constraints",
    r"\Phi": "Constraints",
    "C": "Jacobian of the constraints",
}
"""Letter of an array → heading."""

INDEX = re.compile(r"^((?:\\_|[^_])*)(.*)$")
"""A letter or word of a notation, and its index."""
RESERVED = (*TITLES, r"\Phi_{1}", "q", "v", r"\lambda")
"""Notations of arrays."""
WIDEST = 80
"""Upper limit of the characters in a line of an equation."""


@dataclass(frozen=True)
class Array:
    """An array of the equations.

    Attributes
    ----------
    shape : rows and columns; a column has one
    entries : by columns
    """

    shape: tuple[int, int]
    entries: list[Sum]


@dataclass(frozen=True)
class LatexEquations:
    """Equations ``M q̈ = h − Cᵀ λ``, ``Φ = 0`` as sums with the names of their symbols.

    Attributes
    ----------
    symbols : name of a symbol → its notation, in the order of ``t, q, v, p``
    arrays : letter → Array
    """

    symbols: dict[str, str]
    arrays: dict[str, Array]


def latex_equations(model: Model, coordinates: str = "joint") -> LatexEquations:
    """Equations of motion of a small mechanism.

    Parameters
    ----------
    coordinates : ``"joint"``, relative motions of a tree of joints, or ``"absolute"``

    Raises
    ------
    UnsupportedError
        Too many terms.
    """
    if coordinates not in CHOICES:
        raise UnsupportedError(f"coordinates={coordinates!r}: choose {' or '.join(CHOICES)}")
    view = CHOICES[coordinates]().view(model)
    e = view.equations
    symbols = _symbols(view, e)
    columns = {"M": e.mass, "h": e.force - e.bias, r"\Phi": e.constraints, "C": e.jacobian}
    pairs, total, arrays = [(s, name) for s, name, _ in symbols], 0, {}
    try:
        for letter, column in columns.items():
            entries = sums_of(column, pairs) if column.numel() else []
            total += sum(entry.size for entry in entries)
            if total > LARGEST:
                raise UnsupportedError(f"they have more than {LARGEST} terms")
            arrays[letter] = Array(column.shape, entries)
    except WithoutNotation as error:
        raise UnsupportedError(
            f"the equations of {model.name!r} cannot be written in LaTeX: they contain {error}"
        ) from None
    except UnsupportedError as error:
        other = next(choice for choice in CHOICES if choice != coordinates)
        raise UnsupportedError(
            f"the equations of {model.name!r} are too large for LaTeX: {error}; export a model "
            f"with fewer bodies, or try coordinates={other!r}"
        ) from None
    return LatexEquations(_notations(symbols), arrays)


def _notations(symbols: list[tuple[ca.SX, str, str]]) -> dict[str, str]:
    """Notations by names; those of parameters differ from all others."""
    notations = {name: notation for _, name, notation in symbols}
    others = {text for name, text in notations.items() if not name.startswith("p:")}
    own = {name[2:]: text for name, text in notations.items() if name.startswith("p:")}
    return notations | {
        f"p:{name}": text for name, text in unambiguous(own, others | set(RESERVED)).items()
    }


def _symbols(view: Any, e: Any) -> list[tuple[ca.SX, str, str]]:
    """Symbol, name and notation of time, coordinates, speeds and parameters."""
    rows = [(e.t, "t", "t")]
    names = [latex_name(name) for name in view.names]
    rates = {str(e.pose_rate[k]): names[k] for k in range(e.coordinate_count)}
    rows += [(e.y[k], f"q:{view.names[k]}", names[k]) for k in range(e.coordinate_count)]
    for k in range(e.speed_count):
        name = str(e.v[k])
        rate = rates.get(name)
        notation = latex_name(name) if rate is None else INDEX.sub(r"\\dot{\1}\2", rate)
        rows.append((e.v[k], f"v:{name}", notation))
    known = list(view.model.parameters)
    for k in range(e.p.numel()):
        name = known[k] if k < len(known) else f"r_{k}"
        rows.append((e.p[k], f"p:{name}", latex_name(name)))
    return rows


def latex_file(model: Model, name: str, coordinates: str = "joint") -> Files:
    """A LaTeX document with mass matrix, forces, constraints and their Jacobian.

    Parameters
    ----------
    coordinates : ``"joint"``, relative motions of a tree of joints, or ``"absolute"``

    Raises
    ------
    UnsupportedError
        The equations are too large.
    """
    equations = latex_equations(model, coordinates)
    notation = Notation(equations.symbols)
    constrained = bool(equations.arrays[r"\Phi"].entries)
    law = (
        r"M \, \dot{v} = h - C^{T} \lambda, \qquad \Phi = 0" if constrained else r"M \, \dot{v} = h"
    )
    coordinates_text = _list(equations.symbols, "q:")
    lines = [
        r"\begin{document}",
        rf"\section*{{{latex_text(model.name)}}}",
        rf"\[ {law} \]",
        rf"Coordinates: {coordinates_text}. Speeds: {_list(equations.symbols, 'v:')}.",
    ]
    if any(key.startswith("p:") for key in equations.symbols):
        values = [
            _equality(equations.symbols[f"p:{p.name}"], float(p.value), p.unit)
            for p in model.parameters.values()
        ]
        lines.append(f"Parameters: {', '.join(values)}.")
    for letter, array in equations.arrays.items():
        if array.entries:
            lines.append(rf"\paragraph{{{TITLES[letter]}}}")
            lines += entry_lines(letter, array, notation)
    lines.append(r"\end{document}")
    preamble = [
        r"\documentclass{article}",
        r"\usepackage{amsmath}",
        r"\usepackage[margin=20mm]{geometry}",
        r"\allowdisplaybreaks",
        *declarations("".join(lines)),
    ]
    return Files({f"{name}.tex": ("\n".join([*preamble, *lines]) + "\n").encode("utf-8")})


def _equality(symbol: str, value: float, unit: str) -> str:
    sign, text = "-" if value < 0 else "", latex_unit(unit)
    space = r"\ " if text else ""
    return f"${symbol} = {sign}{latex_number(abs(value))}{space}{text}$"


def _list(symbols: dict[str, str], kind: str) -> str:
    return ", ".join(f"${text}$" for key, text in symbols.items() if key.startswith(kind))


def entry_lines(letter: str, array: Array, notation: Notation) -> list[str]:
    """Displayed equations of the nonzero entries; symmetric ones of the mass matrix once."""
    rows, columns = array.shape
    lines = []
    for k, entry in enumerate(array.entries):
        row, column = k % rows, k // rows
        if (letter == "M" and row > column) or (not entry.terms and letter in "MC"):
            continue
        index = f"{row + 1}" if columns == 1 and letter not in "MC" else f"{row + 1},{column + 1}"
        lines += _displayed(rf"{letter}_{{{index}}}", notation.terms(entry))
    return lines


def _displayed(left: str, terms: list[str]) -> list[str]:
    """An equation, in several lines if it is long."""
    rows, width = [left + " ="], _width(left)
    for term in terms:
        width += _width(term)
        if width > WIDEST and rows[-1] != left + " =":
            rows.append(term)
            width = _width(term)
        else:
            rows[-1] += f" {term}"
    if len(rows) == 1:
        return [rf"\[ {rows[0]} \]"]
    first, *others = (row.removeprefix(left + " =") for row in rows)
    lines = [rf"{left} = {{}} & {first.strip()}", *(rf"& {{}} {row}" for row in others)]
    return [r"\begin{align*}", " \\\\\n".join(lines), r"\end{align*}"]


def _width(text: str) -> int:
    """Number of characters of a printed formula, roughly."""
    tall = re.sub(r"\\frac\{(.*?)\}\{.*?\}", r"\1", text)
    plain = re.sub(r"\\(?:mathrm|text|left|right)|\\[ ,]", "", tall)
    return len(re.sub(r"[{}^_]", "", re.sub(r"\\[A-Za-z]+", "x", plain)))
