"""Squares and square roots of units, for spectral densities."""

from __future__ import annotations

import re

POWER = re.compile(r"([^\s/^\d]+)(?:\^(\d+(?:\.\d+)?))?")
"""A unit and its exponent."""
PER_HERTZ = "/Hz"


def density_unit(unit: str) -> str:
    """Unit of a spectral density: ``m/s^2`` → ``m^2/s^4/Hz``."""
    return f"{_raised(unit, 2)}{PER_HERTZ}" if unit not in ("", "1") else f"1{PER_HERTZ}"


def unit_of_density(unit: str) -> str:
    """Unit of a quantity with a spectral density: ``m^2/s^4/Hz`` → ``m/s^2``."""
    square = unit.removesuffix(PER_HERTZ)
    return "" if square in ("", "1") else _raised(square, 0.5)


def _raised(unit: str, exponent: float) -> str:
    def power(match: re.Match[str]) -> str:
        number = float(match[2] or 1) * exponent
        return match[1] if number == 1 else f"{match[1]}^{number:g}"

    return POWER.sub(power, unit)
