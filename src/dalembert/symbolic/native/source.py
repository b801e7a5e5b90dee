"""C text of graph functions, with their loop over columns."""

from __future__ import annotations

import re
from contextlib import redirect_stderr
from io import StringIO

import casadi as ca

from dalembert.symbolic.native.toolchain import LOOP, Toolchain

FACTORISED = re.compile(
    r"^  casadi_qr\(\w+, \w+, \w+, \w+, \w+, (\w+), (\w+), \w+, \w+, (\w+)\);$", re.MULTILINE
)
SINGULAR = r"  if (casadi_qr_singular(0, 0, \2, \1, \3, 1e-12)) return 1;"
"""Singularity check of the virtual machine, which CasADi's texts omit."""


def c_source(function: ca.Function) -> str | None:
    """C text of a function and its loop; None if CasADi cannot write it, as for SUNDIALS."""
    generator = ca.CodeGenerator("dalembert.c")
    try:
        with redirect_stderr(StringIO()):  # the result reports warnings of CasADi
            generator.add(function)
            text = generator.dump()
    except RuntimeError:
        return None
    stateless = f"int {function.name()}_checkout(void) {{\n  return 0;" in text
    if not stateless or "\n  #error" in text:
        return None
    return FACTORISED.sub(rf"\g<0>\n{SINGULAR}", text) + LOOP


def obstacle(text: str | None, toolchain: Toolchain) -> str:
    """Reason not to compile a function; empty if machine code may pay."""
    if text is None:
        return "CasADi cannot write this integrator as C"
    if toolchain.longest is None or len(text) <= toolchain.longest:
        return ""
    return f"{len(text) / 1e6:.1f} MB of C would gain little"
