"""Units in texts: ``45 mm``, ``60 rpm``, ``3 kN/mm``. All else is SI and radians.

The names are those of pint, with prefixes. The coherent ones, ``N m`` or ``kg/s^2``, are known
here, so that what has no other units need not wait for a registry.

Angles are a dimension, as far as one is given: ``rad/s`` is no ``1/s`` and no ``Hz``, which counts
cycles; ``N m`` may stand for ``N m/rad``, as is usual.
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
from dalembert.text.wording import nearest

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
"""Name of a unit that needs no number → exponents of the bases."""
BASES = {
    "meter": "m",
    "kilogram": "kg",
    "second": "s",
    "kelvin": "K",
    "radian": "rad",
    "ampere": "A",
    "count": "cycle",
}
"""How pint calls them."""
OWN = {
    "radian = [] = rad": "radian = [angle] = rad",
    "hertz = 1 / second = Hz": "hertz = count / second = Hz",
}
"""Lines of pint's definitions, and what stands here instead."""
SYMBOL = r"(?:[^\W\d_]\w*|[°%]\w*)"
POWER = r"(?:(?:\^|\*\*)-?\d+(?:\.\d+)?|[²³⁴])"
UNIT = rf"{SYMBOL}{POWER}?"
_TOKEN = re.compile(rf"\s*(?:(?P<by>[*·/](?!\*))|(?P<name>1|{SYMBOL})(?P<power>{POWER})?)\s*")
MOST_POWER = 12
_RAISED = {"²": 2, "³": 3, "⁴": 4}


@dataclass(frozen=True)
class Unit:
    """So many SI units, of a dimension.

    Attributes
    ----------
    text : as it was written
    factor : SI units in one of it
    dimension : exponents of kg, m, s, K, A, rad and cycle
    si : the unit of SI in its place, ``N/m`` for ``kN/mm``
    """

    text: str
    factor: float
    dimension: Mapping[str, float]
    si: str

    def fits(self, expected: str) -> bool:
        """Whether a number in it can stand where ``m``, or ``m | rad``, is expected."""
        try:
            wanted = [unit(one).dimension for one in expected.split("|")]
        except ExpressionError:  # such as N/m^n, which any may be
            return True
        own = {base: n for base, n in self.dimension.items() if n}
        return any(own in ({**w}, _without_angle(w)) for w in wanted)

    def without_angle(self) -> Unit:
        """The coherent unit with angles taken as plain numbers."""
        return made_unit(_without_angle(self.dimension))


LONGEST = 200
"""Characters of a unit."""


@functools.lru_cache(maxsize=1000)
def unit(text: str) -> Unit:
    """The unit behind a text such as ``N m/rad``, ``mm²`` or ``1/s``.

    What follows a ``/`` divides, one unit only: ``N/m s`` is ``(N/m)·s``.

    Raises
    ------
    ExpressionError
        A name that is no unit, a text that is none, or degrees of a temperature scale.
    """
    if len(text) > LONGEST:
        raise ExpressionError(
            f"{text[:60]!r}… is no unit: it has {len(text)} characters, {LONGEST} at most"
        )
    factor, dimension, spelled, simple = 1.0, dict[str, float](), "", True
    place, sign, rest = 0, 1, text.strip()
    while place < len(rest):
        found = _TOKEN.match(rest, place)
        if not found:
            raise ExpressionError(f"{text!r} is no unit; write e.g. 'mm', 'N m', 'kg/m^3'")
        place = found.end()
        if found["by"]:
            sign = -1 if found["by"] == "/" else 1
            continue
        power = found["power"] or "1"
        exponent = sign * (_RAISED.get(power) or float(power.lstrip("^*")))
        if abs(exponent) > MOST_POWER:
            raise ExpressionError(f"{text[:60]!r} is no unit; powers are up to {MOST_POWER}")
        one = _named(found["name"])
        factor *= one.factor**exponent
        for base, n in one.dimension.items():
            dimension[base] = dimension.get(base, 0) + n * exponent
        spelled += "/" if sign < 0 else " " if spelled else ""
        spelled += (one.si or "1") + (f"^{abs(exponent):g}" if abs(exponent) != 1 else "")
        simple = simple and one.si.isalnum()
        sign = 1
    kept = {base: n for base, n in dimension.items() if n}
    return Unit(text, factor, MappingProxyType(kept), spelled if simple else si_unit(kept))


def si_unit(dimension: Mapping[str, float]) -> str:
    """The coherent unit of a dimension, such as ``kg m/s^2`` or ``N``."""
    kept = {base: n for base, n in dimension.items() if n}
    for name, known in COHERENT.items():
        if known == kept:
            return "" if name == "1" else name
    up = [f"{base}^{n:g}" if n != 1 else base for base, n in kept.items() if n > 0]
    down = [f"/{base}^{-n:g}" if n != -1 else f"/{base}" for base, n in kept.items() if n < 0]
    return (" ".join(up) or "1") + "".join(down)


def made_unit(dimension: Mapping[str, float]) -> Unit:
    """The coherent unit of a dimension."""
    name = si_unit(dimension)
    return Unit(name, 1.0, dimension, name)


@functools.lru_cache(maxsize=1000)
def _named(name: str) -> Unit:
    """A unit by its plain name."""
    if name in COHERENT:
        return Unit(name, 1.0, COHERENT[name], name)
    registry = _registry()
    try:
        one = registry.Quantity(1.0, registry.parse_units(name)).to_base_units()
        two = registry.Quantity(2.0, registry.parse_units(name)).to_base_units()
    except Exception:  # its errors are of many kinds
        raise ExpressionError(f"unknown unit {name!r}{_nearest(name)}") from None
    if not math.isclose(two.magnitude, 2 * one.magnitude):
        raise ExpressionError(f"{name} has a zero of its own; temperatures are changes, write 'K'")
    found = {BASES.get(str(base), str(base)): n for base, n in one.unit_items()}
    return Unit(name, float(one.magnitude), found, si_unit(found))


@functools.cache
def _registry() -> Any:
    """Pint's units, with angles and cycles as dimensions."""
    from importlib.resources import files

    import pint

    text = (files(pint) / "default_en.txt").read_text(encoding="utf-8")
    constants = (files(pint) / "constants_en.txt").read_text(encoding="utf-8")
    for line, own in {**OWN, "@import constants_en.txt": constants}.items():
        if line not in text:
            raise ExpressionError(f"the units of pint {pint.__version__} are not known here")
        text = text.replace(line, own)
    registry: Any = pint.UnitRegistry(None)
    registry.load_definitions(text.splitlines())
    registry.default_system = "mks"
    return registry


def _nearest(name: str) -> str:
    common = "mm cm km um in ft deg rpm turn g t lbf kN MN MPa GPa bar psi ms min h Hz kHz kJ kW"
    return nearest(name, [*COHERENT, *common.split()])


def _without_angle(dimension: Mapping[str, float]) -> dict[str, float]:
    return {base: n for base, n in dimension.items() if base != "rad"}


def shown_in(si: str, wanted: Sequence[str]) -> tuple[float, str]:
    """Factor and name of the first wanted unit of the same dimension; 1 and its own if none is."""
    if not wanted or not si or " or " in si:  # of a variable that holds forces and moments, say
        return 1.0, si
    own = unit(si)
    for text in wanted:
        other = unit(text)
        if dict(other.dimension) == dict(own.dimension):
            return other.factor / own.factor, text
    return 1.0, si
