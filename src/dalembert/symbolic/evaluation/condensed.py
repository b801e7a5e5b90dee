"""Functions in which what occurs twice is computed once, where looking for it pays.

CasADi takes 10 µs for each operation to look, and finds about a sixth of them. That is paid back
by ten thousand evaluations, or by none where a function is called once in a run; in large models
it would be most of the time to the first step.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

LARGE = 100_000
"""Operations up to which is looked."""
SELDOM = 10_000
"""The same for what is evaluated at starts and outputs, not in every step."""


def condensed(
    name: str,
    inputs: list[ca.SX],
    outputs: list[ca.SX],
    most: int = LARGE,
    options: dict[str, Any] | None = None,
) -> ca.Function:
    """``inputs → outputs``.

    Parameters
    ----------
    most : operations up to which those that occur twice are looked for
    options : of the function
    """
    plain = ca.Function(name, inputs, outputs, options or {})
    if plain.n_instructions() > most:
        return plain
    return ca.Function(name, inputs, outputs, {**(options or {}), "cse": True})
