"""Units in texts: ``45 mm``, ``60 rpm``, ``3 kN/mm``. Internally all is SI and radians.

The names are those of pint, with prefixes. Coherent units, ``N m`` or ``kg/s^2``, are parsed here,
so that models in SI units do not load the registry of pint.

An angle that is stated is a dimension: ``rad/s`` is neither ``1/s`` nor ``Hz``, which counts
cycles. An angle may be omitted: ``N m`` may stand for ``N m/rad``, as is usual.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from dalembert.errors import ExpressionError
from dalembert.text.wording import misspelt

NEWTON = {"kg": 1, "m": 1, "s": -2}
COHERENT: dict[str, dict[str, int]] = {
    **{base: {base: 1} for base in ("m", "kg", "s", "K", "rad", "A")},
    "N": NEWTON,
    "J": NEWTON | {"m": 2},
    "W": NEWTON | {"m": 2, "s": -3},
    "Pa": NEWTON | {"m": -1},
    "Hz": {"cycle": 1, "s": -1},
    "1": {},
}
"""Coherent unit → exponents of the base units."""
BASES = {
    "meter": "m",
    "kilogram": "kg",
    "second": "s",
    "kelvin": "K",
    "radian": "rad",
    "ampere": "A",
    "count": "cycle",
}
"""Base units by pint's names."""
OWN = {
    "radian = [] = rad": "radian = [angle] = rad",
    "hertz = 1 / second = Hz": "hertz = count / second = Hz",
}
"""Lines of pint's definitions → their replacements."""
SYMBOL = r"(?:[^\W\d_]\w*|[°%]\w*)"
POWER = r"(?:(?:\^|\*\*)-?\d+(?:\.\d+)?|[²³⁴])"
UNIT = rf"{SYMBOL}{POWER}?"
_TOKEN = re.compile(rf"\s*(?:(?P<by>[*·/](?!\*))|(?P<name>1|{SYMBOL})(?P<power>{POWER})?)\s*")
MOST_POWER = 12
_RAISED = {"²": 2, "³": 3, "⁴": 4}


@dataclass(frozen=True)
class Unit:
    """A unit: its size in SI units and its dimension.

    Attributes
    ----------
    text : as written
    factor : its size in SI units
    dimension : exponents of kg, m, s, K, A, rad and cycle
    si : the coherent unit of the same dimension, ``N/m`` for ``kN/mm``
    """

    text: str
    factor: float
    dimension: Mapping[str, float]
    si: str

    def fits(self, expected: str) -> bool:
        """Whether its dimension is that of an expected unit such as ``m`` or ``m | rad``."""
        try:
            accepted = [unit(text).dimension for text in expected.split("|")]
        except ExpressionError:  # such as N/m^n, of any dimension
            return True
        dimension = {base: n for base, n in self.dimension.items() if n}
        return any(dimension in ({**a}, _without_angle(a)) for a in accepted)

    def without_angle(self) -> Unit:
        """The coherent unit with angles taken as plain numbers."""
        return coherent_unit(_without_angle(self.dimension))


LONGEST = 200
"""Upper limit of the length of a unit."""


@functools.lru_cache(maxsize=1000)
def unit(text: str) -> Unit:
    """The unit of a text such as ``N m/rad``, ``mm²`` or ``1/s``.

    A ``/`` applies to the next unit only: ``N/m s`` is ``(N/m)·s``.

    Raises
    ------
    ExpressionError
        An unknown unit, a text that is not a unit, or degrees of a temperature scale.
    """
    if len(text) > LONGEST:
        raise ExpressionError(
            f"{text[:60]!r}… is no unit: it has {len(text)} characters, {LONGEST} at most"
        )
    factor, dimension, spelled, simple = 1.0, dict[str, float](), "", True
    position, sign, stripped = 0, 1, text.strip()
    while position < len(stripped):
        match = _TOKEN.match(stripped, position)
        if not match:
            raise ExpressionError(f"{text!r} is no unit; write e.g. 'mm', 'N m', 'kg/m^3'")
        position = match.end()
        if match["by"]:
            sign = -1 if match["by"] == "/" else 1
            continue
        power = match["power"] or "1"
        exponent = sign * (_RAISED.get(power) or float(power.lstrip("^*")))
        if abs(exponent) > MOST_POWER:
            raise ExpressionError(f"{text[:60]!r} is no unit; powers are up to {MOST_POWER}")
        named = _named(match["name"])
        factor *= named.factor**exponent
        for base, n in named.dimension.items():
            dimension[base] = dimension.get(base, 0) + n * exponent
        spelled += "/" if sign < 0 else " " if spelled else ""
        spelled += (named.si or "1") + (f"^{abs(exponent):g}" if abs(exponent) != 1 else "")
        simple = simple and named.si.isalnum()
        sign = 1
    nonzero = {base: n for base, n in dimension.items() if n}
    return Unit(text, factor, MappingProxyType(nonzero), spelled if simple else si_unit(nonzero))


def si_unit(dimension: Mapping[str, float]) -> str:
    """The coherent unit of a dimension, such as ``kg m/s^2`` or ``N``."""
    nonzero = {base: n for base, n in dimension.items() if n}
    for name, exponents in COHERENT.items():
        if exponents == nonzero:
            return "" if name == "1" else name
    up = [f"{base}^{n:g}" if n != 1 else base for base, n in nonzero.items() if n > 0]
    down = [f"/{base}^{-n:g}" if n != -1 else f"/{base}" for base, n in nonzero.items() if n < 0]
    return (" ".join(up) or "1") + "".join(down)


def coherent_unit(dimension: Mapping[str, float]) -> Unit:
    """The coherent unit of a dimension."""
    name = si_unit(dimension)
    return Unit(name, 1.0, dimension, name)


COMMON = "mm cm km um in ft deg rpm turn g t lbf kN MN MPa GPa bar psi ms min h Hz kHz kJ kW"
"""Further units that messages suggest."""


@functools.lru_cache(maxsize=1000)
def _named(name: str) -> Unit:
    """A unit by its name."""
    if name in COHERENT:
        return Unit(name, 1.0, COHERENT[name], name)
    registry = _registry()
    try:
        single = registry.Quantity(1.0, registry.parse_units(name)).to_base_units()
        double = registry.Quantity(2.0, registry.parse_units(name)).to_base_units()
    except Exception:  # pint raises many types
        known = [*COHERENT, *COMMON.split()]
        raise ExpressionError(misspelt(f"unknown unit {name!r}", name, known, "")) from None
    if not math.isclose(double.magnitude, 2 * single.magnitude):
        raise ExpressionError(f"{name} has an offset; temperatures are differences, write 'K'")
    dimension = {BASES.get(str(base), str(base)): n for base, n in single.unit_items()}
    return Unit(name, float(single.magnitude), dimension, si_unit(dimension))


@functools.cache
def _registry() -> Any:
    """Pint's units, with angles and cycles as dimensions."""
    from importlib.resources import files

    import pint

    text = (files(pint) / "default_en.txt").read_text(encoding="utf-8")
    constants = (files(pint) / "constants_en.txt").read_text(encoding="utf-8")
    for line, replacement in {**OWN, "@import constants_en.txt": constants}.items():
        if line not in text:
            raise ExpressionError(f"the units of pint {pint.__version__} are not supported")
        text = text.replace(line, replacement)
    registry: Any = pint.UnitRegistry(None)
    registry.load_definitions(text.splitlines())
    registry.default_system = "mks"
    return registry


def _without_angle(dimension: Mapping[str, float]) -> dict[str, float]:
    return {base: n for base, n in dimension.items() if base != "rad"}


def shown_in(si: str, wanted: Sequence[str]) -> tuple[float, str]:
    """Factor and name of the first wanted unit of the same dimension; 1 and ``si`` without one."""
    if not wanted or not si or " or " in si:  # a variable that holds forces and moments
        return 1.0, si
    source = unit(si)
    for text in wanted:
        target = unit(text)
        if dict(target.dimension) == dict(source.dimension):
            return target.factor / source.factor, text
    return 1.0, si
