"""Choices of coordinates by name, and the automatic choice by estimated cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from dalembert.errors import DalembertError, UnsupportedError
from dalembert.model.graph.coordinates import AbsoluteCoordinates, Coordinates, CoordinateView
from dalembert.model.graph.model import Model
from dalembert.model.graph.tree.joint_coordinates import JointCoordinates

CANDIDATES: tuple[Coordinates, ...] = (AbsoluteCoordinates(), JointCoordinates())


@dataclass(frozen=True)
class AutomaticCoordinates(Coordinates):
    """Absolute or joint coordinates, whichever need fewer operations for accelerations and
    corrections: joint coordinates for open chains, absolute ones for long loops. Coordinates that
    do not support the model are left out.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("chain", gravity=(0, -10))
    >>> last = system.ground.center
    >>> for k in range(4):
    ...     link = system.add(planar.Bar(f"link{k}", length=1.0, mass=1.0, position=(k + 0.5, 0)))
    ...     hinge = system.add(planar.Revolute(f"O{k}", last, link.start))
    ...     last = link.end
    >>> choose = da.AutomaticCoordinates()
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.01, coordinates=choose)
    >>> motion.statistics["coordinates"]
    'JointCoordinates'
    """

    def chosen(self, cost: Callable[[Coordinates], int]) -> Coordinates:
        costs: dict[Coordinates, int] = {}
        for candidate in CANDIDATES:
            try:
                costs[candidate] = cost(candidate)
            except DalembertError:  # if none supports it, a run in the first one raises the error
                continue
        return min(costs, key=costs.__getitem__, default=CANDIDATES[0])

    def check(self, model: Model, every_equation: bool) -> None:
        """Accepts every model: absolute coordinates are the fallback."""

    def view(self, model: Model, every_equation: bool = False) -> CoordinateView:
        raise UnsupportedError(
            "AutomaticCoordinates() are chosen for runs of solve_dynamics; give "
            "AbsoluteCoordinates() or JointCoordinates() here"
        )


COORDINATES: dict[str, type] = {
    "AbsoluteCoordinates": AbsoluteCoordinates,
    "JointCoordinates": JointCoordinates,
    "AutomaticCoordinates": AutomaticCoordinates,
}
