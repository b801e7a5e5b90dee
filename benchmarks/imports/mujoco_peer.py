"""Imported MJCF files beside MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import dalembert as da
from benchmarks.imports.mesh_axes import enter_tensors
from benchmarks.imports.ours import Ours, State, free_body

ZERO = (
    *("tendon_stiffness", "tendon_damping", "tendon_armature"),
    *("dof_frictionloss", "tendon_frictionloss"),
)
"""Fields of MuJoCo's model that the import lists as not converted, or that are soft constraints."""
SPRINGS = "joint springdamper"
"""Omission of springs, with which all springs and dampers are switched off in both programs."""


class MujocoPeer:
    """An MJCF file in both programs; contacts, fluids and tendons are switched off.

    Parameters
    ----------
    path : Path
    root : folder inside which its meshes are
    own_tensors : whether MuJoCo computes with the inertia tensors of dalembert
    """

    name = "MuJoCo"

    def __init__(self, path: Path, root: Path, own_tensors: bool = False):
        import mujoco

        imported = da.import_model(path, root=root)
        try:
            self.model: Any = mujoco.MjModel.from_xml_path(str(path))
        except ValueError as error:
            raise ValueError(f"MuJoCo refuses the file: {error}") from None
        self.data: Any = mujoco.MjData(self.model)
        self.actuators = len(imported.document.get("inputs", {})) == self.model.nu
        self.model.opt.density = self.model.opt.viscosity = 0.0
        omitted = {omission.content for omission in imported.omissions}
        fields = [*ZERO, *("jnt_stiffness", "dof_damping")] if SPRINGS in omitted else ZERO
        for field in fields:
            getattr(self.model, field)[:] = 0.0
        if SPRINGS in omitted:
            forces = imported.document.get("forces", {})
            for name in [n for n in forces if n.endswith(("_spring", "_friction"))]:
                del forces[name]
        if own_tensors:
            enter_tensors(self.model, path, root)
        self.ours = Ours(imported, self.actuators)
        if self.model.njnt > len(self.ours.joints) + len(self.ours.free):
            raise ValueError("MuJoCo has more joints, of attached models")
        bits = mujoco.mjtDisableBit
        self.model.opt.disableflags |= bits.mjDSBL_CONSTRAINT

    def states(self, count: int) -> Iterator[tuple[State, list[Any]]]:
        """Random states with ``M``, ``h``, ``C`` and ``ξ``."""
        import mujoco

        m, d, rng = self.model, self.data, np.random.default_rng(1)
        for _ in range(count):
            d.qpos[:], d.qvel[:] = rng.uniform(-2, 2, m.nq), rng.normal(size=m.nv)
            for j in range(m.njnt):
                if m.jnt_type[j] < 2:
                    a = m.jnt_qposadr[j] + (3 if m.jnt_type[j] == 0 else 0)
                    d.qpos[a : a + 4] /= np.linalg.norm(d.qpos[a : a + 4])
            if self.actuators:
                d.ctrl[:] = self.ours.controls
            mujoco.mj_forward(m, d)
            mass = np.zeros((m.nv, m.nv))
            mujoco.mj_fullM(m, d, mass)
            bias = d.qfrc_bias - d.qfrc_spring - d.qfrc_damper - d.qfrc_gravcomp
            bias -= d.qfrc_actuator if self.actuators else 0.0
            yield self._state(), [mass, bias, *self._constraints()]

    def _state(self) -> State:
        import mujoco

        ours, m, d = self.ours, self.model, self.data
        q, t = np.zeros(len(ours.names)), np.zeros((len(ours.speeds), m.nv))
        drift = np.zeros(len(ours.speeds))
        joints, free = iter(ours.joints), iter(ours.free)
        for j in range(m.njnt):
            a, column = m.jnt_qposadr[j], m.jnt_dofadr[j]
            if m.jnt_type[j] == 0:
                body = next(free)
                if f"{body}.x" not in ours.names:
                    raise ValueError("a free body is welded, and has no coordinates of its own")
                axes = np.zeros(9)
                mujoco.mju_quat2Mat(axes, d.qpos[a + 3 : a + 7])
                at, row = ours.names.index(f"{body}.x"), ours.speeds.index(f"{body}.x")
                place, quaternion = d.qpos[a : a + 3], d.qpos[a + 3 : a + 7]
                v, spin = d.qvel[column : column + 3], d.qvel[column + 3 : column + 6]
                center, axes = ours.offset(body), axes.reshape(3, 3)
                entry = (at, row, column, place, axes, quaternion, center, v, spin, False)
                free_body(q, t, drift, entry)
            elif m.jnt_type[j] == 1:
                at, row = self._ball(next(joints), j, q)
                t[row : row + 3, column : column + 3] = np.eye(3)
            else:
                coordinate = ours.coordinate(next(joints))
                q[ours.names.index(coordinate)] = d.qpos[a] - m.qpos0[a]
                t[ours.speeds.index(coordinate), column] = 1.0
        return State(q, t @ d.qvel, t, drift)

    def _ball(self, name: str, j: int, q: np.ndarray) -> tuple[int, int]:
        """Enter the orientation behind a ball joint relative to that before it; places in q, v."""
        start = self.model.jnt_qposadr[j]
        at, row = (
            next(k for k, entry in enumerate(listed) if entry.startswith(f"{name}."))
            for listed in (self.ours.names, self.ours.speeds)
        )
        q[at : at + 4] = self.data.qpos[start : start + 4]
        return at, row

    def _constraints(self) -> tuple[np.ndarray | None, np.ndarray | None]:
        """``C`` and ``ξ`` of the equality constraints, exact instead of soft; None of welds."""
        import mujoco

        m, d = self.model, self.data
        rows, sides = [np.zeros((0, m.nv))], [np.zeros(0)]
        for k in range(m.neq):
            first, second, numbers = m.eq_obj1id[k], m.eq_obj2id[k], m.eq_data[k]
            if not m.eq_active0[k]:
                continue
            if m.eq_type[k] == mujoco.mjtEq.mjEQ_CONNECT:
                ends = [self._point(first, numbers[:3]), self._point(second, numbers[3:6])]
                rows.append(ends[1][0] - ends[0][0])
                sides.append(-(ends[1][1] - ends[0][1]) @ d.qvel)
            elif m.eq_type[k] == mujoco.mjtEq.mjEQ_JOINT:
                row, side = np.zeros((1, m.nv)), 0.0
                row[0, m.jnt_dofadr[first]] = 1.0
                if second >= 0:
                    polynomial = np.polynomial.Polynomial(numbers[:5])
                    x = d.qpos[m.jnt_qposadr[second]] - m.qpos0[m.jnt_qposadr[second]]
                    column = m.jnt_dofadr[second]
                    row[0, column] = -polynomial.deriv()(x)
                    side = polynomial.deriv(2)(x) * d.qvel[column] ** 2
                rows.append(row)
                sides.append(np.array([side]))
            elif m.eq_type[k] == mujoco.mjtEq.mjEQ_WELD:
                return None, None  # rotations agree at closed positions only
        return np.vstack(rows), np.concatenate(sides)

    def _point(self, body: int, local: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Jacobian of a point of a body, and its rate."""
        import mujoco

        m, d = self.model, self.data
        place = d.xpos[body] + d.xmat[body].reshape(3, 3) @ local
        jacobian, rate = np.zeros((3, m.nv)), np.zeros((3, m.nv))
        mujoco.mj_jac(m, d, jacobian, None, place, body)
        mujoco.mj_jacDot(m, d, rate, None, place, body)
        return jacobian, rate
