"""Constraints are physical: z = Φ are displacements, so that λ are forces and moments (4.22).

A unit displacement of a body in the prohibited direction changes the open-constraint coordinate by
one metre, a unit turn by one radian. By virtual work a multiplier of one is then a force of 1 N,
or a moment of 1 N m without a force.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from registry import CASES, CONSTRAINED, model_of
from twins import length

import dalembert as da
from dalembert import planar, spatial
from dalembert.elements.base import Constraint
from dalembert.elements.coordinates import rate_of
from dalembert.elements.pair import Pair
from dalembert.elements.planar import GearPair, UserConstraint

COUPLED = {spatial.GearPair, spatial.RackAndPinion, spatial.Coupling}
OWN = {UserConstraint, spatial.ConstantVelocity, *COUPLED}
"""Multipliers that are what a formula makes of them, the torque of a shaft at an angle, or tied to
motions of two joints."""
OBLIQUE = {"link of two hinges askew"}
LIBRARY = [n for n in CONSTRAINED if not OWN & set(CASES[n].covers)]


def slopes(model: da.Model, joint: Constraint) -> np.ndarray:
    """∂ż/∂v of the second body, (rows, 3) or in space (rows, 6)."""
    e = model.equations
    body = joint.ends()[1] if isinstance(joint, Pair) else joint.point.body
    rate = rate_of(joint.equations, [body], da.t.sx)
    slope = ca.jacobian(model.at_ground(rate), body.twist)
    table = ca.Function("slope", [e.t, e.y, e.p], [ca.densify(slope)])
    computed = table(0.0, model.start.y, model.nominal).full()
    full = 6 if body.dimension == 3 else 3  # a particle does not turn
    return np.pad(computed, ((0, 0), (0, full - computed.shape[1])))


def gear_measure(model: da.Model, gear: GearPair) -> float:
    """Distance of the centres over the sum of the radii: one for gears whose teeth meet."""
    e = model.equations
    terms = model.at_ground(ca.norm_2(gear.between) / ca.fabs(gear.centres))
    return float(ca.Function("d", [e.y, e.p], [terms])(model.start.y, model.nominal))


@pytest.mark.parametrize("name", LIBRARY)
def test_multipliers_are_forces_and_moments(name):
    """Rows in metres: orthogonal unit forces. Rows in radians: unit moments without a force."""
    model = model_of(name)
    for joint in model.constraints:
        slope, n = slopes(model, joint), CASES[name].dimension
        force, moment = slope[:, :n], slope[:, n:]
        if isinstance(joint, GearPair):  # the pitch circles need not touch in this case
            force = force * gear_measure(model, joint)
        metres = np.array([unit == "m" for unit in joint.units()])
        gram = force[metres] @ force[metres].T
        if name not in OBLIQUE:
            np.testing.assert_allclose(gram, np.eye(metres.sum()), atol=1e-13)
        np.testing.assert_allclose(np.diag(gram), 1, atol=1e-13)
        np.testing.assert_allclose(force[~metres], 0, atol=1e-13)
        np.testing.assert_allclose(np.linalg.norm(moment[~metres], axis=1), 1, atol=1e-13)


@pytest.mark.parametrize("internal", [False, True])
def test_tooth_force_acts_at_the_pitch_point(internal):
    """λ of meshing gears: λ times the pitch radius about each centre, along the common tangent."""
    ri, rj = 0.2, 0.5
    distance = rj - ri if internal else ri + rj
    direction = np.array([0.6, 0.8])
    system = da.System("gears")
    a = system.add(planar.Body("a", mass=1, inertia=1, position=(0.1, 0.2), angle=0.3))
    place = np.array([0.1, 0.2]) + distance * direction
    b = system.add(planar.Body("b", mass=1, inertia=1, position=tuple(place), angle=-0.4))
    gear = system.add(
        planar.GearPair("gear", a.center, b.center, radius_i=ri, radius_j=rj, internal=internal)
    )
    model = system.build()
    (slope,) = slopes(model, gear)  # the pose of b is that of its centre
    force, moment = slope[:2], slope[2]
    pitch = np.array([0.1, 0.2]) + (-ri if internal else ri) * direction
    arm = pitch - place
    assert length(force) == pytest.approx(1, rel=1e-13)
    assert force @ direction == pytest.approx(0, abs=1e-13)
    assert abs(moment) == pytest.approx(rj, rel=1e-13)
    assert arm[0] * force[1] - arm[1] * force[0] == pytest.approx(moment, rel=1e-13)


def test_squared_distance_is_not_physical():
    """x² + y² − l² (Example 4.4): a unit of its multiplier is a force of 2l newtons."""
    system = da.System("pendulum")
    bob = system.add(planar.Particle("bob", mass=1, position=(0.3, -0.4)))
    system.add(planar.UserConstraint("thread", bob.x**2 + bob.y**2 - 0.25))
    model = system.build()
    e = model.equations
    size = ca.Function("size", [e.y], [ca.norm_2(e.jacobian.T)])(model.start.y)
    assert float(size) == pytest.approx(2 * 0.5, rel=1e-12)
