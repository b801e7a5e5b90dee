"""Assembly as an analysis: assembled positions, corrections of guesses, all configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, overload

import numpy as np

from dalembert.analysis.served import need_mechanism
from dalembert.errors import AnalysisError, AssemblyError
from dalembert.model.assembly.assemblies import Assemblies, Completeness
from dalembert.model.assembly.guesses import AssembledState
from dalembert.model.model import Model
from dalembert.options import is_number, is_whole, random_generator
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

    def to_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        names = self.model.guesses.names
        poses = {name: float(value) for name, value in zip(names, self.y, strict=True)}
        return {"coordinates": poses, "residual": self.residual}


@dataclass(frozen=True, eq=False)
class AllAssemblies(Sequence[Assembly]):
    """Assembly configurations of a mechanism at one time, with what may be missing.

    A sequence of ``Assembly``: the one on the branch of the given poses, then the nearest to it.

    Attributes
    ----------
    found : tuple of Assembly
    completeness : Completeness, how often random starts reached each, and what may be missing
    note : remark on the branch of the given poses, where it ends; empty otherwise

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("crank and rod")
    >>> crank = system.add(planar.Bar("crank", length=1.0, angle=0.5))
    >>> rod = system.add(planar.Bar("rod", length=2.0))
    >>> pin = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> joint = system.add(planar.Revolute("A", crank.end, rod.start))
    >>> slider = system.add(planar.PinInSlot("B", system.ground.center, rod.end))
    >>> assemblies = da.solve_assembly(system.build(), all=True)
    >>> len(assemblies), assemblies.completeness.missing
    (2, 0.0)
    """

    found: tuple[Assembly, ...]
    completeness: Completeness
    note: str = ""

    def __len__(self) -> int:
        return len(self.found)

    @overload
    def __getitem__(self, index: int) -> Assembly: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Assembly, ...]: ...

    def __getitem__(self, index: int | slice) -> Assembly | tuple[Assembly, ...]:
        return self.found[index]

    def __str__(self) -> str:
        count = len(self.found)
        head = f"{count} {'assembly' if count == 1 else 'assemblies'}: {self.completeness}"
        return f"{head}; {self.note}" if self.note else head

    __repr__ = __str__

    def to_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "count": len(self.found),
            "completeness": self.completeness.to_dict(),
            "note": self.note,
            "assemblies": [one.to_dict() for one in self.found],
        }


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
) -> AllAssemblies: ...


@spelled
def solve_assembly(
    model: Model,
    parameters: Mapping[str, float] | None = None,
    time: float = 0.0,
    *,
    all: bool = False,
    count: int | None = None,
    rng: np.random.Generator | int | None = None,
) -> Assembly | AllAssemblies:
    """Consistent positions and speeds at one time, ``Φ(y, t) = 0`` and ``C v = −Φ_t``.

    What the joints and drivers leave free stays where it was given. With ``all`` every other
    assembly configuration is searched for, too, by Newton's method from random positions. The one
    on the branch of the given poses comes first. Each leaves residuals below 1e-10 of their
    natural sizes. Numbers cannot prove that none is missing; ``completeness`` states how often
    each was reached and estimates what may be missing (A. Chao 1984).

    Parameters
    ----------
    model : Model
    parameters : new values of parameters, without rebuilding
    time : [s]
    all : find all assemblies; returns ``AllAssemblies``, a sequence of ``Assembly``
    count : stop at so many
    rng : of the random starts, or its seed

    Raises
    ------
    AssemblyError
        It cannot be assembled; names the worst joint and its residual.
    AnalysisError
        ``time`` is no finite number, ``count`` no whole number of 1 or more.

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
    _check_options(time, count)
    p = model.values(parameters)
    if not all:
        return _assembly(model, time, model.assemble(p, time))
    first, note = None, ""
    try:
        first = model.assemble(p, time)
    except AssemblyError as error:
        if not error.others:
            raise
        note = f"none is on the branch of the nominal assembly: {str(error).partition(';')[0]}"
    search = Assemblies(model.closure, time, p)
    seed = random_generator(0 if rng is None else rng)
    completeness = search.search(None if first is None else first.y, count, seed)
    states = [model.closure.state(y, p, time) for y in search.positions]
    if first is not None:
        states[0] = first
    return AllAssemblies(
        tuple(_assembly(model, time, state) for state in states), completeness, note
    )


def _check_options(time: Any, count: Any) -> None:
    if not is_number(time):
        raise AnalysisError(f"time = {time!r:.60}: give a finite number of seconds")
    if count is not None and (not is_whole(count) or count < 1):
        raise AnalysisError(f"count = {count!r:.60}: give a whole number of 1 or more, or None")


def _assembly(model: Model, time: float, s: AssembledState) -> Assembly:
    return Assembly(model, time, s.y, s.v, s.residual, s.corrections, s.velocity_corrections)
