"""Continuation of an assembled position in time and parameters, and its failure.

A branch may end where other assemblies continue; a fixed coordinate may be out of reach where
others are not; or there may be no assembly at all. A search from random starts distinguishes these
cases.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AssemblyError
from dalembert.model.graph.assembly.failure import failure
from dalembert.model.graph.assembly.position_search import PositionSearch, SearchResult
from dalembert.model.graph.assembly.recipe import Pinned
from dalembert.model.graph.description import Description
from dalembert.symbolic.equations import newton

FOLLOWED = newton.NewtonSettings(
    tolerance=1e-14, max_iterations=25, slack=1e3, halvings=0, growth=4.0
)
SHORTEST = 1e-3
"""Lower limit of a step, in natural units of time."""


def continued(
    pinned: Pinned, y: np.ndarray, p0: np.ndarray, p1: np.ndarray, time: float
) -> tuple[np.ndarray, float]:
    """Continue a position to other parameters by Newton's method, in smaller steps if necessary.

    Parameters
    ----------
    pinned : the square system
    y : its solution for the parameters p0 at the time 0
    p0, p1 : (np,) initial and final parameters
    time : final time

    Returns
    -------
    ndarray, float
        Position, and the share of the path at which it was found, or not found if less than 1.
    """
    reached, step = 0.0, 1.0
    shortest = SHORTEST / (1.0 + abs(time) / pinned.assembler.scales.time)
    while reached < 1.0:
        target = min(1.0, reached + step)
        p = p0 + target * (p1 - p0)
        solution = newton.solve(pinned.at(target * time, p), y, FOLLOWED)
        if solution.accepted:
            reached, y, step = target, solution.x, 2 * step
            continue
        step /= 2
        if step < shortest:
            return solution.x, min(target, np.nextafter(1.0, 0.0))
    return y, 1.0


@dataclass(frozen=True, eq=False)
class BranchEnd:
    """End of the continuation of the nominal assembly.

    Attributes
    ----------
    t, p : instant [s] and (np,) parameter values of the first position without convergence
    y : (n_y,) final position of Newton's method
    """

    t: float
    p: np.ndarray
    y: np.ndarray


def lost_branch(
    pinned: Pinned,
    d: Description,
    anchor: tuple[np.ndarray, np.ndarray],
    end: BranchEnd,
    t: float,
    p: np.ndarray,
) -> AssemblyError:
    """The error for parameter values at an instant that continuation does not reach.

    Parameters
    ----------
    pinned, d : square system of the start, and the mechanism
    anchor : nominal parameters and the assembled position for them
    end : BranchEnd
    t, p : the target instant [s] and parameter values
    """
    assembler, (p0, y0) = pinned.assembler, anchor
    search = PositionSearch(assembler, d, t, p)
    open_by = assembler.residual(end.t, end.y, end.p).value
    residual = float(np.abs(open_by).max(initial=0.0))
    reached, target = _values_text(d, end.p, p0, end.t), _values_text(d, p, p0, t)
    with_fixed = search.with_fixed(y0, pinned)
    if len(with_fixed.positions):
        return branch_end(reached, target, residual, with_fixed)
    anywhere, fixed = search.near(y0), pinned.recipe.positions.indices
    if not len(anywhere.positions):
        return failure(assembler, d, t, end.y, p, anywhere)
    if not fixed:
        return branch_end(reached, target, residual, anywhere)
    names = ", ".join(assembler.guesses.speed_names[k] for k in fixed)
    return unreachable_guess(names, target, residual, with_fixed.starts)


def _values_text(d: Description, p: np.ndarray, p0: np.ndarray, t: float) -> str:
    """Values of the parameters that differ from p0, and the time."""
    pairs = [
        f"{name} = {value:.6g} {parameter.unit}".rstrip()
        for (name, parameter), value, old in zip(d.parameters.items(), p, p0, strict=False)
        if value != old
    ]
    if t or not pairs:
        pairs.append(f"t = {t:.6g} s")
    return ", ".join(pairs)


def branch_end(reached: str, target: str, residual: float, searched: SearchResult) -> AssemblyError:
    """The error for a branch that ends before the target, where other assemblies exist.

    Parameters
    ----------
    reached, target : parameters and time at the end of the branch, and at its target
    residual : of the first position without convergence
    searched : SearchResult, with assembled positions at the target
    """
    count, single = len(searched.positions), len(searched.positions) == 1
    return AssemblyError(
        f"the branch of the nominal assembly ends at {reached}, before {target}: a dead centre; "
        f"{count} other {'assembly exists' if single else 'assemblies exist'} there "
        f"({searched.starts} random starts); list them by solve_assembly(model, parameters, "
        "all=True), and build the model with these values and with guesses near one of them",
        residual,
        others=count,
    )


def unreachable_guess(fixed: str, target: str, residual: float, starts: int) -> AssemblyError:
    """The error for a mechanism that can be assembled, but not with its fixed coordinates."""
    return AssemblyError(
        f"the mechanism closes at {target}, but not with {fixed} as given ({starts} random "
        "starts); build the model with these values, so that assembly moves the guess, or give "
        "another one",
        residual,
    )
