"""Functional mock-up units: simulated and differentiated in FMPy, compared with the model."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
import threading
import zipfile
from ctypes import byref
from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.cli import main
from dalembert.errors import UnsupportedError

fmpy = pytest.importorskip("fmpy")
from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402

from tests.fmu_units import Instance  # noqa: E402

OUTPUTS = ["crank.angle", "rocker.angle", "A.force_norm", "coupler.y", "crank.angular_acceleration"]
STEP = 4e-3


def four_bar(name: str = "four bar <1>") -> da.Model:
    """Four-bar linkage with a motor, a spring and a filtered torque."""
    system = da.System(name, gravity=(0, -9.81))
    length = system.parameter("length", 0.3, "m", bounds=(0.2, 0.4), description="crank & more")
    density = system.parameter("density", "5 kg/m")
    speed = system.parameter("speed", 60, "rpm")
    span = system.parameter("span", 1.0, "m")
    torque = system.input("torque", unit="N m", description="of the motor")
    crank = system.add(
        planar.Bar("crank", length=length, mass=density * length, angle=1.5, angular_velocity=speed)
    )
    coupler = system.add(planar.Bar("coupler", length=span, mass=density * span, angle=0.2))
    rocker = system.add(
        planar.Bar("rocker", length=0.6 * span, mass=0.6 * density * span, angle=1.2)
    )
    pivot = system.ground.point(1.0, 0.0)
    system.add(planar.Revolute("O1", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", pivot, rocker.start))
    lag = system.add(da.blocks.LowPass("lag", torque, cutoff=20.0))
    system.add(planar.Torque("motor", crank, lag.output))
    return system.build()


@pytest.fixture(scope="module")
def model():
    return four_bar()


@pytest.fixture(scope="module")
def unit(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "four_bar.fmu"
    analysis = da.Dynamics(duration=1.0, step=STEP)
    return da.export_fmu(model, path, analysis, kind="both", outputs=OUTPUTS)


@pytest.fixture(scope="module")
def unit2(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "four_bar.fmu"
    return da.export_fmu(model, path, kind="both", fmi=2, outputs=OUTPUTS, step=STEP)


def test_description_is_valid(unit, unit2, model):
    for exported in (unit, unit2):
        assert validate_fmu(str(exported.path)) == []
    description = fmpy.read_model_description(str(unit.path))
    by_name = {v.name: v for v in description.modelVariables}
    assert description.modelName == "four bar <1>"
    assert (
        by_name["length"].variability == "fixed" and by_name["length"].description == "crank & more"
    )
    assert (by_name["length"].min, by_name["length"].max) == ("0.2", "0.4")
    assert by_name["density"].variability == "tunable"
    assert by_name["torque"].causality == "input" and by_name["torque"].unit == "N m"
    assert by_name["speed"].displayUnit == "rpm" and np.isclose(
        float(by_name["speed"].start), 2 * np.pi
    )
    units = {u.name: u for u in description.unitDefinitions}
    assert (units["N m"].baseUnit.kg, units["N m"].baseUnit.m, units["N m"].baseUnit.s) == (
        1,
        2,
        -2,
    )
    assert float(units["rad/s"].displayUnits[0].factor) == pytest.approx(30 / np.pi)
    assert unit.states == ("O1.angle", "rate of O1.angle", "lag.state") or len(unit.states) == 3
    text = zipfile.ZipFile(unit.path).read("modelDescription.xml").decode()
    for ability in ("providesDirectionalDerivatives", "providesAdjointDerivatives"):
        assert text.count(f'{ability}="true"') == 2


def contents(path, binaries=True):
    archive = zipfile.ZipFile(path)
    names = [n for n in archive.namelist() if binaries or not n.startswith("binaries/")]
    return {name: archive.read(name) for name in names}


def stone(name: str = "stone") -> da.Model:
    """A free particle, compiled quickly."""
    system = da.System(name, gravity=(0, -10))
    system.add(planar.Particle("stone", mass=1.0))
    return system.build()


@pytest.mark.thorough
def test_equal_models_give_equal_files(unit, tmp_path):
    """Also their libraries, without paths of the machine, and with any name of the model."""
    hostile = '*\\\n/ <&>" ?? ü'
    for place in ("a", "b"):
        (tmp_path / place).mkdir()
        da.export_fmu(stone(hostile), tmp_path / place / "x.fmu", kind="both")
    first, second = (tmp_path / place / "x.fmu" for place in ("a", "b"))
    assert first.read_bytes() == second.read_bytes() and validate_fmu(str(first)) == []
    for name, data in contents(first).items():
        for folder in (tempfile.gettempdir(), str(Path(__file__).parents[1])):
            assert folder.encode() not in data, name
    again = da.export_fmu(
        four_bar(),
        tmp_path / "a.fmu",
        da.Dynamics(duration=1.0, step=STEP),
        kind="both",
        outputs=OUTPUTS,
        platforms=(),
    )
    assert contents(again.path) == contents(unit.path, binaries=False)


@pytest.mark.parametrize("version", [3, 2])
def test_co_simulation_is_the_run(version, unit, unit2, model):
    path = unit.path if version == 3 else unit2.path
    start = {"length": 0.33, "density": 4.0, "torque": 3.0}
    result = fmpy.simulate_fmu(
        str(path),
        fmi_type="CoSimulation",
        stop_time=1.0,
        output_interval=2 * STEP,
        start_values=start,
    )
    motion = da.solve_dynamics(model, 1.0, step=STEP, outputs=126, parameters=start)
    for name in OUTPUTS:
        expected = motion[name].values
        assert np.abs(result[name] - expected).max() < 1e-10 * max(1.0, np.abs(expected).max())


def test_model_exchange_is_the_run(unit, model):
    result = fmpy.simulate_fmu(
        str(unit.path),
        fmi_type="ModelExchange",
        stop_time=1.0,
        output_interval=0.01,
        relative_tolerance=1e-10,
    )
    motion = da.solve_dynamics(model, 1.0, step=5e-4, outputs=[1.0])
    for name in OUTPUTS:
        expected = float(motion[name][-1])
        assert result[name][-1] == pytest.approx(expected, rel=1e-5, abs=1e-5)


def test_rates_are_those_of_the_model(unit, model):
    """Rates at states of a run equal the accelerations of its outputs."""
    motion = da.solve_dynamics(model, 0.5, step=1e-3, outputs=6, parameters={"torque": 2.0})
    one = Instance(unit.path, "ModelExchange").begin(torque=2.0)
    for k in range(6):
        x = [motion[n][k].item() for n in ("crank.angle", "crank.angular_velocity", "lag.output")]
        one.set_states(np.array(x))
        one.unit.setTime(float(motion.time[k]))
        assert np.allclose(
            one.get(*OUTPUTS), [motion[n][k].item() for n in OUTPUTS], rtol=1e-9, atol=1e-9
        )
        one.unit.completedIntegratorStep()
    one.free()


def finite_differences(one, unknowns, knowns, step=1e-5):
    columns = []
    for name in knowns:
        value = one.get(name)[0]
        values = []
        for sign in (1, -1):
            one.set(**{name: value + sign * step})
            values.append(one.get(*unknowns))
        one.set(**{name: value})
        columns.append((values[0] - values[1]) / (2 * step))
    return np.array(columns).T


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
def test_derivatives_while_running(kind, unit):
    one = Instance(unit.path, kind).begin(torque=1.5)
    unknowns, knowns = list(OUTPUTS), ["torque", "density"]
    if kind == "ModelExchange":
        unknowns += [f"der({name})" for name in unit.states]
        knowns += unit.states
        one.set_states(one.states() + np.array([0.4, -0.3, 0.2]))
        one.unit.enterEventMode()  # in which tunable parameters can be set
    else:
        one.step(0.0, 10 * STEP)
    matrix = np.array([one.directional(unknowns, knowns, e) for e in np.eye(len(knowns))]).T
    transposed = np.array([one.adjoint(unknowns, knowns, e) for e in np.eye(len(unknowns))])
    differences = finite_differences(one, unknowns, knowns)
    scale = np.maximum(1.0, np.abs(matrix).max())
    assert np.abs(matrix - transposed).max() < 1e-13 * scale
    assert np.abs(matrix - differences).max() < 1e-8 * scale
    one.free()


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
def test_derivatives_of_the_start(kind, unit):
    """Through the assembly at other parameters."""
    one = Instance(unit.path, kind)
    one.unit.enterInitializationMode()
    one.set(length=0.35)
    unknowns, knowns = list(OUTPUTS), ["length", "density", "speed", "torque"]
    if kind == "ModelExchange":
        unknowns += [*unit.states, *(f"der({name})" for name in unit.states)]
    matrix = np.array([one.directional(unknowns, knowns, e) for e in np.eye(len(knowns))]).T
    transposed = np.array([one.adjoint(unknowns, knowns, e) for e in np.eye(len(unknowns))])
    differences = finite_differences(one, unknowns, knowns)
    scale = np.maximum(1.0, np.abs(matrix).max())
    assert np.abs(matrix - transposed).max() < 1e-13 * scale
    assert np.abs(matrix - differences).max() < 1e-8 * scale
    one.unit.exitInitializationMode()
    one.free()


def test_any_communication_step(unit):
    """Multiples, fractions and odd lengths of the internal step end at the same motion."""
    ends = []
    for length in (STEP, 8 * STEP, 0.25 * STEP, 0.7 * STEP):
        one = Instance(unit.path, "CoSimulation").begin()
        count = round(0.2 / length)
        for k in range(count):
            one.step(k * length, length)
        one.step(count * length, 0.2 - count * length) if count * length < 0.2 else None
        ends.append(one.get(*OUTPUTS))
        one.free()
    assert np.allclose(ends[1], ends[0], rtol=1e-12, atol=1e-12)
    assert np.allclose(ends[2:], ends[0], rtol=1e-5, atol=1e-5)


@pytest.mark.few(2)
@pytest.mark.parametrize("version", [3, 2])
@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
def test_saved_states(version, kind, unit, unit2):
    """Runs from a restored state repeat bit by bit, in another instance as well."""
    path = unit.path if version == 3 else unit2.path
    one = Instance(path, kind).begin(torque=1.0)
    u = one.unit
    (save, write, read, restore, free) = (
        (u.getFMUState, u.serializeFMUState, u.deserializeFMUState, u.setFMUState, u.freeFMUState)
        if version == 3
        else (
            u.getFMUstate,
            u.serializeFMUstate,
            u.deSerializeFMUstate,
            u.setFMUstate,
            u.freeFMUstate,
        )
    )

    def move(instance):
        if kind == "ModelExchange":
            values = instance.get("time", *OUTPUTS)
            instance.set_states(instance.states() + np.array([0.1, -0.2, 0.3]))
            return np.concatenate([values, instance.get("time", *OUTPUTS)])
        else:
            instance.step(0.1, 0.1)
        return instance.get("time", *OUTPUTS)

    if kind == "CoSimulation":
        one.step(0.0, 0.1)
    else:
        one.set_states(one.states() + np.array([0.2, 0.1, -0.3]))
        one.unit.completedIntegratorStep()
    state = save()
    first = move(one)
    restore(state)
    assert np.array_equal(move(one), first)
    restore(state)
    other = read(write(state))
    one.set(torque=-5.0)
    restore(other)
    assert np.array_equal(move(one), first)
    free(state)
    free(other)
    one.free()


def test_states_of_the_other_interface_type(unit):
    """Memory of a saved state of the other interface type, of another size, is not overwritten."""
    step, exchange = (Instance(unit.path, k).begin() for k in ("CoSimulation", "ModelExchange"))
    for own, other in ((step, exchange), (exchange, step)):
        state = other.unit.getFMUState()
        before = other.unit.serializeFMUState(state)
        refused(own, own.unit.fmi3GetFMUState, "another unit", own.unit.component, byref(state))
        refused(own, own.unit.setFMUState, "another unit", state)
        assert other.unit.serializeFMUState(state) == before
        other.unit.freeFMUState(state)
    content = step.unit.serializeFMUState(step.unit.getFMUState())
    refused(exchange, exchange.unit.deserializeFMUState, "another unit", content)
    step.free()
    exchange.free()


def test_reset_and_parameters(unit):
    one = Instance(unit.path, "CoSimulation").begin(torque=1.0, length=0.25)
    one.step(0.0, 0.1)
    first = one.get(*OUTPUTS)
    one.unit.reset()
    assert one.get("torque", "length").tolist() == [0.0, 0.3]
    one.begin(torque=1.0, length=0.25)
    one.step(0.0, 0.1)
    assert np.array_equal(one.get(*OUTPUTS), first)
    one.set(density=4.0)  # tunable
    with pytest.raises(FMICallException):
        one.set(length=0.26)
    assert "length is fixed after initialization" in one.messages[-1]
    one.free()


def test_errors_name_the_joint(unit, unit2):
    for path in (unit.path, unit2.path):
        one = Instance(path, "CoSimulation")
        with pytest.raises(FMICallException):
            one.begin(length=2.5)
        assert "assembly: no position" in one.messages[-1] and "is open by" in one.messages[-1]
        one.unit.reset()
        with pytest.raises(FMICallException):
            one.begin(density=-1.0)
        assert "crank" in one.messages[-1] and "not valid" in one.messages[-1]
        one.unit.freeInstance()


def test_instances_are_independent(unit):
    """Each in a thread of its own, freed in another order than created."""
    folder = fmpy.extract(str(unit.path))
    several, values = [Instance(unit.path, "CoSimulation", folder) for _ in range(4)], {}

    def run(k, one):
        one.begin(torque=float(k // 2))
        for i in range(5):
            one.step(i * 0.02, 0.02)
        values[k] = one.get(*OUTPUTS)

    threads = [threading.Thread(target=run, args=pair) for pair in enumerate(several)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.array_equal(values[0], values[1]) and np.array_equal(values[2], values[3])
    assert not np.array_equal(values[0], values[2])
    for k in (2, 0, 3, 1):
        several[k].free()


def refused(one, call, text, *arguments, **values):
    """The call returns an error whose message contains the text."""
    with pytest.raises(FMICallException, match=r"status 3 \(error\)"):
        call(*arguments, **values)
    assert text in one.messages[-1]


def test_modes(unit):
    """Calls outside of their modes are errors, after which the instance works as before."""
    one = Instance(unit.path, "ModelExchange")
    u, first = one.unit, list(one.references.values())
    refused(one, u.terminate, "fmi3Terminate is not possible")
    refused(one, u.updateDiscreteStates, "fmi3UpdateDiscreteStates is not possible")
    refused(one, u.enterConfigurationMode, "not supported")
    refused(one, one.directional, "after the start", ["crank.angle"], ["torque"], [1.0])
    refused(one, one.states, "fmi3GetContinuousStates is not possible")
    refused(one, u.setFloat64, "cannot be set here", first[:1], [1.0])  # time
    u.enterInitializationMode()
    refused(one, u.enterContinuousTimeMode, "fmi3EnterContinuousTimeMode is not possible")
    refused(one, u.setTime, "fmi3SetTime is not possible", 1.0)
    u.exitInitializationMode()
    one.settle()
    u.enterContinuousTimeMode()
    before = one.get(*OUTPUTS)
    with pytest.raises(FMICallException):
        one.set(torque=1.0, density=3.0)
    assert "density is tunable: set it in event mode" in one.messages[-1]
    refused(one, u.updateDiscreteStates, "fmi3UpdateDiscreteStates is not possible")
    refused(one, u.setTime, "the time is not a finite number", float("nan"))
    assert np.array_equal(one.get(*OUTPUTS), before)  # neither of both was set
    u.enterEventMode()
    one.set(density=3.0)
    one.free()


def test_steps_that_are_refused(unit, unit2):
    one = Instance(unit.path, "CoSimulation")
    one.unit.enterInitializationMode(startTime=0.0, stopTime=0.5)
    one.unit.exitInitializationMode()
    one.step(0.0, 0.1)
    before = one.get("time", *OUTPUTS)
    text = "a step of length"
    for length in (0.0, -0.1, float("nan"), float("inf"), 1e300):
        with pytest.raises(FMICallException):
            one.step(0.1, length)
        assert text in one.messages[-1] or "passes the stop time" in one.messages[-1]
    refused(one, one.step, "passes the stop time, 0.5", 0.1, 0.5)
    refused(one, one.step, "but 0.1 s is reached", 0.2, 0.1)
    for name, value, message in (
        ("torque", float("nan"), "torque: the value is not a finite number"),
        ("density", -1.0, "not valid"),
        ("length", 0.3, "length is fixed"),
    ):
        with pytest.raises(FMICallException):
            one.set(**{name: value})
        assert message in one.messages[-1]
    assert np.array_equal(one.get("time", *OUTPUTS), before)
    one.step(0.1, 0.4)  # exactly to the stop time
    assert one.get("time")[0] == 0.5
    one.free()
    two = Instance(unit2.path, "CoSimulation")
    two.unit.setupExperiment(startTime=0.0, stopTime=0.2)
    two.unit.enterInitializationMode()
    two.unit.exitInitializationMode()
    two.step(0.0, 0.0)  # iterations of events in FMI 2.0
    refused(two, two.step, "passes the stop time, 0.2", 0.0, 0.3)
    two.free()


def test_dependencies(tmp_path):
    """Outputs list the time, and in FMI 3.0 parameters, that they depend on."""
    system = da.System("forced", gravity=(0, -10))
    mass, gain = system.parameter("mass", 2.0, "kg"), system.parameter("gain", 3.0, "N")
    push = system.input("push", unit="N")
    body = system.add(planar.Particle("body", mass=mass))
    force = gain * da.sin(da.t) + push
    system.add(planar.Force("force", body.center, (force, 0)))
    system.output("force", force)
    system.output("x", body.x)
    model = system.build()
    motion = {"rate of body.x"}
    expected = {
        3: {"force": {"time", "gain", "push"}, "rate": {"time", "gain", "push", "mass"}},
        2: {"force": {"time", "push"}, "rate": {"time", "push"}},
    }
    for fmi in (3, 2):
        path = tmp_path / "x.fmu"
        unit = da.export_fmu(model, path, kind="model_exchange", fmi=fmi, platforms=())
        position, speed = unit.states[0], "rate of body.x"
        description = fmpy.read_model_description(str(path))
        lists = {
            u.variable.name: {v.name for v in u.dependencies}
            for u in (*description.outputs, *description.derivatives)
        }
        assert lists["force"] == expected[fmi]["force"]
        assert lists[f"der({speed})"] == expected[fmi]["rate"]
        assert lists["x"] == {position} and lists[f"der({position})"] == motion


def sampled_arm(first: float) -> da.Model:
    """An arm with a sampled controller and a slower sample-and-hold of its speed."""
    system = da.System("sampled arm", gravity=(0, -10))
    push = system.input("push", unit="N m")
    arm = system.add(planar.Bar("arm", length=1.0, mass=2.0, angle=0.3))
    system.add(planar.Revolute("O", system.ground.center, arm.start))
    gains = {"proportional": 60.0, "integral": 20.0, "derivative": 8.0}
    timing = {"sample_time": 0.02, "first_sample": first}
    pid = system.add(da.blocks.SampledPID("pid", 0.5, arm.angle, **gains, **timing))
    slow = da.blocks.ZeroOrderHold("hold", arm.angular_velocity, sample_time=0.05)
    hold = system.add(slow)
    system.add(planar.Torque("motor", arm, pid.output - 0.5 * hold.output + push))
    system.output("angle", arm.angle)
    system.output("torque", pid.output)
    return system.build()


@pytest.mark.thorough
def test_sampled_blocks(tmp_path):
    """Samples of co-simulation are those of a run, at any communication step and start time."""
    model = sampled_arm(0.01)
    unit = da.export_fmu(model, tmp_path / "s.fmu", step=5e-3)
    motion = da.solve_dynamics(model, 1.0, step=5e-3, parameters={"push": 2.0})
    for interval, every in ((0.005, 1), (0.1, 20)):
        result = fmpy.simulate_fmu(
            str(unit.path), stop_time=1.0, output_interval=interval, start_values={"push": 2.0}
        )
        assert np.abs(result["angle"] - motion["angle"].values[::every]).max() < 1e-12
        assert result["torque"][-1] == pytest.approx(motion["torque"][-1].item(), abs=1e-10)
    one = Instance(unit.path, "CoSimulation").begin(push=2.0)
    one.step(0.0, 0.513)
    state = one.unit.getFMUState()
    ends = []
    for _ in range(2):
        one.step(0.513, 0.487)
        ends.append(one.get("angle", "torque"))
        one.unit.setFMUState(state)
    assert np.array_equal(*ends)
    assert ends[0][0] == pytest.approx(motion["angle"][-1].item(), abs=1e-6)
    one.unit.freeFMUState(state)
    one.free()


def test_full_turns(unit):
    """A driven crank passes the positions in which its rocker turns back."""
    result = fmpy.simulate_fmu(
        str(unit.path),
        fmi_type="ModelExchange",
        stop_time=3.0,
        start_values={"speed": 20.0},
        relative_tolerance=1e-8,
    )
    assert abs(result["crank.angle"][-1]) > 12 * np.pi / 2
    assert np.ptp(result["rocker.angle"]) < np.pi


def test_refusals(model, tmp_path):
    path = tmp_path / "x.fmu"
    with pytest.raises(UnsupportedError, match=r"'length' is in the equations of"):
        da.export_fmu(model, path, inputs=["length"])
    system = da.System("sampled")
    system.add(da.blocks.SampledPID("control", 1.0, system.input("y"), sample_time=0.1))
    with pytest.raises(UnsupportedError, match="control: sampled blocks are not available in mod"):
        da.export_fmu(system.build(), path, kind="model_exchange")
    with pytest.raises(UnsupportedError, match=r"takes a model; got .*; build\(\) it first"):
        da.export_fmu(system, path)
    for step in (0.0, -0.1, float("nan")):
        with pytest.raises(UnsupportedError, match=r"step=.* is a positive number"):
            da.export_fmu(model, path, step=step)
    with pytest.raises(UnsupportedError, match=r"no coordinate 'crank\.angel'"):
        da.export_fmu(model, path, kind="model_exchange", states=["crank.angel"])
    with pytest.raises(UnsupportedError, match="controls the error; give a step"):
        da.export_fmu(model, path, da.Dynamics(duration=1.0, integrator=da.DormandPrince()))
    with pytest.raises(UnsupportedError, match=r"FMI 2\.0 has no folder"):
        da.export_fmu(model, path, fmi=2, platforms=["aarch64-linux"])
    assert not path.exists()


@pytest.mark.thorough
def test_one_degree_of_freedom(tmp_path):
    """A pendulum without other coordinates, in both interface types."""
    system = da.System("pendulum", gravity=(0, -10))
    bar = system.add(planar.Bar("bar", length=1.5, mass=2.0, angle=-0.3))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    model = system.build()
    unit = da.export_fmu(model, tmp_path / "p.fmu", kind="both", outputs=["bar.angle"], step=0.01)
    end = da.solve_dynamics(model, 1.0, step=0.01)["bar.angle"][-1].item()
    for kind, error in (("CoSimulation", 1e-13), ("ModelExchange", 1e-6)):
        result = fmpy.simulate_fmu(
            str(unit.path), fmi_type=kind, stop_time=1.0, relative_tolerance=1e-9
        )
        assert result["bar.angle"][-1] == pytest.approx(end, abs=error)


def test_switches_are_events(tmp_path):
    """A ball on a one-sided spring: instants of contact are those of half a period."""
    system = da.System("ball", gravity=(0, -10))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.2)))
    push = da.where(ball.y < 0, -1e4 * ball.y, 0 * ball.y)
    system.add(planar.Force("floor", ball.center, (0, push)))
    model = system.build()
    unit = da.export_fmu(model, tmp_path / "ball.fmu", kind="both", outputs=["ball.y", "ball.vy"])
    assert len(fmpy.read_model_description(str(unit.path)).eventIndicators) == 1
    result = fmpy.simulate_fmu(
        str(unit.path), fmi_type="ModelExchange", stop_time=2.0, relative_tolerance=1e-8
    )
    y, v = result["ball.y"], result["ball.vy"]
    energy = 0.5 * v**2 + 10 * y + np.where(y < 0, 0.5e4 * y**2, 0.0)
    assert np.abs(energy - energy[0]).max() < 2e-5 * abs(energy[0])
    motion = da.solve_dynamics(model, 2.0, outputs=[2.0])
    assert result["ball.y"][-1] == pytest.approx(motion["ball.y"][-1].item(), abs=1e-4)
    one = Instance(unit.path, "CoSimulation").begin()
    for time, length, below in ((0.0, 0.1, False), (0.1, 0.11, True), (0.21, 0.09, False)):
        one.step(time, length)
        assert (one.get("switch 1")[0] > 0) == (one.get("ball.y")[0] < 0) == below
    one.free()


def test_invalid_parameters_set_with_states(tmp_path):
    """A call that sets a state and an invalid parameter changes neither of them."""
    system = da.System("stone", gravity=(0, -10))
    mass = system.parameter("mass", 2.0, "kg")
    system.add(planar.Particle("stone", mass=mass, position=(0, 1)))
    unit = da.export_fmu(system.build(), tmp_path / "stone.fmu", kind="both")
    one = Instance(unit.path, "ModelExchange").begin()
    one.unit.enterEventMode()
    before = one.get("mass", "state.stone.x", "stone.x")
    refused(one, one.set, "stone", **{"state.stone.x": 7.0, "mass": -1.0})
    assert np.array_equal(one.get("mass", "state.stone.x", "stone.x"), before)
    one.set(**{"state.stone.x": 7.0, "mass": 3.0})
    assert one.get("mass", "state.stone.x", "stone.x").tolist() == [3.0, 7.0, 7.0]
    one.free()


def test_unstable_steps_are_reported(tmp_path, capsys):
    """RK4 of an undamped spring is stable up to h = 2√2/ω: a warning about longer steps only."""
    system = da.System("mass on a spring")
    mass = system.add(planar.Particle("mass", mass=1.0, position=(1, 0)))
    anchor = system.ground.point(-1, 0)
    system.add(planar.Spring("spring", anchor, mass.center, stiffness=1e4, free_length=2.0))
    model, path = system.build(), tmp_path / "spring.fmu"
    options = {"platforms": (), "outputs": ["mass.x"]}
    assert not da.export_fmu(model, path, step=0.99 * 2.83e-2, **options).warnings
    (warning,) = da.export_fmu(model, path, step=1.1 * 2.83e-2, **options).warnings
    assert "spring alone oscillates at 100 rad/s: RK4 with steps of 0.0311" in warning
    assert not da.export_fmu(model, path, step=0.1, kind="model_exchange", **options).warnings
    (omission,) = da.export(model, path, step=0.1, **options).omissions
    assert "spring alone oscillates" in omission.reason


def test_controller_alone(tmp_path):
    """``K e + I e t`` for a constant error e."""
    system = da.System("controller")
    speed = system.input("speed", 0.2, "rad/s")
    pid = system.add(da.blocks.PID("pid", 1.0, speed, proportional=2.0, integral=1.5))
    system.output("torque", pid.output)
    unit = da.export_fmu(system.build(), tmp_path / "c.fmu", kind="both")
    assert (unit.inputs, unit.outputs, unit.states) == (("speed",), ("torque",), ("pid.integral",))
    for kind in ("CoSimulation", "ModelExchange"):
        result = fmpy.simulate_fmu(str(unit.path), fmi_type=kind, stop_time=2.0)
        assert result["torque"][-1] == pytest.approx(0.8 * (2.0 + 1.5 * 2.0), rel=1e-6)


MAGIC = {"x86_64-windows": b"MZ", "aarch64-darwin": b"\xcf\xfa\xed\xfe\x0c\x00\x00\x01"}


@pytest.mark.thorough
@pytest.mark.parametrize("platform", MAGIC)
def test_other_platforms(platform, tmp_path):
    """Compiled here by ziglang; the header of the file is that of the platform."""
    pytest.importorskip("ziglang")
    unit = da.export_fmu(stone(), tmp_path / "s.fmu", platforms=platform)
    archive = zipfile.ZipFile(unit.path)
    (library,) = (name for name in archive.namelist() if name.startswith("binaries/"))
    assert library.startswith(f"binaries/{platform}/stone.")
    assert archive.read(library).startswith(MAGIC[platform])


@pytest.mark.thorough
def test_memory(unit, tmp_path):
    """Instances are created, run, differentiated and freed under sanitizers, errors included."""
    compiler = shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no compiler with sanitizers")
    zipfile.ZipFile(unit.path).extractall(tmp_path)
    sources = tmp_path / "sources"
    shutil.copy(Path(__file__).with_name("fmu_memory.c"), sources)
    checks = ["-fsanitize=address,undefined", "-fno-sanitize-recover=undefined", "-w", "-O1"]
    command = [compiler, "-std=c99", *checks, "-Iheaders", "fmu_memory.c", "-o", "run", "-lm"]
    subprocess.run(command, cwd=sources, check=True)
    process = subprocess.run([sources / "run"], capture_output=True, text=True)
    assert process.returncode == 0, process.stderr
    assert process.stdout.endswith("done\n")


ARM = """
format = 1
name = "arm"
gravity = [0.0, -9.81]

[bodies]
arm = { mass = 2.0, inertia = 0.2, angle = 0.5, points = { hinge = [0.0, 0.5] } }

[joints]
hinge = { type = "Revolute", connect = ["ground", "arm.hinge"] }

[analysis]
type = "Dynamics"
duration = 0.7
step = 0.01
"""


def test_registry_of_formats_and_command(model, unit, tmp_path, capsys):
    """``da.export`` by the suffix, and ``dalembert export --to fmu``."""
    analysis = da.Dynamics(duration=1.0, step=STEP)
    motion = analysis.run(model)
    options = {"kind": "both", "outputs": OUTPUTS, "platforms": ()}
    written = da.export(motion, tmp_path / "a.fmu", **options)
    assert contents(written.files[0]) == contents(unit.path, binaries=False)
    source = str(tmp_path / "arm.toml")
    Path(source).write_text(ARM)
    arguments = ["export", source, "--to", "fmu", "-o", str(tmp_path), "--measure", "arm.angle"]
    assert main([*arguments, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["files"] == [str(tmp_path / "arm.fmu")]
    assert answer["measures"] == ["arm.angle"]
    result = fmpy.simulate_fmu(answer["files"][0])
    assert result["time"][-1] == pytest.approx(0.7)
    assert main([*arguments, "--kind", "bth"]) == 2
    assert "unknown kind 'bth' (did you mean 'both'?)" in capsys.readouterr().err


def test_contacts_among_many_shapes_are_refused(tmp_path):
    """A unit without them would let bodies fall through the floor."""
    system = da.System("bounce", gravity=(0.0, -10.0))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0.0, 0.3)))
    floor = planar.contact.HalfPlane(system.ground.center)
    system.add(planar.Collisions("hits", [planar.contact.Circle(ball.center, 0.1), floor]))
    with pytest.raises(UnsupportedError, match="hits: contacts among many shapes are not availab"):
        da.export_fmu(system.build(), tmp_path / "ball.fmu")
    assert not list(tmp_path.iterdir())
