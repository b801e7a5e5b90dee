"""Imported URDF files beside Pinocchio."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import dalembert as da
from benchmarks.imports.ours import Ours, State, free_body


class PinocchioPeer:
    """A URDF file in both programs.

    Parameters
    ----------
    path : Path
    base : ``"fixed"`` or ``"free"``
    """

    name = "Pinocchio"

    def __init__(self, path: Path, base: str):
        import pinocchio as pin

        self.ours = Ours(da.import_model(path, base=base))
        if base == "free" and not self.ours.free:
            raise ValueError("its root link is the world, and cannot be free")
        free = [pin.JointModelFreeFlyer()] if base == "free" else []
        self.model: Any = pin.buildModelFromUrdf(str(path), *free)
        self.data = self.model.createData()

    def states(self, count: int) -> Iterator[tuple[State, list[np.ndarray]]]:
        """Random states with ``M``, ``h``, ``C`` and ``ξ``."""
        import pinocchio as pin

        m, rng = self.model, np.random.default_rng(1)
        pin.seed(1)
        for _ in range(count):
            position = pin.randomConfiguration(m, np.full(m.nq, -3.0), np.full(m.nq, 3.0))
            speed = rng.normal(size=m.nv)
            mass = pin.crba(m, self.data, position)
            mass = np.triu(mass) + np.triu(mass, 1).T
            bias = pin.nonLinearEffects(m, self.data, position, speed)
            state = self._state(position, speed)
            bias += state.map.T @ self._damping(state)
            yield state, [mass, bias, *self._couplings()]

    def _damping(self, state: State) -> np.ndarray:
        """Viscous friction, which Pinocchio leaves to its caller."""
        damping = np.zeros(len(state.v))
        for table in self.ours.imported.document.get("forces", {}).values():
            if table["type"] == "JointFriction":
                row = self.ours.speeds.index(self.ours.coordinate(table["joint"]))
                damping[row] = table["viscous"] * state.v[row]
        return damping

    def _couplings(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the joints that mimic others."""
        rows = []
        for table in self.ours.imported.document.get("joints", {}).values():
            if table["type"] == "Coupling":
                row = np.zeros(self.model.nv)
                row[self._column(table["joint_j"])] = 1.0
                row[self._column(table["joint_i"])] = -table["ratio"]
                rows.append(row)
        return np.reshape(rows, (len(rows), self.model.nv)), np.zeros(len(rows))

    def _joints(self) -> list[tuple[int, str]]:
        """Numbers of the joints and their names in the model file."""
        names = dict(self.ours.imported.names)
        return [(k, names.get(n, n)) for k, n in enumerate(self.model.names) if k]

    def _column(self, name: str) -> int:
        k = next(k for k, own in self._joints() if own == name)
        return int(self.model.joints[k].idx_v)

    def _state(self, position: np.ndarray, speed: np.ndarray) -> State:
        import pinocchio as pin

        ours = self.ours
        q, t = np.zeros(len(ours.names)), np.zeros((len(ours.speeds), self.model.nv))
        drift = np.zeros(len(ours.speeds))
        for k, name in self._joints():
            joint = self.model.joints[k]
            a, column = joint.idx_q, joint.idx_v
            if joint.nq == 7:
                body = ours.free[0]
                x, y, z, w = position[a + 3 : a + 7]
                axes = pin.Quaternion(w, x, y, z).matrix()
                at, row = ours.names.index(f"{body}.x"), ours.speeds.index(f"{body}.x")
                place, center = position[a : a + 3], ours.offset(body)
                v, spin = speed[column : column + 3], speed[column + 3 : column + 6]
                entry = (at, row, column, place, axes, [w, x, y, z], center, v, spin, True)
                free_body(q, t, drift, entry)
                continue
            coordinate = ours.coordinate(name)
            value = position[a]
            if joint.nq == 2:
                value = np.arctan2(position[a + 1], position[a])
            q[ours.names.index(coordinate)] = value
            t[ours.speeds.index(coordinate), column] = 1.0
        return State(q, t @ speed, t, drift)
