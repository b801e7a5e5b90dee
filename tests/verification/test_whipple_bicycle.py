"""Whipple's bicycle: eigenvalues of lean and steer about straight running, at several speeds.

Source: J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, *Linearized dynamics equations
for the balance and steer of a bicycle*, Proceedings of the Royal Society A 463, 2007: the bicycle
of table 1, its matrices ``M q̈ + v C1 q̇ + (g K0 + v² K2) q = 0`` and table 2. Here four bodies,
three hinges and two wheels that roll without slip are linearised. Tolerance 1e-6; x points forward
and z down.
"""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import null_space

import dalembert as da
from dalembert import spatial

G, TILT, BASE, TRAIL, REAR, FRONT = 9.81, np.pi / 10, 1.02, 0.08, 0.3, 0.35
STEERING = np.array([np.sin(TILT), 0, np.cos(TILT)])
EIGENVALUES = {  # castering, capsize, weave, its conjugate
    0.0: (-5.53094371765393, -3.13164324790656, 3.13164324790656, 5.53094371765393),
    1.0: (-7.11008014637442, -3.13423125066578, 3.52696170990070 + 0.80774027519930j),
    2.0: (-8.67387984831735, -3.07158645641514, 2.68234517512745 + 1.68066296590675j),
    3.0: (-10.35101467245920, -2.63366137253667, 1.70675605663975 + 2.31582447384325j),
    4.0: (-12.15861426576447, -1.42944427361326, 0.41325331521125 + 3.07910818603206j),
}
M = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
C1 = np.array([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
K0 = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
K2 = np.array([[0, 76.59734589573222], [0, 2.65431523794604]])


def bicycle(speed: float) -> da.System:
    """Upright and straight, the rear contact below the origin; the frame carries the joints."""
    system = da.System("bicycle", gravity=(0.0, 0.0, G))

    def body(name, mass, inertia, place, spin=0.0):
        body = spatial.Body(
            name,
            mass=mass,
            inertia=inertia,
            position=place,
            rotation=da.rotation.identity(),
            velocity=(speed, 0, 0),
            angular_velocity=(0, spin, 0),
        )
        return system.add(body)

    frame = body("frame", 85.0, [[9.2, 0, 2.4], [0, 11, 0], [2.4, 0, 2.8]], (0.3, 0, -0.9))
    rear_wheel = body("rear_wheel", 2.0, (0.0603, 0.12, 0.0603), (0, 0, -REAR), -speed / REAR)
    fork_inertia = [[0.05892, 0, -0.00756], [0, 0.06, 0], [-0.00756, 0, 0.00708]]
    fork = body("fork", 4.0, fork_inertia, (0.9, 0, -0.7))
    front_wheel = body(
        "front_wheel", 3.0, (0.1405, 0.28, 0.1405), (BASE, 0, -FRONT), -speed / FRONT
    )
    at = {"frame": np.array([0.3, 0, -0.9]), "fork": np.array([0.9, 0, -0.7])}

    def hinge(name, place, first, second, axis):
        x = np.cross((0, 1, 0), axis) if axis[1] == 0 else np.array([1, 0, 0])
        ends = [
            one.frame(tuple(place - at.get(one.name, place)), axis=tuple(axis), x=tuple(x))
            for one in (first, second)
        ]
        system.add(spatial.Revolute(name, *ends))

    lateral = np.array([0, 1, 0])
    hinge("rear_axle", np.array([0, 0, -REAR]), frame, rear_wheel, lateral)
    hinge("steering", np.array([BASE + TRAIL, 0, 0]) - 0.9 * STEERING, frame, fork, STEERING)
    hinge("front_axle", np.array([BASE, 0, -FRONT]), fork, front_wheel, lateral)
    road = system.ground.frame(axis=(0, 0, -1))
    system.add(spatial.RollingDisc("rear_tyre", rear_wheel, road, radius=REAR))
    system.add(spatial.RollingDisc("front_tyre", front_wheel, road, radius=FRONT))
    return system


def linearised(system: da.System) -> np.ndarray:
    """(5, 5) rates of lean, steer, their rates and the forward speed by themselves.

    All other coordinates are cyclic: ``u̇ = g(y, v)`` is a function of ``u(y, v)`` on the
    constraints, whichever directions one takes the derivatives in.
    """
    model = system.build()
    assert model.diagnosis.degrees_of_freedom == 3
    e, named = model.equations, system.elements
    frame, fork = named["frame"], named["fork"]
    lean = ca.asin(frame.axes[2, 1])
    steer = ca.dot(fork.axes[:, 0], frame.axes[:, 1]) / np.cos(TILT)
    rates = [e.rate(angle) for angle in (lean, steer)]
    u = ca.vertcat(lean, steer, *rates, ca.dot(frame.axes[:, 0], frame.twist[:3]))
    moving, going = ca.vertcat(e.y, e.v), ca.vertcat(e.pose_rate, e.a)
    rate = ca.jtimes(u, moving, going)
    motion = ca.vertcat(
        ca.mtimes(e.mass, e.a) + e.bias + ca.mtimes(e.jacobian.T, e.multiplier) - e.force,
        ca.mtimes(e.jacobian, e.a) - e.constraint_acceleration,
    )
    holds = ca.vertcat(e.constraints[list(e.holds)], e.velocity_constraints)
    unknown = ca.vertcat(e.a, e.multiplier)

    def along(expression):
        return ca.horzcat(e.by_displacement(expression), ca.jacobian(expression, e.v))

    now = ca.Function(
        "now",
        [e.t, e.y, e.v, e.p, unknown],
        [motion, ca.jacobian(motion, unknown), along(motion), along(holds), along(u), along(rate),
         ca.jacobian(rate, unknown), rate],
    )  # fmt: skip
    state = model.assemble(model.values(None), 0.0)
    still = np.zeros(unknown.numel())
    expected = (0.0, state.y, state.v, model.values(None))
    off, inertia, *_ = (part.full() for part in now(*expected, still))
    forces = np.linalg.solve(inertia, -off.ravel())
    _, inertia, motion_by, holds_by, u_by, rate_by, by_forces, steady = (
        part.full() for part in now(*expected, forces)
    )
    np.testing.assert_allclose(steady, 0.0, atol=1e-10)
    ways = null_space(holds_by)
    total = (rate_by - by_forces @ np.linalg.solve(inertia, motion_by)) @ ways
    return total @ np.linalg.pinv(u_by @ ways)


@pytest.mark.few(3)
@pytest.mark.parametrize("speed", EIGENVALUES)
def test_eigenvalues(speed):
    matrix = linearised(bicycle(speed))
    expected = np.zeros((4, 4))
    expected[:2, 2:] = np.eye(2)
    expected[2:, :2] = -np.linalg.solve(M, G * K0 + speed**2 * K2)
    expected[2:, 2:] = -np.linalg.solve(M, speed * C1)
    np.testing.assert_allclose(matrix[:4, :4], expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(matrix[4], 0.0, atol=1e-9)
    printed = {z for root in EIGENVALUES[speed] for z in (complex(root), np.conj(root))}
    eigenvalues = np.linalg.eigvals(matrix[:4, :4])
    np.testing.assert_allclose(
        np.sort_complex(eigenvalues), np.sort_complex(list(printed)), atol=1e-6
    )


@pytest.mark.few(1)
@pytest.mark.parametrize("speed", EIGENVALUES)
def test_eigenvalues_in_joint_coordinates(speed):
    """``linearize`` about the steady run; those of cyclic motions are zero."""
    modes = da.linearize(
        bicycle(speed).build(), equilibrium=False, coordinates=da.JointCoordinates()
    )
    computed = modes.eigenvalues[abs(modes.eigenvalues) > 1e-4]
    printed = [z for z in map(complex, EIGENVALUES[speed]) if z.imag >= 0]
    np.testing.assert_allclose(np.sort_complex(computed), np.sort_complex(printed), atol=1e-6)
