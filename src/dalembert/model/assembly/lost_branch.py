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
    """Where following the nominal assembly failed.

    Attributes
    ----------
    t, p : instant [s] and (np,) parameter values of the first position that was not found
    y : (n_y,) where its search ended
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
    """The error that says why parameter values at an instant are not reached.

    Parameters
    ----------
    pinned, d : square system of the start, and the mechanism
    anchor : nominal parameters and the position assembled for them
    end : BranchEnd
    t, p : the wanted instant [s] and parameter values
    """
    assembler, (p0, y0) = pinned.assembler, anchor
    search = PositionSearch(assembler, d, t, p)
    open_by = assembler.closeness(end.t, end.y, end.p).value
    residual = float(np.abs(open_by).max(initial=0.0))
    reached, wanted = _described(d, end.p, p0, end.t), _described(d, p, p0, t)
    held = search.held(y0, pinned)
    if len(held.positions):
        return branch_end(reached, wanted, residual, held)
    anywhere, places = search.near(y0), pinned.recipe.positions.indices
    if not len(anywhere.positions):
        return failure(assembler, d, t, end.y, p, anywhere)
    if not places:
        return branch_end(reached, wanted, residual, anywhere)
    names = ", ".join(assembler.guesses.speed_names[k] for k in places)
    return unreachable_guess(names, wanted, residual, held.starts)


def _described(d: Description, p: np.ndarray, p0: np.ndarray, t: float) -> str:
    """Values of the parameters that differ from others, and the time."""
    pairs = [
        f"{name} = {value:.6g} {parameter.unit}".rstrip()
        for (name, parameter), value, old in zip(d.parameters.items(), p, p0, strict=False)
        if value != old
    ]
    if t or not pairs:
        pairs.append(f"t = {t:.6g} s")
    return ", ".join(pairs)


def branch_end(reached: str, wanted: str, residual: float, searched: Searched) -> AssemblyError:
    """The error of a branch that ends before the wanted values, where other assemblies exist.

    Parameters
    ----------
    reached, wanted : parameters and time where the branch ends, and where it should lead
    residual : of the first position that was not found
    searched : Searched, with assembled positions at the wanted values
    """
    count, one = len(searched.positions), len(searched.positions) == 1
    return AssemblyError(
        f"the branch of the nominal assembly ends at {reached}, before {wanted}: a dead centre; "
        f"{count} other {'assembly exists' if one else 'assemblies exist'} there "
        f"({searched.starts} random starts); list them by solve_assembly(model, parameters, "
        "all=True), and build the model with these values and with guesses near one of them",
        residual,
        others=count,
    )


def unreachable_guess(held: str, wanted: str, residual: float, starts: int) -> AssemblyError:
    """The error of given coordinates at which the mechanism closes nowhere, though elsewhere."""
    return AssemblyError(
        f"the mechanism closes at {wanted}, but not with {held} as given ({starts} random starts); "
        "build the model with these values, so that assembly moves the guess, or give another one",
        residual,
    )
