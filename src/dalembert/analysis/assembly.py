"""Assembly as an analysis: where the mechanism stands and how far its guesses were moved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, overload

import numpy as np

from dalembert.analysis.served import need_mechanism
from dalembert.model.assembly.assembled_state import AssembledState
from dalembert.model.assembly.assemblies import Assemblies
from dalembert.model.model import Model
from dalembert.text.spelling import spelled


@dataclass(frozen=True, eq=False)
class Assembly:
    """Assembled state at one time.

    Attributes
    ----------
    y, v : (n,) coordinates and speeds
    residual : largest violation left
    corrections : coordinate → change made to a given guess
    velocity_corrections : speed → change made to inconsistent initial speeds
    """

    model: Model
    time: float
    y: np.ndarray
    v: np.ndarray
    residual: float
    corrections: dict[str, float]
    velocity_corrections: dict[str, float]

    def pose(self, body: str) -> dict[str, float]:
        """Coordinates of one body by name: x, y, angle."""
        found = {
            name.rpartition(".")[2]: float(value)
            for name, value, owner in zip(
                self.model.guesses.names, self.y, self.model.guesses.pose_owners, strict=True
            )
            if owner == body
        }
        if not found:
            raise KeyError(f"no body {body!r}; known: {', '.join(self.model.diagnosis.bodies)}")
        return found


@overload
def solve_assembly(
    model: Model,
    parameters: Mapping[str, float] | None = None,
    time: float = 0.0,
    *,
    all: Literal[False] = False,
) -> Assembly: ...


@overload
def solve_assembly(
    model: Model,
    parameters: Mapping[str, float] | None = None,
    time: float = 0.0,
    *,
    all: Literal[True],
    count: int | None = None,
    rng: np.random.Generator | int | None = None,
) -> list[Assembly]: ...


@spelled
def solve_assembly(
    model: Model,
    parameters: Mapping[str, float] | None = None,
    time: float = 0.0,
    *,
    all: bool = False,
    count: int | None = None,
    rng: np.random.Generator | int | None = None,
) -> Assembly | list[Assembly]:
    """Consistent positions and speeds at one time, ``Φ(y, t) = 0`` and ``C v = −Φ_t``.

    What the joints and drivers leave free stays where it was given. With ``all`` every other way
    in which the mechanism closes is looked for, too, from random starts: the assembly on the branch
    of the given poses comes first. Each leaves residuals below 1e-10 of their natural sizes.
    That none is missing cannot be proved by numbers; the search ends when many starts in a row
    lead to nothing new.

    Parameters
    ----------
    model : Model
    parameters : new values of parameters, without rebuilding
    time : [s]
    all : find all assemblies
    count : stop at so many
    rng : of the random starts, or its seed

    Raises
    ------
    AssemblyError
        It cannot be assembled; names the worst joint and its residual.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("ladder")
    >>> ladder = system.add(planar.Bar("ladder", length=5.0, angle=-0.9))
    >>> wall = system.add(planar.PinInSlot("wall", system.ground.center, ladder.start, axis=(0, 1)))
    >>> floor = system.add(planar.PinInSlot("floor", system.ground.center, ladder.end))
    >>> foot = system.add(planar.CoordinateDriver("foot", ladder.end, 3.0))
    >>> found = da.solve_assembly(system.build(), all=True, count=2, rng=1)
    >>> sorted(round(float(one.y[1]), 6) for one in found)  # its middle, 2 above the floor or below
    [-2.0, 2.0]
    """
    need_mechanism(model, "solve_assembly", "it needs no assembly, take solve_statics")
    p = model.values(parameters)
    first = model.assemble(p, time)
    if not all:
        return _assembly(model, time, first)
    found = Assemblies(model.closure, time, p)
    found.search(first.y, count, np.random.default_rng(0 if rng is None else rng))
    others = (model.closure.state(y, p, time) for y in found.known[1:])
    return [_assembly(model, time, state) for state in (first, *others)]


def _assembly(model: Model, time: float, s: AssembledState) -> Assembly:
    return Assembly(model, time, s.y, s.v, s.residual, s.corrections, s.velocity_corrections)
