"""Spatial user-defined unilateral constraint, with friction along a surface."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from dalembert.elements.base import Vector, quantity
from dalembert.elements.contact import unilateral
from dalembert.symbolic.formulas.expression import as_sx


@dataclass(eq=False)
class UnilateralConstraint(unilateral.UnilateralConstraint):
    """A formula of poses, ``t`` and parameters that must not become negative.

    The slip is one formula of speeds, or two along perpendicular tangents of the surface; then
    friction is in the plane of both, ``T = −μ N slip/|slip|``, and the contact sticks as long as
    ``|T| ≤ μ N``.

    Parameters
    ----------
    slip : one or two formulas of speeds along the surface, linear in them
    distance, restitution, tangential_restitution, friction, poisson : as in the plane

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("puck", gravity=(0, 0, -10))
    >>> puck = system.add(spatial.Particle("puck", mass=1.0, velocity=(3, 4, 0)))
    >>> floor = system.add(spatial.UnilateralConstraint("floor", puck.z,
    ...     slip=(puck.vx, puck.vy), restitution=0.0, friction=0.5))
    >>> motion = da.solve_dynamics(system.build(), 0.5, step=0.05)
    >>> motion["puck.velocity"][-1].values.round(6)  # reduced by μ g t along the path
    array([1.5, 2. , 0. ])
    """

    slip: Vector = quantity(
        "m/s", "formulas of speeds along the surface", default=None, size=2, minimum_size=1
    )

    def quantities(self) -> Iterator[tuple[str, Mapping]]:
        """Quantities; the slip may be a single formula."""
        for field, meta in super().quantities():
            alone = field == "slip" and self.slip is not None and as_sx(self.slip).numel() == 1
            yield field, {**meta, "size": 1} if alone else meta
