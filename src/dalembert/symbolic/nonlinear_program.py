"""Nonlinear programs, solved by Ipopt (Wächter & Biegler 2006)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

MAX_ITERATIONS = 2**31 - 1
"""Upper limit of the iterations in Ipopt's 32-bit counter."""


def ipopt(
    name: str,
    program: Mapping[str, Any],
    tolerance: float,
    max_iterations: int,
    settings: Mapping[str, Any] | None = None,
    **options: Any,
) -> ca.Function:
    """Quiet Ipopt solver; its status is in ``stats()``, a failure raises nothing.

    Parameters
    ----------
    program : symbols ``x``, objective ``f``, constraints ``g``
    tolerance : of the optimality conditions, relative
    max_iterations : upper limit of the iterations
    settings : further settings of Ipopt
    **options : further options of CasADi's interface
    """
    ipopt_settings = {
        "print_level": 0,
        "sb": "yes",
        "max_iter": min(max_iterations, MAX_ITERATIONS),
        "tol": tolerance,
        **(settings or {}),
    }
    quiet = {"print_time": False, "error_on_fail": False, "show_eval_warnings": False}
    return ca.nlpsol(name, "ipopt", dict(program), {"ipopt": ipopt_settings, **quiet, **options})


def return_status(solver: ca.Function) -> str:
    """Ipopt's return status in words, such as ``solve succeeded``."""
    return str(solver.stats()["return_status"]).replace("_", " ").lower()
