"""MJCF files: MuJoCo loads them, and its equations of motion are ours."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from registry import CASES, model_of
from robot_states import OurEquations, axes_of, null_space, positions, split

import dalembert as da
from dalembert import planar, spatial
from dalembert.io import load_model_file
from dalembert.io.exports.registry import FORMATS
from dalembert.io.exports.rigid.start import Start

mujoco = pytest.importorskip("mujoco")
EXACT = 1e-9
STATES = 20


def written(model: da.Model, **options):
    """Model of MuJoCo, and the omissions."""
    files = FORMATS["mjcf"].create(model, "m", options)
    return mujoco.MjModel.from_xml_string(files.files["m.xml"].decode()), files.omissions


class Twin:
    """MuJoCo's model in states of ours.

    Attributes
    ----------
    bodies : body of ours → bodies of MuJoCo, the original first, then its halves
    """

    def __init__(self, model: da.Model):
        self.model = model
        self.m, self.omissions = written(model)
        self.d = mujoco.MjData(self.m)
        mujoco.mj_resetDataKeyframe(self.m, self.d, 0)
        names = {self.m.body(k).name: k for k in range(1, self.m.nbody)}
        self.bodies = {
            b.name: [k for n, k in names.items() if n == b.name or n.startswith(f"{b.name}.")]
            for b in model.bodies
        }

    def jacobian(self, dot: bool = False) -> np.ndarray:
        """Jacobian of mass centres and of angular velocities in body axes, or its rate."""
        rows = []
        for body in self.model.bodies:
            for number in self.bodies[body.name]:
                p, r = np.zeros((3, self.m.nv)), np.zeros((3, self.m.nv))
                if dot:
                    place = self.d.xipos[number]
                    mujoco.mj_jacDot(self.m, self.d, p, r, place, number)
                else:
                    mujoco.mj_jacBodyCom(self.m, self.d, p, r, number)
                r = self.d.xmat[number].reshape(3, 3).T @ r
                rows.append(_own_rows(body, p, r))
        return np.vstack(rows)

    def error(self, parts) -> np.ndarray:
        """Displacements from the present poses to those of ours."""
        rows = []
        for body in self.model.bodies:
            y, axes = parts[body.name][0], axes_of(body, parts[body.name][0])
            for number in self.bodies[body.name]:
                place = np.zeros(3)
                place[: body.dimension] = y[: body.dimension]
                turn = self.d.xmat[number].reshape(3, 3).T @ axes
                spin = np.array([turn[2, 1], turn[0, 2], turn[1, 0]]) - np.array(
                    [turn[1, 2], turn[2, 0], turn[0, 1]]
                )
                rows.append(_own_rows(body, place - self.d.xipos[number], spin / 2))
        return np.concatenate(rows)

    def repeat(self, parts, which: int) -> np.ndarray:
        """Speeds or accelerations of ours, repeated for the halves of bodies."""
        return np.concatenate(
            [parts[b.name][which] for b in self.model.bodies for _ in self.bodies[b.name]]
        )

    def place(self, state) -> np.ndarray:
        """Move to a state of ours; returns the accelerations of MuJoCo's coordinates."""
        parts = split(self.model, state.y, state.v, state.a)
        self.d.qvel[:] = 0
        for _ in range(30):
            mujoco.mj_kinematics(self.m, self.d)
            mujoco.mj_comPos(self.m, self.d)
            gap = self.error(parts)
            if np.abs(gap).max() < 1e-14:
                break
            step = np.linalg.lstsq(self.jacobian(), gap, rcond=None)[0]
            mujoco.mj_integratePos(self.m, self.d.qpos, step, 1.0)
        assert np.abs(gap).max() < 1e-11
        mujoco.mj_forward(self.m, self.d)
        d = self.jacobian()
        speeds = self.repeat(parts, 1)
        self.d.qvel[:] = np.linalg.lstsq(d, speeds, rcond=None)[0]
        assert np.abs(d @ self.d.qvel - speeds).max() < EXACT * (1 + np.abs(speeds).max())
        mujoco.mj_forward(self.m, self.d)
        accelerations = self.repeat(parts, 2)
        drift = self.jacobian(dot=True) @ self.d.qvel
        qacc = np.linalg.lstsq(d, accelerations - drift, rcond=None)[0]
        gap = d @ qacc + drift - accelerations
        assert np.abs(gap).max() < 1e-8 * (1 + np.abs(accelerations).max())
        return qacc

    def mass(self) -> np.ndarray:
        full = np.zeros((self.m.nv, self.m.nv))
        mujoco.mj_fullM(self.m, self.d, full)
        return full

    def equalities(self) -> np.ndarray:
        """(rows, nv) Jacobian of the equalities."""
        if not self.d.ne:
            return np.zeros((0, self.m.nv))
        rows = np.zeros((self.d.nefc, self.m.nv))
        if mujoco.mj_isSparse(self.m):
            mujoco.mju_sparse2dense(
                rows,
                self.d.efc_J,
                self.d.efc_J_rownnz,
                self.d.efc_J_rowadr,
                self.d.efc_J_colind,
            )
        else:
            rows = self.d.efc_J.reshape(self.d.nefc, self.m.nv).copy()
        return rows[: self.d.ne]


def _own_rows(body, position: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """Rows that a body has as speeds."""
    if body.dimension == 2:
        return np.concatenate([position[:2], turning[2:]]) if body.rotates else position[:2]
    return np.concatenate([position, turning]) if body.rotates else position


def check_equations(model: da.Model, states: int = STATES) -> None:
    """Reduced mass matrix and equations of motion equal ours at random states."""
    twin, ours, rng = Twin(model), OurEquations(model), np.random.default_rng(3)
    assert not twin.omissions
    for y in positions(model, states):
        state = ours.at(y, rng)
        qacc = twin.place(state)
        j = twin.equalities()
        free = null_space(j)
        assert free.shape[1] == model.diagnosis.degrees_of_freedom
        scale = np.abs(j).max(initial=1.0) * (1 + np.abs(twin.d.qvel).max(initial=0.0))
        assert np.abs(j @ twin.d.qvel).max(initial=0.0) < EXACT * scale
        d = _first_copies(twin) @ free
        mass = twin.mass()
        reduced, expected = free.T @ mass @ free, d.T @ state.mass @ d
        assert np.abs(reduced - expected).max(initial=0.0) <= EXACT * np.abs(mass).max(initial=0.0)
        forces = twin.d.qfrc_passive + twin.d.qfrc_actuator - twin.d.qfrc_bias
        balance = free.T @ (mass @ qacc - forces)
        size = np.abs(mass @ qacc).max(initial=0.0) + np.abs(forces).max(initial=0.0)
        assert np.abs(balance).max(initial=0.0) <= EXACT * (size + 1e-6), model.name


def _first_copies(twin: Twin) -> np.ndarray:
    """Jacobian of the originals, in the order of our speeds."""
    rows, row = [], 0
    table = twin.jacobian()
    for body in twin.model.bodies:
        n = body.twist.numel()
        rows.append(table[row : row + n])
        row += n * len(twin.bodies[body.name])
    others = sum(g.twist.numel() for g in twin.model.coordinates) - sum(map(len, rows))
    return np.vstack([*rows, np.zeros((others, twin.m.nv))])


@pytest.mark.few(8)
@pytest.mark.parametrize("name", CASES)
def test_every_case_is_loaded_and_has_our_equations_unless_it_names_what_it_lacks(name):
    model = model_of(name)
    twin = Twin(model)
    for omission in twin.omissions:
        assert omission.place in model.parts.elements or omission.place == "gravity"
    if not twin.omissions:
        check_equations(model, 5)


def slider_crank() -> da.System:
    system = da.System("slider-crank", gravity=(0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.5, angle=0.7))
    rod = system.add(planar.Bar("rod", length=0.8, mass=2.0))
    block = system.add(planar.Body("block", mass=3.0, inertia=0.02))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, block.center))
    system.add(planar.Prismatic("rail", system.ground.center, block.center))
    return system


def shaper() -> da.System:
    """A loop through a sliding joint between two moving bodies, and one more through another."""
    system = da.System("shaper", gravity=(0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.2, mass=1.5, angle=1.0))
    lever = system.add(planar.Bar("lever", length=1.0, mass=2.0, angle=1.5))
    system.add(planar.Revolute("O", system.ground.point(0, 0.4), crank.start))
    system.add(planar.Revolute("C", system.ground.center, lever.start))
    system.add(planar.PinInSlot("slot", lever.start, crank.end))
    ram = system.add(planar.Body("ram", mass=2.0, inertia=0.1, position=(0, 0.9)))
    system.add(planar.Prismatic("guide", system.ground.point(0, 0.9), ram.center))
    system.add(planar.PinInSlot("top", lever.start, ram.center))
    return system


def four_hinges(last: str) -> da.System:
    """A spatial loop with parallel axes, closed by a revolute, spherical or cylindrical joint."""
    system = da.System(f"loop {last}", gravity=(0, 0, -9.81))
    y, places = (0, 1, 0), [(0, 0, 0), (0, 0, 0.3), (1.0, 0, 0.8), (1.2, 0, 0)]
    bodies, frames = [], [system.ground.frame(places[0], axis=y)]
    for k, (start, end) in enumerate(itertools.pairwise(places)):
        middle = tuple((a + b) / 2 for a, b in zip(start, end, strict=True))
        body = spatial.Body(
            f"b{k}",
            mass=1.0 + k,
            inertia=(0.1, 0.2, 0.15, 0.01, -0.02, 0.01),
            center_of_mass=(0.01, 0.02 * k, -0.03),
            position=middle,
        )
        bodies.append(system.add(body))
    for k, place in enumerate(places[1:-1]):
        i, j = bodies[k], bodies[k + 1]
        at_i, at_j = (tuple(np.subtract(place, _middle(places, m))) for m in (k, k + 1))
        system.add(spatial.Revolute(f"J{k}", i.frame(at_i, axis=y), j.frame(at_j, axis=y)))
    first = bodies[0].frame(tuple(np.subtract(places[0], _middle(places, 0))), axis=y)
    system.add(spatial.Revolute("first", frames[0], first))
    local = tuple(np.subtract(places[-1], _middle(places, 2)))
    if last == "spherical":
        system.add(
            spatial.Spherical("last", system.ground.point(*places[-1]), bodies[-1].point(*local))
        )
    else:
        kind = {"revolute": spatial.Revolute, "cylindrical": spatial.Cylindrical}[last]
        system.add(
            kind("last", system.ground.frame(places[-1], axis=y), bodies[-1].frame(local, axis=y))
        )
    return system


def _middle(places, k):
    return np.add(places[k], places[k + 1]) / 2


def loaded() -> da.System:
    """A chain in space with forces that MuJoCo has: exact ones only."""
    system = da.System("loaded", gravity=(0.3, -1.0, -9.0))
    a = system.add(spatial.Box("a", size=(0.2, 0.1, 0.3), mass=2.0, position=(0.1, 0, 0)))
    b = system.add(spatial.Body("b", mass=1.0, inertia=(0.1, 0.2, 0.15), position=(0.1, 0, 0.5)))
    ground = system.ground
    hinge = spatial.Cylindrical(
        "H", ground.frame(axis=(0, 1, 0)), a.frame((-0.1, 0, 0), axis=(0, 1, 0))
    )
    system.add(hinge)
    system.add(spatial.Spherical("E", a.point(0, 0, 0.25), b.point(0, 0, -0.25)))
    system.add(
        spatial.Spring(
            "spring",
            ground.point(1, 0, 0),
            b.point(0, 0.1, 0),
            stiffness=50.0,
            damping=2.0,
            free_length=0.7,
        )
    )
    system.add(spatial.Actuator("ram", ground.point(0, 1, 0), a.point(0, 0, 0.1), force=7.0))
    system.add(spatial.Force("push", b.point(0, 0.1, 0.2), (1.0, -2.0, 3.0)))
    system.add(spatial.Force("thrust", a.point(0, 0.1, 0.2), (1.0, 4.0, 3.0), follows=a))
    system.add(spatial.Torque("twist", b, (0.3, -0.2, 0.5)))
    system.add(spatial.Torque("pair", b, (0.3, 0.7, 0.5), reaction_on=a))
    system.add(spatial.Torque("own", b, (0.3, 0.7, 0.5), follows=b))
    system.add(spatial.JointFriction("rub", hinge, viscous=0.4, motion="angle"))
    system.add(spatial.JointActuator("drive", hinge, 0.6, motion="displacement"))
    ends = ground.frame(axis=(0, 1, 0)), a.frame((-0.1, 0, 0), axis=(0, 1, 0))
    system.add(spatial.TorsionSpring("coil", *ends, stiffness=3.0, damping=0.1, free_angle=0.2))
    system.add(spatial.TorsionSpring("coil_2", *ends, stiffness=2.0, free_angle=-0.4))
    return system


def planar_loads() -> da.System:
    system = slider_crank()
    bodies = {body.name: body for body in system.bodies}
    crank, rod = bodies["crank"], bodies["rod"]
    system.add(planar.Torque("motor", crank, 2.0))
    system.add(planar.Torque("wrist", rod, 1.0, reaction_on=crank))
    system.add(planar.Force("push", rod.center, (3.0, -1.0)))
    system.add(planar.Force("jet", rod.end, (3.0, -1.0), following=True))
    system.add(planar.TorsionSpring("coil", crank, rod, stiffness=4.0, damping=0.3, free_angle=0.1))
    system.add(planar.TorsionSpring("mast", system.ground, rod, stiffness=4.0, free_angle=-0.5))
    return system


BUILT = {
    "slider-crank": slider_crank,
    "shaper": shaper,
    **{
        f"four hinges {k}": lambda k=k: four_hinges(k)
        for k in ("revolute", "spherical", "cylindrical")
    },
    "loaded": loaded,
    "planar loads": planar_loads,
}


@pytest.mark.few(4)
@pytest.mark.parametrize("name", BUILT)
def test_loops_and_forces_have_our_equations(name):
    check_equations(BUILT[name]().build())


@pytest.mark.parametrize("name", ["slider-crank", "four hinges cylindrical", "loaded"])
def test_the_keyframe_is_the_assembled_start(name):
    model = BUILT[name]().build()
    twin, start = Twin(model), split(model, model.start.y, model.start.v, model.start.v)
    mujoco.mj_forward(twin.m, twin.d)
    assert np.abs(twin.error(start)).max() < 1e-12
    np.testing.assert_allclose(twin.jacobian() @ twin.d.qvel, twin.repeat(start, 1), atol=1e-12)


def test_simulation_of_a_tree():
    system = da.System("double pendulum", gravity=(0, -9.81))
    a = system.add(planar.Bar("a", length=0.5, mass=1.0, angle=-0.4, angular_velocity=1.0))
    b = system.add(planar.Bar("b", length=0.7, mass=2.0, angle=0.3))
    system.add(planar.Revolute("O", system.ground.center, a.start))
    system.add(planar.Revolute("A", a.end, b.start))
    model = system.build()
    motion = da.solve_dynamics(model, 1.0, step=1e-3, integrator=da.RK4())
    m, _ = written(model, step=1e-3)
    d = mujoco.MjData(m)
    mujoco.mj_resetDataKeyframe(m, d, 0)
    for _ in range(1000):
        mujoco.mj_step(m, d)
    place = d.xpos[m.body("b").id][:2]
    np.testing.assert_allclose(place, motion["b.position"][-1], atol=1e-9)


def test_parameters_are_evaluated():
    system = da.System("pendulum", gravity=(0, -9.81))
    length = system.parameter("length", 0.5, "m")
    bar = system.add(planar.Bar("bar", length=length, mass=2.0, angle=-1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    m, _ = written(system.build(), parameters={"length": 0.8})
    assert m.body("bar").inertia[2] == pytest.approx(2 * 0.64 / 12, rel=1e-12)


def test_omissions_are_comments_and_obstacles_name_the_element(tmp_path):
    system = da.System("rolls")
    wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.1, position=(0, 0.2)))
    system.add(planar.Bushing("mount", system.ground.center, wheel.center, stiffness=(1.0, 2.0)))
    written_file = da.export(system.build(), tmp_path / "rolls.xml")
    text = written_file.files[0].read_text()
    assert "not exported: mount: Bushing: MuJoCo has no such force" in text
    system = da.System("massless")
    rod = system.add(planar.Bar("rod", length=1.0))
    system.add(planar.Revolute("O", system.ground.center, rod.start))
    with pytest.raises(da.UnsupportedError, match="give 'rod' a mass"):
        da.export(system.build(), tmp_path / "x.xml")
    assert [path.name for path in tmp_path.iterdir()] == ["rolls.xml"]


EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))


@pytest.mark.few(8)
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_have_our_equations_or_name_what_they_lack(path):
    model = load_model_file(path).model()
    if model.kind != "mechanism":
        with pytest.raises(da.UnsupportedError, match="a mechanism, not a model of a structure"):
            written(model)
        return
    massless = [
        body.name for body in model.bodies if not float(Start(model).bodies[body.name].mass)
    ]
    if massless:
        with pytest.raises(da.UnsupportedError, match=rf"give '({'|'.join(massless)})' a mass"):
            written(model)
        return
    twin = Twin(model)
    if not twin.omissions:
        check_equations(model, 5)


def motor_arm() -> da.System:
    """Two links; the elbow has a geared motor that an input controls, the shoulder a biased one."""
    system = da.System("arm", gravity=(0, 0, -9.81))
    volts = system.input("volts", 0.3, bounds=(-12.0, 12.0))
    push = system.input("push", -0.5, unit="N m")
    constant = system.parameter("constant", 1.7)
    turned = da.rotation.axis_angle((1, 0, 0), -np.pi / 2)
    upper = system.add(spatial.Body("upper", mass=1.5, inertia=(0.02, 0.03, 0.025)))
    lower = system.add(spatial.Body("lower", mass=0.8, inertia=(0.01, 0.012, 0.009)))
    base = system.ground.frame((0, 0, 1), rotation=turned)
    shoulder = system.add(
        spatial.Revolute("shoulder", base, upper.frame((-0.2, 0, 0), rotation=turned))
    )
    ends = (upper.frame((0.2, 0, 0), rotation=turned), lower.frame((-0.15, 0, 0), rotation=turned))
    elbow = system.add(spatial.Revolute("elbow", *ends))
    system.add(spatial.JointActuator("gear", elbow, constant * volts, inertia=0.07))
    system.add(spatial.JointActuator("hub", shoulder, 0.2 + push, inertia=0.03))
    return system


def test_rotors_and_inputs_are_armatures_and_controls() -> None:
    model = motor_arm().build()
    m, omissions = written(model)
    assert [o for o in omissions if o.place in ("gear", "hub")] == []
    d = mujoco.MjData(m)
    mujoco.mj_resetDataKeyframe(m, d, 0)
    names = [m.actuator(k).name for k in range(m.nu)]
    np.testing.assert_allclose(d.ctrl[[names.index("gear"), names.index("hub")]], [0.3, -0.5])
    limited = m.actuator_ctrllimited[[names.index("gear"), names.index("hub")]]
    np.testing.assert_array_equal(limited, [1, 0])
    np.testing.assert_allclose(m.actuator_ctrlrange[names.index("gear")], [-12, 12])
    rng = np.random.default_rng(4)
    for _ in range(5):
        values = dict(zip(("volts", "push"), rng.uniform(-5, 5, 2), strict=True))
        d.ctrl[names.index("gear")], d.ctrl[names.index("hub")] = values["volts"], values["push"]
        mujoco.mj_forward(m, d)
        motion = da.solve_dynamics(model, 1e-6, step=1e-6, parameters=values)
        turns = [motion[f"{b}.angular_acceleration"].values[0, 1] for b in ("upper", "lower")]
        ours = [turns[0], turns[1] - turns[0]]
        named = {m.joint(k).name.removesuffix(".angle"): d.qacc[k] for k in range(m.njnt)}
        theirs = [named["shoulder"], named["elbow"]]
        np.testing.assert_allclose(theirs, ours, rtol=EXACT)
