"""Measures of harmonic responses: parts of complex amplitudes by output and input."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import Names

SEPARATOR = "|"
"""Between output, input and part in the names of symbols."""
FREQUENCY = Expression(ca.SX.sym("frequency"), "frequency", "Hz")
PARTS = ("amplitude", "phase", "real", "imag")
"""Measures of an output."""
ANGLES = {"phase": "rad"}


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


def measures_of(model: Any) -> Names:
    """Measures of harmonic responses: ``tip.y.amplitude``, of several inputs ``tip.y.push.phase``.

    Any scalar measure of the model, or an output, is followed by ``amplitude``, ``phase``, ``real``
    or ``imag``.
    """
    expressions: dict[str, Expression | None] = {"frequency": FREQUENCY}

    def find(name: str) -> Expression | None:
        if name not in expressions:
            expressions[name] = _measure(model, name)
        return expressions[name]

    def known() -> list[str]:
        outputs = list(model.outputs) or model.keys()
        return [*(f"{name}.amplitude" for name in outputs), *model.parameters, "frequency"]

    return Names(find, known)


def _measure(model: Any, name: str) -> Expression | None:
    own = model.parameters | model.derived_parameters
    if name in own:
        return own[name]  # type: ignore[no-any-return]
    base, _, part = name.rpartition(".")
    if part not in PARTS or not base:
        return None
    measure, source = output_of(model, base), ""
    if measure is None:
        base, _, source = base.rpartition(".")
        measure = output_of(model, base) if base else None
    if measure is None or len(measure) != 1:
        return None
    real, imag = (Transfer(base, source, kind).symbol for kind in ("real", "imag"))
    values = {
        "amplitude": ca.sqrt(real**2 + imag**2),
        "phase": ca.atan2(imag, real),
        "real": real,
        "imag": imag,
    }
    return Expression(values[part], name, ANGLES.get(part, measure.unit))


def output_of(model: Any, name: str) -> Expression | None:
    """A measure or output of a model, or None."""
    return model.names.find(name)  # type: ignore[no-any-return]
