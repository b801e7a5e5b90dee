"""C text of graph functions, with their loop over columns."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import redirect_stderr
from io import StringIO
from typing import Any

import casadi as ca

from dalembert.symbolic.native.toolchain import ENTRY, FIRST, LOOP, Toolchain

FACTORISED = re.compile(
    r"^  casadi_qr\(\w+, \w+, \w+, \w+, \w+, (\w+), (\w+), \w+, \w+, (\w+)\);$", re.MULTILINE
)
SINGULAR = r"  if (casadi_qr_singular(0, 0, \2, \1, \3, 1e-12)) return 1;"
"""Singularity check of the virtual machine, which CasADi's texts omit."""


ALIAS = r"int {}\([^{{}}]*\{{\s*return (casadi_f\d+)\("
"""Definition of the public function of a name by one of the numbered functions."""


def c_source(function: ca.Function) -> str | None:
    """C text of a function and its loop; None if CasADi cannot write it, as for SUNDIALS."""
    text = _c_text([function])
    return None if text is None else text + LOOP.format(entry=ENTRY, function=FIRST)


def loop_name(name: str) -> str:
    """Name of the loop of one of several functions."""
    return f"dalembert_{name}"


def c_sources(functions: Mapping[str, ca.Function]) -> str | None:
    """C text of several functions, each with a loop; None if CasADi cannot write it."""
    renamed = [_renamed(f, f"web_{name}") for name, f in functions.items()]
    text = _c_text(renamed)
    if text is None:
        return None
    loops = []
    for name in functions:
        match = re.search(ALIAS.format(f"web_{name}"), text)
        assert match is not None
        loops.append(LOOP.format(entry=loop_name(name), function=match[1]))
    return text + "".join(loops)


def c_functions(functions: Mapping[str, ca.Function]) -> str | None:
    """C text of several functions by their names, without loops; None if CasADi cannot write it."""
    return _c_text([_renamed(f, name) for name, f in functions.items()])


def _renamed(function: ca.Function, name: str) -> ca.Function:
    """The same function by another name."""
    inputs: Any = function.sx_in() if function.is_a("SXFunction") else function.mx_in()
    outputs = function.call(inputs, function.is_a("MXFunction"), False)
    return ca.Function(name, inputs, outputs)


def _c_text(functions: list[ca.Function]) -> str | None:
    """C text of functions, with checks of singular factors; None if CasADi cannot write it."""
    generator = ca.CodeGenerator("dalembert.c")
    try:
        with redirect_stderr(StringIO()):  # the result reports warnings of CasADi
            for function in functions:
                generator.add(function)
            text = generator.dump()
    except RuntimeError:
        return None
    for function in functions:
        if f"int {function.name()}_checkout(void) {{\n  return 0;" not in text:
            return None
    return None if "\n  #error" in text else FACTORISED.sub(rf"\g<0>\n{SINGULAR}", text)


def obstacle(text: str | None, toolchain: Toolchain) -> str:
    """Reason not to compile a function; empty if machine code may pay."""
    if text is None:
        return "CasADi cannot write this integrator as C"
    if toolchain.longest is None or len(text) <= toolchain.longest:
        return ""
    return f"{len(text) / 1e6:.1f} MB of C would gain little"
