"""Blocks and drives in model files: order of dependence, messages, the command line."""

import numpy as np
import pytest

import dalembert as da

HEAD = """
format = 1
name = "lift"
gravity = [0, -10]
[parameters]
kp = 80.0
[bodies.cabin]
type = "Particle"
mass = 2.0
[joints.rail]
type = "PinInSlot"
connect = ["ground", "cabin"]
axis = [0, 1]
"""
DRIVE = """
[forces.drive]
type = "Force"
connect = ["cabin"]
vector = [0, "control.output"]
"""
CONTROL = """
[blocks.control]
type = "PID"
setpoint = "1 + 0*slow.value"
measured = "smooth.output"
proportional = "kp"
integral = 60
derivative = 40
[blocks.slow]
type = "State"
rate = "drive.force.y - slow.value"
start = "kp/40"
[blocks.smooth]
type = "LowPass"
input = "cabin.y"
cutoff = "300 rad/s"
order = 2
[blocks.lag]
type = "TransferFunction"
input = "cabin.y"
numerator = [1, "kp"]
denominator = [1, 2, 3]
[blocks.matrix]
type = "StateSpace"
inputs = ["cabin.y", "t"]
A = [[-1]]
B = [[1, 2]]
C = [[1], [2]]
"""


def loaded(folder, text: str) -> da.System:
    path = folder / "lift.toml"
    path.write_text(text, encoding="utf-8")
    return da.load_model(path)


def test_elements_may_depend_on_each_other(tmp_path):
    """In any order of the file; a state breaks every cycle."""
    texts = (HEAD + CONTROL + DRIVE, HEAD + DRIVE + CONTROL)
    ends = []
    for text in texts:
        motion = da.solve_dynamics(loaded(tmp_path, text).build(), 1.0)
        names = "cabin.y", "slow.value", "lag.output", "matrix.output2", "control.output"
        ends.append([motion[name][-1].item() for name in names])
        assert motion["slow.value"][0].item() == 2.0
    assert np.array_equal(*ends)


def test_a_motor_with_a_controller_of_its_current(tmp_path):
    text = (
        HEAD.replace("[0, -10]", "[0, 0]")
        + """
[forces.motor]
type = "DCMotor"
joint = "rail"
motion = "displacement"
voltage = "regulator.output - 0.1*motor.current"
constant = 0.05
ratio = "kp"
[blocks.regulator]
type = "PID"
setpoint = 1.5
measured = "motor.current"
proportional = 2
integral = 800
"""
    )
    motion = da.solve_dynamics(loaded(tmp_path, text).build(), 0.5)
    assert motion.status.success
    assert motion["motor.force"][-1].item() == pytest.approx(
        80 * 0.05 * motion["motor.current"][-1].item(), rel=1e-12
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[blocks.x]\ntype = "State"\n', "x: has no rate"),
        ('[blocks.x]\ntype = "Pid"\n', "PID"),
        ('[blocks.x]\ntype = "State"\nrate = "y.z"\n', "y"),
        ('[blocks.x]\ntype = "State"\nrate = "1"\nstart = "cabin.y"\n', "only parameters"),
        ('[blocks.x]\ntype = "LowPass"\ninput = "cabin.y"\ncutoff = -1\n', "cutoff"),
        ('[blocks.cabin]\ntype = "State"\nrate = 1\n', "cabin"),
        (
            '[blocks.a]\ntype = "LeadLag"\ninput = "b.output"\nlead = 1\nlag = 2\n'
            '[blocks.b]\ntype = "LeadLag"\ninput = "a.output"\nlead = 1\nlag = 2\n',
            "depends on itself in the cycle",
        ),
    ],
)
def test_faults_are_named(tmp_path, text, message):
    with pytest.raises(da.DalembertError, match=message):
        loaded(tmp_path, HEAD + text).build()


SAMPLED = """
[blocks.sensor]
type = "Quantizer"
input = "cabin.y"
resolution = 1e-4
sample_time = "10 ms"
[blocks.late]
type = "Delay"
input = "sensor.output"
samples = 2
sample_time = "10 ms"
[blocks.control]
type = "SampledPID"
setpoint = 1
measured = "late.output"
proportional = "kp"
integral = 60
derivative = 40
filter_time = 0.05
sample_time = 0.01
[blocks.count]
type = "SampledState"
next = "count.value + 1"
sample_time = 0.1
"""


def test_sampled_blocks_in_files(tmp_path):
    model = loaded(tmp_path, HEAD + SAMPLED + DRIVE).build()
    motion = da.solve_dynamics(model, 2.0, step=0.005)
    assert motion["count.value"][-1].item() == 20.0
    assert motion["cabin.y"][-1].item() == pytest.approx(1.0, abs=0.3)
    assert np.all(np.abs(motion["sensor.output"] / 1e-4 % 1 - 0.5) > 0.49)


def test_sampled_blocks_need_a_sample_time(tmp_path):
    text = HEAD + '[blocks.hold]\ntype = "ZeroOrderHold"\ninput = "cabin.y"\n'
    with pytest.raises(da.ModelError, match=r"hold: has no sample_time"):
        loaded(tmp_path, text)
