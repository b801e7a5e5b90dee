"""Equations of motion of an imported model in joint coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

import dalembert as da

DETERMINED = 1e-6
"""Threshold of the share of a coordinate in motions without mass below which it has none."""
SINGULAR = 1e-12
"""Threshold of eigenvalues and singular values relative to the largest one."""


@dataclass(frozen=True, eq=False)
class State:
    """A state of a peer in the coordinates of dalembert.

    Attributes
    ----------
    q, v : coordinates and speeds of the peer's state
    map : ``T`` with ``v = T v_peer``
    drift : ``Ṫ v_peer``
    """

    q: np.ndarray
    v: np.ndarray
    map: np.ndarray
    drift: np.ndarray


def accelerations(
    mass: np.ndarray, bias: np.ndarray, jacobian: np.ndarray, xi: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """``v̇`` of ``M v̇ + h = −Cᵀ λ``, ``C v̇ = ξ``, in the null space of C, which may be redundant.

    Returns also which entries are determined: not all if M is singular in this space and no force
    acts on massless links. None if one does, or if nothing has a mass.
    """
    scale, diagonal = np.ones(len(bias)), np.diag(mass)
    scale[diagonal > 0] = 1 / np.sqrt(diagonal[diagonal > 0])
    scaled, side = mass * np.outer(scale, scale), -bias * scale
    particular, free = np.zeros(len(bias)), np.eye(len(bias))
    if len(xi):
        left, sizes, right = np.linalg.svd(jacobian * scale)
        rank = int((sizes > SINGULAR * sizes[0]).sum())
        particular = right[:rank].T @ (left[:, :rank].T @ xi / sizes[:rank])
        free = right[rank:].T
    reduced = free.T @ scaled @ free
    force = free.T @ (side - scaled @ particular)
    moments, axes = np.linalg.eigh(reduced)
    if not moments.max(initial=0.0) > SINGULAR:
        return None
    moving = axes[:, moments > SINGULAR * moments[-1]]
    if moving.shape[1] == len(reduced):
        solved = np.linalg.solve(reduced, force)
        return scale * (particular + free @ solved), np.full(len(bias), True)
    if (
        np.abs(force - moving @ (moving.T @ force)).max(initial=0.0)
        > SINGULAR * np.abs(force).max()
    ):
        return None
    solved = moving @ np.linalg.solve(moving.T @ reduced @ moving, moving.T @ force)
    idle = free @ axes[:, moments <= SINGULAR * moments[-1]]
    return scale * (particular + free @ solved), np.abs(idle).max(axis=1, initial=0.0) < DETERMINED


class Ours:
    """The model of an imported file, without dry friction, which the peers do not have.

    Parameters
    ----------
    imported : Imported
    actuators : whether its actuators act
    """

    def __init__(self, imported: da.Imported, actuators: bool = True):
        forces = imported.document.get("forces", {})
        inputs = imported.document.get("inputs", {})
        self.controls = [table["value"] for table in inputs.values()]
        if not actuators:
            for name in [n for n in forces if n.partition("_force")[0] in inputs]:
                del forces[name]
        for name, table in list(forces.items()):
            table.pop("coulomb", None)
            if table["type"] == "JointFriction" and "viscous" not in table:
                del forces[name]
        self.imported = imported
        self.model: Any = imported.build()
        view: Any = da.JointCoordinates().view(self.model, every_equation=True)
        e = view.equations
        self.names = list(view.names)
        self.speeds = [name for link in view.links for name in link.space.speed_names]
        self.joints = list(imported.document.get("joints", {}))
        carried = {
            imported.document["joints"][name]["connect"][1].partition(".")[0]
            for name in imported.names.values()
        }
        self.free = [body for body in imported.document["bodies"] if body not in carried]
        terms = [e.inertia.matrix, e.bias - e.force, e.jacobian, e.constraint_acceleration]
        self._function = ca.Function("terms", [e.t, e.y, e.v, e.p], terms)

    def terms(self, state: State) -> list[np.ndarray]:
        """``M``, ``h``, ``C`` and ``ξ``."""
        values = self._function(0.0, state.q, state.v, self.model.nominal)
        mass, bias, jacobian, xi = (value.full() for value in values)
        return [mass, bias.ravel(), jacobian, xi.ravel()]

    def coordinate(self, joint: str) -> str:
        """Name of the coordinate of a joint."""
        names = (f"{joint}.angle", f"{joint}.displacement")
        return next(name for name in names if name in self.names)

    def offset(self, body: str) -> np.ndarray:
        """Mass centre in the body frame."""
        owner = next(b for b in self.model.bodies if b.name == body)
        offset: np.ndarray = ca.DM(owner.offset).full().ravel()
        return offset

    @property
    def loops(self) -> int:
        """Number of closed loops and couplings."""
        return len(self.joints) - (len(self.model.bodies) - len(self.free))

    def difference(self, state: State, peer: list[Any]) -> np.ndarray:
        """Largest relative differences of mass matrix, bias and accelerations.

        NaN for accelerations that are not compared, or not determined because M is singular.
        """
        mass, bias, jacobian, xi = self.terms(state)
        t = state.map
        inertial = [(t.T @ mass @ t, peer[0]), (t.T @ (bias + mass @ state.drift), peer[1])]
        reference = None if peer[2] is None else accelerations(*peer)
        computed = accelerations(mass, bias, jacobian, xi)
        if reference is None or computed is None:
            return np.array([*map(_relative, inertial), np.nan])
        (reference, _), (computed, rows) = reference, computed
        expected = t @ reference + state.drift
        rows = rows & (np.abs(t).max(axis=1, initial=0.0) > 0)
        return np.array([*map(_relative, inertial), _relative((computed[rows], expected[rows]))])


def _relative(pair: tuple[np.ndarray, np.ndarray]) -> float:
    """Largest difference over the largest value."""
    ours, peer = pair
    return float(np.abs(ours - peer).max(initial=0.0) / max(np.abs(peer).max(initial=0.0), 1e-6))


def free_body(q: np.ndarray, t: np.ndarray, drift: np.ndarray, body: Any) -> None:
    """Enter a free body, whose peer's speeds are those of its origin.

    Parameters
    ----------
    body : index in q, in v and in the peer's speeds; position, axes, quaternion (scalar first),
        mass centre; velocity of the origin, angular velocity in body axes; whether the peer's
        velocity is in body axes
    """
    at, row, column, place, axes, quaternion, center, velocity, spin, is_local = body
    q[at : at + 3], q[at + 3 : at + 7] = place + axes @ center, quaternion
    x, y, z = center
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    t[row : row + 3, column : column + 3] = axes if is_local else np.eye(3)
    t[row : row + 3, column + 3 : column + 6] = -axes @ skew
    t[row + 3 : row + 6, column + 3 : column + 6] = np.eye(3)
    drift[row : row + 3] = axes @ np.cross(spin, np.cross(spin, center))
    if is_local:
        drift[row : row + 3] += axes @ np.cross(spin, velocity)
