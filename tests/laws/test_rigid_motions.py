"""Rigid motions of structures: no strain, the inertia of a rigid body, and its free flight.

Whatever the kind of element, a structure that turns as a rigid body has the kinetic energy of one,
and its inertia forces balance where the body moves by Euler's equations.
"""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from cell_meshes import places_of
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import structures
from dalembert.analysis.transient.equation import EquationOfMotion, Motions
from dalembert.elements.fem.attached import GroundSpring
from dalembert.elements.fem.cells import CELLS
from dalembert.elements.fem.nodal import spin_map
from dalembert.elements.fem.registry import ELEMENTS, cell_of
from dalembert.model.assembled.load_case import CHANGES

NUMBERS = {
    "area": 0.02,
    "second_moment": 4e-4,
    "second_moment_y": 4e-4,
    "second_moment_z": 7e-4,
    "torsion_constant": 9e-4,
    "modulus": 1e7,
    "shear_modulus": 4e6,
    "stiffness": 1e6,
    "density": 3.0,
    "inertia_x": 0.3,
    "inertia_y": 0.5,
    "inertia_z": 0.4,
}
KINDS = [
    (name, d)
    for name, cls in ELEMENTS.items()
    for d in cls.dimensions
    if not issubclass(cls, GroundSpring)  # what is tied to the ground does not fly
]
SPIN = np.array([1.1, -0.7, 1.6])


@functools.cache
def body(name: str, d: int, flying: bool = False, heat: float = 0.0) -> da.Structure:
    """One element with masses at its nodes, at rest or thrown and spinning, cold or heated."""
    cls, fields = ELEMENTS[name], NUMBERS | dict.fromkeys(CHANGES, heat)  # what is heated bends
    s = da.Structure(f"{name} in {d}-D")
    points = places_of(CELLS[cell_of(cls)])[:, :d]
    nodes = s.add_nodes("n", points)
    numbers = {
        f.name: fields.get(f.name, 0.3) for f in cls.quantity_fields() if f.metadata["size"] == 1
    }
    s.add_elements("e", cls, nodes, [range(len(points))], **numbers)
    rest = np.random.default_rng(3).uniform(0.5, 1.5, len(points))
    s.add_elements("m", structures.PointMass, nodes, np.arange(len(points))[:, None], mass=rest)
    if flying:
        speed = np.array([0.4, -0.3, 0.2])[:d] + turned(points, d)
        rates = dict(zip(("vx", "vy", "vz"), speed.T, strict=False))
        if cls.turns:
            names = ("vrx", "vry", "vrz")[3 - spins(d) :]
            rates |= dict(zip(names, SPIN[3 - spins(d) :], strict=True))
        s.initial(nodes, **rates)
    return s


def spins(d: int) -> int:
    return {1: 0, 2: 1, 3: 3}[d]


def turned(points: np.ndarray, d: int) -> np.ndarray:
    """(nodes, d) velocities of a spin about the origin."""
    whole = np.zeros((len(points), 3))
    whole[:, :d] = points
    spin = {1: np.zeros(3), 2: SPIN * [0, 0, 1], 3: SPIN}[d]
    return np.cross(spin, whole)[:, :d]


def heatable(name: str) -> bool:
    return not {f.name for f in ELEMENTS[name].quantity_fields()}.isdisjoint(CHANGES)


class RigidBody:
    """Mass, centre and inertia of a structure, and its rigid motions in space."""

    def __init__(self, model, mass: np.ndarray):
        self.table, self.d = model.degrees.table, model.degrees.dimension
        self.turning = self.table.shape[1] > self.d and bool((self.table[:, self.d] >= 0).any())
        self.places = np.zeros((len(self.table), 3))
        self.places[:, : self.d] = model.structure.nodes["n"].positions
        modes = np.stack([self._flat(*unit) for unit in self._units()], axis=1)
        six = modes.T @ mass @ modes
        self.mass = six[0, 0]
        self.centre = np.zeros(3)
        if self.d > 1:
            self.centre[:2] = six[1, 5] / self.mass, -six[0, 5] / self.mass
        if self.d > 2:
            self.centre[2] = six[0, 4] / self.mass
        c = self.centre
        self.inertia = six[3:, 3:] - self.mass * (c @ c * np.eye(3) - np.outer(c, c))

    def _units(self):
        """Unit velocities along and about the axes: of places and of spins."""
        for axis in np.eye(3):
            yield np.tile(axis, (len(self.places), 1)), np.zeros(3)
        for axis in np.eye(3):
            yield np.cross(axis, self.places), axis

    def _flat(self, moved: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """(n,) translations (nodes, 3) and rotations (3,) or (nodes, 3) as displacements."""
        computed = np.zeros(self.table.max() + 1)
        computed[self.table[:, : self.d]] = moved[:, : self.d]
        if self.turning:
            computed[self.table[:, self.d :]] = turned[..., 3 - spins(self.d) :]
        return computed

    def motion(self, rotation, spin, twist, speed) -> Motions:
        """Displacements, velocities and accelerations of a body that turns about its centre."""
        arms = rotation.apply(self.places - self.centre)
        r, rate, second = rates_of(rotation, spin, twist)
        return Motions(
            self._flat(arms + self.centre - self.places, r),
            self._flat(speed + np.cross(spin, arms), rate),
            self._flat(np.cross(twist, arms) + np.cross(spin, np.cross(spin, arms)), second),
        )

    def turned_from(self, motion, attitude: Rotation) -> float:
        """Largest angle between a node at the end and an attitude."""
        vectors = np.zeros((len(self.table), 3))
        if not self.turning:
            return 0.0
        vectors[:, 3 - spins(self.d) :] = motion.displacements[self.table[:, self.d :], -1]
        return float((attitude.inv() * Rotation.from_rotvec(vectors)).magnitude().max())

    def resultant(self, motion: Motions, forces: np.ndarray) -> np.ndarray:
        """(6,) force and moment about the centre in its displaced place."""
        moved = np.zeros_like(self.places)
        moved[:, : self.d] = motion.u[self.table[:, : self.d]]
        arms = self.places + moved - self.centre
        applied = np.zeros_like(self.places)
        applied[:, : self.d] = forces[self.table[:, : self.d]]
        moment = np.cross(arms, applied).sum(axis=0)
        if self.turning and self.d == 3:
            for row in self.table[:, 3:]:
                moment += np.linalg.solve(spinning(motion.u[row]).T, forces[row])
        elif self.turning:
            moment[2] += forces[self.table[:, 2]].sum()
        return np.concatenate([applied.sum(axis=0), moment])


def spinning(r: np.ndarray) -> np.ndarray:
    return np.array(ca.evalf(spin_map(ca.SX(ca.DM(r)))))


def rates_of(rotation, spin, twist):
    """Rotation vector with its two derivatives, from spin and its derivative."""
    r, small = rotation.as_rotvec(), 1e-5
    rate = np.linalg.solve(spinning(r), spin)
    slope = (spinning(r + small * rate) - spinning(r - small * rate)) / (2 * small)
    return r, rate, np.linalg.solve(spinning(r), twist - slope @ rate)


def axes_of(d: int) -> np.ndarray:
    """Projection on the axes about which a body of this dimension turns."""
    return np.diag({1: [0, 0, 0], 2: [0, 0, 1], 3: [1, 1, 1]}[d]).astype(float)


@pytest.mark.few(9)
@pytest.mark.parametrize("lumped", [False, True])
@pytest.mark.parametrize(("name", "d"), KINDS)
def test_a_rigid_motion_has_the_inertia_of_a_rigid_body(name, d, lumped):
    model = body(name, d).build()
    e = EquationOfMotion(model, model.nominal, "", da.Rayleigh(), lumped)
    rigid, axes = RigidBody(model, e.mass.toarray()), axes_of(d)
    rotation = Rotation.from_rotvec(axes @ [1.3, 0.9, -1.7])
    spin, speed = axes @ SPIN, np.array([0.4, -0.3, 0.2]) * (np.arange(3) < d)
    inertia = rotation.as_matrix() @ rigid.inertia @ rotation.as_matrix().T
    twist = np.linalg.pinv(axes @ inertia @ axes) @ (axes @ -np.cross(spin, inertia @ spin))
    motion = rigid.motion(rotation, spin, twist, speed)
    strained = np.abs(e.internal_forces(motion.u)).max()
    assert strained <= 1e-12 * np.abs(e.stiffness).max()
    energy = rigid.mass * speed @ speed / 2 + spin @ inertia @ spin / 2
    parts = [
        b.kind.kinetic_energy(b.gather(motion.u), b.gather(motion.v), b.data(e.p), lumped)[0]
        for b in e.assembly.blocks
    ]
    assert sum(part.sum() for part in parts) == pytest.approx(energy, rel=1e-12)
    left = e.forces(motion) - e.internal_forces(motion.u)
    left = rigid.resultant(motion, left)[np.r_[:d, 3 + np.flatnonzero(np.diag(axes))]]
    np.testing.assert_allclose(left, 0.0, atol=1e-8 * energy)  # differences in rates_of


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "d"), KINDS)
def test_free_flight_is_that_of_a_rigid_body(name, d):
    """No support, no load, nothing but what was thrown: place and attitude to order two."""
    model, errors, end = body(name, d, flying=True).build(), [], 0.8
    for step in (0.04, 0.02):
        integrator = da.GeneralizedAlpha(rho_inf=0.7)
        motion = da.solve_transient(model, end, step=step, nonlinear=True, integrator=integrator)
        assert motion.status.success, motion.status
        assert motion.status.residual < 1e-9
        e = motion.record.march.equation
        rigid, axes = RigidBody(model, e.mass.toarray()), axes_of(d)
        attitude = flight(rigid, axes, end)
        spin = axes @ SPIN
        speed = np.array([0.4, -0.3, 0.2]) * (np.arange(3) < d) + np.cross(spin, rigid.centre)
        arms = attitude.apply(rigid.places - rigid.centre)
        expected = (rigid.centre + speed * end + arms - rigid.places)[:, :d]
        computed = motion.displacements[rigid.table[:, :d], -1]
        errors.append(max(np.abs(computed - expected).max(), rigid.turned_from(motion, attitude)))
        momenta = []
        for k in (0, -1):
            x = (motion.displacements, motion.velocities, motion.accelerations)
            now = Motions(*(part[:, k] for part in x))
            momenta.append(rigid.resultant(now, e.momentum(now.u, now.v)))
        changed, scale = np.abs(momenta[1] - momenta[0]), np.abs(momenta[0]).max()
        assert changed[:3].max() <= (step**2 if e.turns else 1e-11) * scale
        assert changed[3:].max() <= step**2 * scale
    assert errors[1] < 1e-11 or (errors[1] < 2e-3 and errors[0] / errors[1] > 3.4)


@pytest.mark.parametrize(("name", "d"), [k for k in KINDS if heatable(k[0])])
def test_heat_neither_moves_nor_turns_a_body(name, d):
    """Wherever a body is and however it is strained, forces of its heat are in balance."""
    model = body(name, d, heat=0.3).build()
    mass = model.assembly.mass(model.nominal).toarray()
    rigid, axes, still = RigidBody(model, mass), axes_of(d), np.zeros(3)
    u = rigid.motion(Rotation.from_rotvec(axes @ [1.3, 0.9, -1.7]), still, still, still).u
    u = u + np.random.default_rng(5).uniform(-0.05, 0.05, u.size)
    forces = model.loads[""].configuration.assembly.internal_forces(u, model.nominal)
    assert np.abs(forces).max() > 1.0
    left = rigid.resultant(Motions(u, 0 * u, 0 * u), forces)
    np.testing.assert_allclose(left, 0.0, atol=1e-12 * np.abs(forces).max())


def flight(rigid: RigidBody, axes: np.ndarray, end: float) -> Rotation:
    """Attitude of a free rigid body by Euler's equations."""
    inverse = np.linalg.pinv(axes @ rigid.inertia @ axes)

    def rate(_, y):
        (x, y_, z, w), spin = y[:4], y[4:]
        quaternion = np.array([[w, -z, y_], [z, w, -x], [-y_, x, w], [-x, -y_, -z]]) @ spin / 2
        return np.concatenate([quaternion, -inverse @ np.cross(spin, rigid.inertia @ spin)])

    start = np.concatenate([[0, 0, 0, 1], axes @ SPIN])
    reference = solve_ivp(rate, (0.0, end), start, method="DOP853", rtol=1e-11, atol=1e-12)
    return Rotation.from_quat(reference.y[:4, -1])


@pytest.mark.thorough
def test_half_a_turn_and_many_turns_of_a_pinned_bar():
    """One frame element turns by its own momentum: its angle is ``ω t``."""
    s = da.Structure("bar")
    a, b = s.node("a", 0.0, 0.0), s.node("b", 1.0, 0.0)
    numbers = {"area": 0.01, "second_moment": 1e-5, "modulus": 1e8, "density": 1.0}
    s.add(structures.Frame("ab", a, b, **numbers))
    s.support(a, ux=0.0, uy=0.0)
    s.initial(a, vrz=np.pi)
    s.initial(b, vrz=np.pi, vy=np.pi)
    options = {"nonlinear": True, "integrator": da.GeneralizedAlpha(rho_inf=0.8)}
    motion = da.solve_transient(s.build(), 2.5, step=0.01, **options)
    assert motion.status.success
    np.testing.assert_allclose(motion.values("a.rz"), np.pi * motion.time, rtol=4e-4)
