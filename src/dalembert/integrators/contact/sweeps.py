"""Accelerated projected Gauss–Seidel sweeps, in machine code.

A sweep visits all contacts forwards and backwards: ``P_N ← max(minimum, P_N − u_N/H_NN)``, then
``P_j ← P_j − ρ u_j`` of each tangential group, shortened to ``μ_j P_N``; the speeds of the bodies
follow at once (Jourdan, Alart & Jean, Comput. Methods Appl. Mech. Eng. 155, 1998). The next sweep
begins from impulses extrapolated by the momentum ``j/(j + 3)`` (Nesterov 1983), ``j`` being the
number of sweeps since the changes last grew (O'Donoghue & Candès, Found. Comput. Math. 15, 2015).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.symbolic.evaluation.switching import best_toolchain
from dalembert.symbolic.native.code_cache import compiled_loop
from dalembert.symbolic.native.toolchain import ENTRY, FIRST, LOOP, Call

TEXT = """
#include <math.h>
#define casadi_real double
#define casadi_int long long int
#ifdef _WIN32
#define CASADI_SYMBOL_EXPORT __declspec(dllexport)
#else
#define CASADI_SYMBOL_EXPORT
#endif
static casadi_real casadi_row(const casadi_real* value, const int* column, casadi_int begin,
    casadi_int end, const casadi_real* speed) {
  casadi_int j;
  casadi_real sum = 0;
  for (j=begin; j<end; ++j) sum += value[j]*speed[column[j]];
  return sum;
}
static void casadi_push(const casadi_real* value, const int* column, casadi_int begin,
    casadi_int end, casadi_real impulse, casadi_real* speed) {
  casadi_int j;
  for (j=begin; j<end; ++j) speed[column[j]] += value[j]*impulse;
}
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w,
    int mem) {
  const casadi_real* directions = arg[0];
  const casadi_real* responses = arg[1];
  const casadi_real* velocity = arg[2];
  const casadi_real* friction = arg[3];
  const casadi_real* minimum = arg[4];
  const casadi_real* mobility = arg[5];
  const casadi_real* weight = arg[6];
  const casadi_real* shift = arg[7];
  const casadi_real* tolerance = arg[8];
  const int* w_row = (const int*) arg[9];
  const int* w_column = (const int*) arg[10];
  const int* x_row = (const int*) arg[11];
  const int* x_column = (const int*) arg[12];
  const int* group = (const int*) arg[13];
  casadi_real* impulse = res[0];
  casadi_real* speed = res[1];
  casadi_real* search = res[2];
  casadi_real* before = res[3];
  casadi_int count = iw[0], width = iw[1], groups = iw[2], sweeps = iw[3], rows = count*width;
  casadi_int sweep, m, i, g, a, r, start = 0;
  casadi_real largest, u, d, length, limit, share, square, last = 0;
  for (sweep=0; sweep<sweeps; ++sweep) {
    largest = 0;
    for (r=0; r<rows; ++r) before[r] = impulse[r];
    for (m=0; m<2*count; ++m) {
      i = m<count ? m : 2*count-1-m;
      r = i*width;
      u = velocity[r] + shift[r]*impulse[r];
      u += casadi_row(directions, w_column, w_row[r], w_row[r+1], speed);
      d = impulse[r] - u/mobility[r];
      d = (d>minimum[i] ? d : minimum[i]) - impulse[r];
      if (d!=0) {
        impulse[r] += d;
        if (fabs(d)*weight[r]>largest) largest = fabs(d)*weight[r];
        casadi_push(responses, x_column, x_row[r], x_row[r+1], d, speed);
      }
      for (g=0; g<groups; ++g) {
        limit = friction[i*groups+g]*impulse[i*width];
        length = 0;
        for (a=group[g]; a<group[g+1]; ++a) {
          w[a] = 0;
          if (!(limit>0)) continue;
          r = i*width + a;
          u = velocity[r] + shift[r]*impulse[r];
          u += casadi_row(directions, w_column, w_row[r], w_row[r+1], speed);
          w[a] = impulse[r] - u/mobility[r];
          length += w[a]*w[a];
        }
        length = sqrt(length);
        for (a=group[g]; a<group[g+1]; ++a) {
          r = i*width + a;
          d = (length>limit ? w[a]*(limit/length) : w[a]) - impulse[r];
          if (d!=0) {
            impulse[r] += d;
            if (fabs(d)*weight[r]>largest) largest = fabs(d)*weight[r];
            casadi_push(responses, x_column, x_row[r], x_row[r+1], d, speed);
          }
        }
      }
    }
    if (!(largest>tolerance[0])) return 0;
    square = 0;
    for (r=0; r<rows; ++r) {
      d = impulse[r] - before[r];
      square += d*d*mobility[r];
    }
    if (square>last) start = sweep;
    share = (sweep-start)/(sweep-start+3.0);
    last = square;
    for (r=0; r<rows; ++r) {
      d = share*search[r];
      search[r] = d + impulse[r] - before[r];
      if (d!=0) {
        impulse[r] += d;
        casadi_push(responses, x_column, x_row[r], x_row[r+1], d, speed);
      }
    }
  }
  return 0;
}
"""
"""C text of the sweeps; they end when no contact changes its speed by more than the tolerance."""
SWEEPS = 300
"""Upper limit of sweeps before Newton's method takes over."""


def swept(problem: FrictionProblem, impulses: np.ndarray, tolerance: float) -> np.ndarray:
    """Impulses after sweeps; the same ones where no machine code is available.

    Parameters
    ----------
    problem : FrictionProblem
    impulses : (n, k) initial guess
    tolerance : change of the speed of a contact at which the sweeps end [m/s]
    """
    operator, loop = problem.matrix, _loop()
    if loop is None or not isinstance(operator, Delassus) or not problem.shape[0]:
        return impulses
    w, x = operator.directions, operator.responses
    result, rows = np.array(impulses), impulses.size
    minimum = np.broadcast_to(problem.minimum, result.shape[:1])
    values = [w.data, x.data, problem.velocity, problem.friction, minimum]
    values += [problem.mobility, problem.weights, operator.shift]
    indices = [w.indptr, w.indices, x.indptr, x.indices, problem.starts]
    inputs = [np.ascontiguousarray(v, dtype=float) for v in (*values, np.array([tolerance]))]
    inputs += [index.astype(np.int32, copy=False) for index in indices]
    outputs = [result, operator.response(result.ravel()), np.zeros(rows), np.empty(rows)]
    counts = np.array([*problem.shape, len(problem.groups), SWEEPS])
    _call(loop, inputs, outputs, counts, np.empty(problem.shape[1]))
    return result if np.isfinite(result).all() else impulses


def _call(
    loop: Call,
    inputs: list[np.ndarray],
    outputs: list[np.ndarray],
    counts: np.ndarray,
    work: np.ndarray,
) -> None:
    """Run the code once, with the integers ``counts``."""
    tables = (
        np.array([a.ctypes.data for a in part], dtype=np.uint64) for part in (inputs, outputs)
    )
    steps, pointers = np.zeros(len(inputs), dtype=np.int64), np.empty(len(inputs), dtype=np.uint64)
    source, target = tables
    memory = source, steps, target, steps, pointers, pointers.copy(), counts, work
    loop(1, len(inputs), len(outputs), *(array.ctypes.data for array in memory))


@lru_cache
def _loop() -> Call | None:
    """Machine code of the sweeps; None without a toolchain."""
    toolchain = best_toolchain()
    if toolchain is None:
        return None
    try:
        return compiled_loop(TEXT + LOOP.format(entry=ENTRY, function=FIRST), toolchain)
    except UnsupportedError:  # an optional acceleration
        return None
