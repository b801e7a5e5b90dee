"""Measures of harmonic responses: parts of complex amplitudes by output and input."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import casadi as ca

from dalembert.errors import ExpressionError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import Names
from dalembert.units.powers import density_unit

SEPARATOR = "|"
"""Between output, input and part in the names of symbols."""
FREQUENCY = Expression(ca.SX.sym("frequency"), "frequency", "Hz")
PARTS = ("amplitude", "phase", "real", "imag")
"""Measures of an output."""
ANGLES = {"phase": "rad"}
NONE: Mapping[str, Expression] = MappingProxyType({})


@dataclass(frozen=True)
class Transfer:
    """Output and input of a symbol; an empty input is the only one.

    Attributes
    ----------
    output, input : names
    part : ``real`` or ``imag``
    """

    output: str
    input: str
    part: str

    @classmethod
    def of(cls, symbol: str) -> Transfer | None:
        """The transfer of a symbol of a formula, or None for other symbols."""
        pieces = symbol.split(SEPARATOR)
        return cls(*pieces) if len(pieces) == 3 else None

    @property
    def symbol(self) -> ca.SX:
        return ca.SX.sym(SEPARATOR.join((self.output, self.input, self.part)))


def part_name(output: str, part: str, source: str = "") -> str:
    """Name of a part of an output: ``tip.y.amplitude``, of a formula ``(a.y - b.y).amplitude``."""
    plain = all(piece.isidentifier() for piece in output.split("."))
    base = output if plain else f"({output})"
    return f"{base}.{source}.{part}" if source else f"{base}.{part}"


def measures_of(model: Any, outputs: Mapping[str, Expression] = NONE) -> Names:
    """Measures of harmonic responses: ``tip.y.amplitude``, of several inputs ``tip.y.push.phase``.

    Any scalar measure of the model, an output, or a formula in brackets is followed by
    ``amplitude``, ``phase``, ``real`` or ``imag``.

    Parameters
    ----------
    model : of the response
    outputs : name → measure of further outputs
    """
    expressions: dict[str, Expression | None] = {"frequency": FREQUENCY}

    def find(name: str) -> Expression | None:
        if name not in expressions:
            expressions[name] = _measure(model, name, outputs)
        return expressions[name]

    def known() -> list[str]:
        own = [*outputs, *model.outputs] or model.keys()
        names = [part_name(name, "amplitude") for name in dict.fromkeys(own)]
        return [*names, *model.parameters, "frequency"]

    return Names(find, known)


def _measure(model: Any, name: str, outputs: Mapping[str, Expression]) -> Expression | None:
    own = model.parameters | model.derived_parameters
    if name in own:
        return own[name]  # type: ignore[no-any-return]
    base, _, part = name.rpartition(".")
    if part not in PARTS or not base:
        return None
    measure, source = output_of(model, base, outputs), ""
    if measure is None:
        base, _, source = base.rpartition(".")
        measure = output_of(model, base, outputs) if base else None
    if measure is None or len(measure) != 1:
        return None
    real, imag = (Transfer(bare(base), source, kind).symbol for kind in ("real", "imag"))
    values = {
        "amplitude": ca.sqrt(real**2 + imag**2),
        "phase": ca.atan2(imag, real),
        "real": real,
        "imag": imag,
    }
    return Expression(values[part], name, ANGLES.get(part, measure.unit))


def consists_of(measure: Expression, symbols: Iterable[ca.SX]) -> bool:
    """Whether a formula consists of parts of amplitudes, the frequency and these symbols."""
    known = {s.element_hash() for sx in (FREQUENCY.sx, *symbols) for s in ca.symvar(sx)}
    return all(s.element_hash() in known or Transfer.of(s.name()) for s in ca.symvar(measure.sx))


def with_densities(
    names: Names,
    model: Any,
    density: Callable[[str, str], Expression],
    outputs: Mapping[str, Expression] = NONE,
) -> Names:
    """Names and ``X.psd`` of any scalar measure ``X``.

    Parameters
    ----------
    names : of harmonic responses
    model : of the response
    density : name of ``X`` and unit of its density → the density
    outputs : name → measure of further outputs
    """

    def find(name: str) -> Expression | None:
        base, _, part = name.rpartition(".")
        output = output_of(model, base, outputs) if part == "psd" and base else None
        if output is None or len(output) != 1:
            return names.find(name)
        return density(bare(base), density_unit(output.unit))

    def known() -> list[str]:
        own = names.known()
        bases = [name.removesuffix(".amplitude") for name in own if name.endswith(".amplitude")]
        return [*own, *(f"{base}.psd" for base in bases)]

    return Names(find, known)


def output_of(model: Any, name: str, outputs: Mapping[str, Expression] = NONE) -> Expression | None:
    """An output or measure of a model, or a formula of measures in brackets; None for others."""
    inner = bare(name)
    if inner in outputs:
        return outputs[inner]
    if inner == name:
        return model.names.find(name)  # type: ignore[no-any-return]
    try:
        return model.expression(inner)  # type: ignore[no-any-return]
    except ExpressionError:
        return None


def bare(name: str) -> str:
    """A formula without the brackets around the whole; other names as they are."""
    if not (name.startswith("(") and name.endswith(")")):
        return name
    depth = 0
    for k, letter in enumerate(name):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and k < len(name) - 1:
            return name
    return name[1:-1]
