"""The loop that calls a function of the graph for many columns, in the C of CasADi's texts."""

from __future__ import annotations

import ctypes

ENTRY = "dalembert_columns"
"""The function of a library that is called."""
FIRST = "casadi_f0"
"""The function of a text that the loop calls."""
PIECES = "dalembert_pieces"
"""Two numbers of a library of LLVM: pieces of straight bodies, and how many of these differ."""
SIGNATURE = ctypes.CFUNCTYPE(ctypes.c_longlong, *[ctypes.c_longlong] * 3, *[ctypes.c_void_p] * 8)
"""Its type: three counts and eight addresses."""
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
    if ({FIRST}(arg, res, iw, w, 0)) return k;
  }}
  return count;
}}
"""
