"""C text of a function of the graph, with the loop that calls it for many columns."""

from __future__ import annotations

from contextlib import redirect_stderr
from io import StringIO

import casadi as ca

ENTRY = "dalembert_columns"
"""The function of a library that is called."""
LOOP = f"""
/* how many columns were done: all, or those before the first that fails */
CASADI_SYMBOL_EXPORT casadi_int {ENTRY}(casadi_int count, casadi_int n_in, casadi_int n_out,
    const casadi_real** from, const casadi_int* from_step, casadi_real** to,
    const casadi_int* to_step, const casadi_real** arg, casadi_real** res, casadi_int* iw,
    casadi_real* w) {{
  casadi_int k, i;
  for (k=0; k<count; ++k) {{
    for (i=0; i<n_in; ++i) arg[i] = from[i]+k*from_step[i];
    for (i=0; i<n_out; ++i) res[i] = to[i]+k*to_step[i];
    if (casadi_f0(arg, res, iw, w, 0)) return k;
  }}
  return count;
}}
"""


def c_source(function: ca.Function) -> str | None:
    """C text of a function; None where CasADi cannot write it, as for SUNDIALS."""
    generator = ca.CodeGenerator("dalembert.c")
    try:
        with redirect_stderr(StringIO()):  # CasADi warns of what is told here by the answer
            generator.add(function)
            text = generator.dump()
    except RuntimeError:
        return None
    stateless = f"int {function.name()}_checkout(void) {{\n  return 0;" in text
    return text + LOOP if stateless and "\n  #error" not in text else None
