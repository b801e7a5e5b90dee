"""Assembly as an analysis: assembled positions, corrections of guesses, all configurations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, overload

import numpy as np

from dalembert.analysis.requirements import need_mechanism
from dalembert.errors import AnalysisError, AssemblyError
from dalembert.model.graph.assembly.assemblies import Assemblies, Completeness
from dalembert.model.graph.assembly.guesses import AssembledState
from dalembert.model.graph.model import Model
from dalembert.options import is_number, is_whole, random_generator
from dalembert.text.arguments import check_arguments


@dataclass(frozen=True, eq=False)
class Assembly:
    """Assembled state at one time.

    Attributes
    ----------
    y, v : (n,) coordinates and speeds
    residual : largest remaining violation
    corrections : coordinate → correction of its guess
    velocity_corrections : speed → correction of its inconsistent initial value
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
        coordinates = {
            name.rpartition(".")[2]: float(value)
            for name, value, owner in zip(
                self.model.guesses.names, self.y, self.model.guesses.pose_owners, strict=True
            )
            if owner == body
        }
        if not coordinates:
            raise KeyError(f"no body {body!r}; known: {', '.join(self.model.diagnosis.bodies)}")
        return coordinates

    def to_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        names = self.model.guesses.names
        poses = {name: float(value) for name, value in zip(names, self.y, strict=True)}
        return {"coordinates": poses, "residual": self.residual}


@dataclass(frozen=True, eq=False)
class AllAssemblies(Sequence[Assembly]):
    """Assembly configurations of a mechanism at one time, with an estimate of completeness.

    A sequence of ``Assembly``: the configuration on the branch of the initial guesses, then the
    others by their distance from it.

    Attributes
    ----------
    assemblies : tuple of Assembly
    completeness : Completeness, hits of random starts per configuration, estimated missing share
    note : remark where the branch of the initial guesses ends; empty otherwise

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

    assemblies: tuple[Assembly, ...]
    completeness: Completeness
    note: str = ""

    def __len__(self) -> int:
        return len(self.assemblies)

    @overload
    def __getitem__(self, index: int) -> Assembly: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Assembly, ...]: ...

    def __getitem__(self, index: int | slice) -> Assembly | tuple[Assembly, ...]:
        return self.assemblies[index]

    def __str__(self) -> str:
        count = len(self.assemblies)
        head = f"{count} {'assembly' if count == 1 else 'assemblies'}: {self.completeness}"
        return f"{head}; {self.note}" if self.note else head

    __repr__ = __str__

    def to_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        return {
            "count": len(self.assemblies),
            "completeness": self.completeness.to_dict(),
            "note": self.note,
            "assemblies": [assembly.to_dict() for assembly in self.assemblies],
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


@check_arguments
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

    Free coordinates keep their guesses. With ``all`` the other assembly configurations are searched
    for by Newton's method from random positions; the configuration on the branch of the initial
    guesses comes first. Residuals are below 1e-10 of their natural sizes. Numerical search cannot
    prove completeness; ``completeness`` states how often each configuration was reached and
    estimates the missing share (A. Chao 1984).

    Parameters
    ----------
    model : Model
    parameters : new values of parameters, without rebuilding
    time : [s]
    all : search for all assemblies; returns ``AllAssemblies``, a sequence of ``Assembly``
    count : number of assemblies after which the search stops
    rng : random generator of the starts, or its seed

    Raises
    ------
    AssemblyError
        The mechanism cannot be assembled; names the worst joint and its residual.
    AnalysisError
        ``time`` is not finite, or ``count`` is not a positive whole number.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("ladder")
    >>> ladder = system.add(planar.Bar("ladder", length=5.0, angle=-0.9))
    >>> wall = system.add(planar.PinInSlot("wall", system.ground.center, ladder.start, axis=(0, 1)))
    >>> floor = system.add(planar.PinInSlot("floor", system.ground.center, ladder.end))
    >>> foot = system.add(planar.CoordinateDriver("foot", ladder.end, 3.0))
    >>> assemblies = da.solve_assembly(system.build(), all=True, count=2, rng=1)
    >>> sorted(round(float(a.y[1]), 6) for a in assemblies)  # midpoint below or above the floor
    [-2.0, 2.0]
    """
    need_mechanism(model, "solve_assembly", "it needs no assembly; use solve_statics")
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


def _assembly(model: Model, time: float, state: AssembledState) -> Assembly:
    return Assembly(
        model, time, state.y, state.v, state.residual, state.corrections, state.velocity_corrections
    )
