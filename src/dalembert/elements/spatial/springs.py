"""Spatial torsion springs and bushings."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import ForceElement, Look, Rate, Vector, quantity
from dalembert.elements.look import Brake, Sleeve, Spiral
from dalembert.elements.spatial.frame_pair import BetweenFrames
from dalembert.elements.springs import AngularSpring, ElasticBearing
from dalembert.symbolic import rotation


@dataclass(eq=False)
class FramePair(BetweenFrames, ForceElement):
    """Force element between two frames."""


@dataclass(eq=False)
class TorsionSpring(AngularSpring, FramePair):
    """Torsion spring and damper about the z axis of the first frame.

    Its coordinate is the angle of the second x axis about the first z axis, in (−π, π] from the
    first x axis, or from the initial poses unless both x axes were specified. For a spring in a
    joint use the frames of the joint.

    Parameters
    ----------
    frame_i, frame_j : frames of the first and the second body
    stiffness : [N m/rad]
    damping : [N m s/rad]
    free_angle : angle without moment [rad]
    law : function (extension, rate) → additional moment [N m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("torsion pendulum")
    >>> wheel = system.add(spatial.Body("wheel", mass=1.0, inertia=(0.2, 0.2, 0.25)))
    >>> ends = system.ground.frame(), wheel.frame()
    >>> hinge = system.add(spatial.Revolute("O", *ends))
    >>> wire = system.add(spatial.TorsionSpring("wire", *ends, stiffness=4.0))
    >>> modes = da.linearize(system.build())
    >>> modes.eigenvalues.imag.round(6)  # √(k/J)
    array([4.])
    """

    def coordinate(self) -> ca.SX:
        return self.turn.angle

    def look(self) -> list[Look]:
        return self.primitives(Spiral, Brake, *self.ends())


@dataclass(eq=False)
class Bushing(ElasticBearing, FramePair):
    """Elastic bearing: stiffness and damping along and about the axes of the first frame.

    The second origin is displaced by ``d = R_iᵀ (r_j − r_i)``, the second frame rotated by
    ``θ = 2 sin(φ/2) n``, φ about n, in the axes of the first: the rotation vector ``φ n`` to 1 %
    up to φ = 0.5 rad. ``½ Σ k s²`` is stored and ``Σ c ṡ²`` dissipated, exactly for any rotation,
    so that the moment of a rotation about one axis is ``k sin φ``. The measures ``force`` and
    ``moment`` are ``k s + c ṡ``.

    Parameters
    ----------
    frame_i, frame_j : frames of the first and the second body
    stiffness : (3,) along the axes of frame i [N/m]
    damping : (3,) [N s/m]
    rotational_stiffness, rotational_damping : (3,) about them [N m/rad], [N m s/rad]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("mount", gravity=(0, 0, -10))
    >>> engine = system.add(spatial.Body("engine", mass=80.0, inertia=(2, 3, 3)))
    >>> soft = dict(stiffness=(1e6, 1e6, 2e5), rotational_stiffness=(1e3, 1e3, 1e3))
    >>> mount = system.add(spatial.Bushing("mount", system.ground.frame(), engine.frame(), **soft))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["engine.z"].item() * 1e3, 6)  # -m g/k [mm]
    -4.0
    """

    stiffness: Vector = quantity("N/m", "stiffness along the axes of frame i", size=3)
    damping: Vector = quantity("N s/m", "damping", default=(0.0,) * 3, size=3)
    rotational_stiffness: Vector = quantity(
        "N m/rad", "stiffness about the axes of frame i", default=(0.0,) * 3, size=3
    )
    rotational_damping: Vector = quantity(
        "N m s/rad", "damping about them", default=(0.0,) * 3, size=3
    )

    @property
    def _relative(self) -> ca.SX:
        """(4,) Euler parameters of the second frame in the first."""
        i, j = (frame.orientation for frame in (self.frame_i, self.frame_j))
        return rotation.product(rotation.conjugate(i), j)

    def deformation(self) -> ca.SX:
        return ca.vertcat(self.travel, 2 * self._relative[1:])

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        measures, sign = super().measures(rate), ca.if_else(self._relative[0] < 0, -1, 1)
        return measures | {
            name: (sign * measures[name][0], measures[name][1]) for name in ("turn", "moment")
        }

    def look(self) -> list[Look]:
        return [Sleeve(self.frame_i, self.frame_j)]
