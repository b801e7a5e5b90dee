"""Friction in joints."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.along_joint import AlongJoint
from dalembert.elements.base import Constraint, Powers, Rate, Scalar, option, quantity


@dataclass(eq=False)
class JointFriction(AlongJoint):
    """Friction in the motion a joint leaves free: smoothed Coulomb plus viscous.

    ``Q = −(coulomb · tanh(ṡ/transition) + viscous · ṡ)`` along the free coordinate ``s``.

    Parameters
    ----------
    joint : joint that leaves a motion free
    coulomb : sliding friction force [N] or moment [N m]; may be a formula of positions and speeds
    viscous : [N s/m] or [N m s/rad]
    transition : speed at which 76 % of the Coulomb value is reached [m/s] or [rad/s]
    motion : which free motion, where the joint has several (``displacement`` or ``angle``)

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sledge")
    >>> sledge = system.add(planar.Body("sledge", mass=2.0, inertia=0.1, velocity=(3, 0)))
    >>> rail = system.add(planar.Translational("rail", system.ground.center, sledge.center))
    >>> rub = system.add(planar.JointFriction("rub", rail, viscous=4.0))
    >>> motion = da.solve_dynamics(system.build(), 5.0, step=0.01)
    >>> round(motion["sledge.x"][-1].item(), 3)  # m v/c (1 - exp(-10))
    1.5
    """

    joint: Constraint
    coulomb: Scalar = quantity("N | N m", "sliding friction", default=0.0, minimum=0.0)
    viscous: Scalar = quantity("N s/m | N m s/rad", "viscous friction", default=0.0, minimum=0.0)
    transition: Scalar = quantity("m/s | rad/s", "smoothing speed", default=1e-3, above=0.0)
    motion: str = option("which free motion, where there are several", default=None)

    unseen = "it acts in a joint, which is seen"

    def effort(self, speed: ca.SX) -> ca.SX:
        sliding = self.coulomb.sx * ca.tanh(speed / self.transition.sx)
        return -(sliding + self.viscous.sx * speed)

    def dissipation(self, rate: Rate) -> Powers:
        return self.powers(rate)
