"""Equalities of MJCF: exact accelerations from MuJoCo's mass matrix, forces and Jacobian.

MuJoCo's own constraints are soft. The exact accelerations of its coordinates solve
``M a + Jᵀ λ = f``, ``J a = −J̇ v``, where J̇ is a central difference along the motion.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da

mujoco = pytest.importorskip("mujoco")

STEP = 1e-5


def body(name: str, place: str, joints: str, mass: float, inner: str = "") -> str:
    moments = "0.02 0.03 0.04 0.001 -0.002 0.0015"
    inertia = f'<inertial pos="0.1 0.02 -0.03" mass="{mass}" fullinertia="{moments}"/>'
    return f'<body name="{name}" pos="{place}">{joints}{inertia}{inner}</body>'


def hinge(name: str, axis: str, more: str = "") -> str:
    return f'<joint name="{name}" axis="{axis}" {more}/>'


ARM = body("a", "0 0 1", hinge("ja", "0 1 0"), 1, body("b", ".4 0 0", hinge("jb", "0 1 .2"), 2))
BALL = body("c", ".3 0 .1", '<joint name="jc" type="ball"/>', 1.5, '<site name="s" pos=".1 .1 0"/>')
CHAIN = ARM.replace("</body></body>", f"{BALL}</body></body>")
FREE = body("f", ".2 .3 1", "<freejoint/>", 0.7, '<site name="s2" pos="-.1 0 .1" euler="9 20 3"/>')
SPRING = body("g", ".1 0 0", hinge("jg", "0 1 0", 'stiffness="3" damping=".4"'), 0.5)
EQUALITIES = {
    "connect to the world": (CHAIN, '<connect body1="c" anchor=".2 0 0"/>'),
    "connect of two bodies": (CHAIN + FREE, '<connect body1="f" body2="b" anchor=".2 0 0"/>'),
    "connect of sites": (CHAIN + FREE, '<connect site1="s" site2="s2"/>'),
    "weld": (ARM + FREE, '<weld body1="b" body2="f"/>'),
    "weld with a pose": (ARM + FREE, '<weld body1="a" body2="f" relpose=".2 .3 0 1 0 0 0"/>'),
    "body behind a weld": (ARM + FREE.replace("</body>", SPRING + "</body>"), '<weld body1="f"/>'),
    "two welds": (
        ARM + FREE + body("h", ".5 .3 1", "<freejoint/>", 0.4),
        '<weld body1="a" body2="f"/><weld body1="f" body2="h"/>',
    ),
    "polynomial": (ARM, '<joint joint1="ja" joint2="jb" polycoef="0 .5 .2 -.1 .03"/>'),
    "fixed joint": (ARM, '<joint joint1="jb"/>'),
}


class Exact:
    """Exact motion of a MuJoCo model at its reference position with consistent random speeds."""

    def __init__(self, text: str):
        self.m = mujoco.MjModel.from_xml_string(text)
        self.d = mujoco.MjData(self.m)
        mujoco.mj_forward(self.m, self.d)
        if "site" in text.partition("<equality>")[2]:
            self._close()
        jacobian, _ = self.constraints(0.0)
        speeds = np.random.default_rng(3).normal(size=self.m.nv)
        self.d.qvel[:] = speeds - np.linalg.lstsq(jacobian, jacobian @ speeds, rcond=None)[0]
        mujoco.mj_forward(self.m, self.d)

    def _close(self) -> None:
        """Newton's method for the position; at the reference position of others they hold."""
        for _ in range(30):
            jacobian, gap = self.constraints(0.0)
            mujoco.mj_integratePos(
                self.m, self.d.qpos, -np.linalg.lstsq(jacobian, gap, rcond=None)[0], 1.0
            )
        mujoco.mj_forward(self.m, self.d)

    def moved(self, step: float):
        """Data at a position further along the motion."""
        other = mujoco.MjData(self.m)
        other.qpos[:], other.qvel[:] = self.d.qpos, self.d.qvel
        mujoco.mj_integratePos(self.m, other.qpos, self.d.qvel, step)
        mujoco.mj_forward(self.m, other)
        return other

    def constraints(self, step: float) -> tuple[np.ndarray, np.ndarray]:
        """Jacobian and violations of the equalities."""
        d = self.moved(step)
        rows = d.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        return d.efc_J.reshape(d.nefc, -1)[rows].copy(), d.efc_pos[rows].copy()

    def accelerations(self) -> np.ndarray:
        mass = np.zeros((self.m.nv, self.m.nv))
        mujoco.mj_fullM(self.m, self.d, mass)
        jacobian, _ = self.constraints(0.0)
        rate = (self.constraints(STEP)[0] - self.constraints(-STEP)[0]) / (2 * STEP)
        force = self.d.qfrc_passive + self.d.qfrc_actuator - self.d.qfrc_bias
        n, size = len(jacobian), self.m.nv
        saddle = np.block([[mass, jacobian.T], [jacobian, np.zeros((n, n))]])
        rhs = np.concatenate([force, -rate @ self.d.qvel])
        return np.linalg.lstsq(saddle, rhs, rcond=1e-11)[0][:size]

    def body_jacobian(self, k: int, step: float = 0.0) -> np.ndarray:
        """(6, n) of the origin and the angular velocity of a body."""
        place, turn = np.zeros((3, self.m.nv)), np.zeros((3, self.m.nv))
        mujoco.mj_jacBody(self.m, self.moved(step), place, turn, k)
        return np.vstack([place, turn])

    def body_accelerations(self, k: int) -> np.ndarray:
        rate = (self.body_jacobian(k, STEP) - self.body_jacobian(k, -STEP)) / (2 * STEP)
        return self.body_jacobian(k) @ self.accelerations() + rate @ self.d.qvel


@pytest.mark.few(3)
@pytest.mark.parametrize("name", EQUALITIES)
def test_accelerations_are_exact(name, tmp_path):
    """Bodies in loops and behind them, in motion, to the accuracy of the differences."""
    bodies, equalities = EQUALITIES[name]
    text = (
        f'<mujoco model="m"><option jacobian="dense"/><worldbody>{bodies}</worldbody>'
        f"<equality>{equalities}</equality></mujoco>"
    )
    exact = Exact(text)
    position = " ".join(map(repr, exact.d.qpos.tolist()))
    key = f'<keyframe><key name="k" qpos="{position}"/></keyframe></mujoco>'
    source = tmp_path / "m.xml"
    source.write_text(text.replace("</mujoco>", key))
    content = da.import_model(source, keyframe="k").text
    names = [exact.m.body(k).name for k in range(1, exact.m.nbody)]
    for k, label in enumerate(names, start=1):
        speeds = exact.body_jacobian(k) @ exact.d.qvel
        lines = f"velocity = {speeds[:3].tolist()}\nangular_velocity = {speeds[3:].tolist()}"
        content = content.replace(f"[bodies.{label}]\n", f"[bodies.{label}]\n{lines}\n")
    file = tmp_path / "m.toml"
    file.write_text(content)
    motion = da.solve_dynamics(da.load_model(file).build(), 1e-4, step=1e-4)
    for k, label in enumerate(names, start=1):
        expected = [exact.body_jacobian(k) @ exact.d.qvel, exact.body_accelerations(k)]
        for letter, values in zip("va", expected, strict=True):
            actual = [motion[f"{label}.{letter}{axis}"][0] for axis in "xyz"]
            scale = 1.0 + np.abs(values[:3]).max()
            np.testing.assert_allclose(np.ravel(actual), values[:3], rtol=0, atol=1e-8 * scale)
