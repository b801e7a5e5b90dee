"""Why the nominal assembly does not lead to other parameter values or another time.

Its branch may end where other assemblies go on; a given coordinate may be out of reach where others
are not; or there is no assembly at all. A search from random starts tells these apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AssemblyError
from dalembert.model.assembly.failure import failure
from dalembert.model.assembly.position_search import PositionSearch, Searched
from dalembert.model.assembly.recipe import Pinned
from dalembert.model.description import Description


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
    open_by = assembler.closeness(end.t, end.y, end.p).value
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


def branch_end(reached: str, target: str, residual: float, searched: Searched) -> AssemblyError:
    """The error for a branch that ends before the target, where other assemblies exist.

    Parameters
    ----------
    reached, target : parameters and time at the end of the branch, and at its target
    residual : of the first position without convergence
    searched : Searched, with assembled positions at the target
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
