"""Blocks and drives against SciPy and closed forms."""

import numpy as np
import pytest
from scipy import signal
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

END, OMEGA = 2.0, 7.0
PRECISE = da.DormandPrince853(rtol=1e-12, atol=1e-13)


def response(make, names=("output",)) -> dict[str, np.ndarray]:
    """Outputs of a block with the input ``sin(ω t) + t`` at 201 instants."""
    system = da.System("signal")
    system.add(planar.Particle("body", mass=1.0))
    block = system.add(make(da.sin(OMEGA * da.t) + da.t))
    motion = da.solve_dynamics(system.build(), END, integrator=PRECISE, outputs=201)
    return {"t": motion.time} | {name: motion[f"{block.name}.{name}"].values for name in names}


def exact(system, times: np.ndarray) -> np.ndarray:
    """Response of a linear system of SciPy at rest, by an independent integrator."""
    a, b, c, d = (np.atleast_2d(m) for m in (system.A, system.B, system.C, system.D))

    def rate(t, x):
        return a @ x + b[:, 0] * (np.sin(OMEGA * t) + t)

    start = np.zeros(len(a))
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14, "t_eval": times}
    states = solve_ivp(rate, (0, END), start, **options).y if start.size else np.zeros((0, 201))
    u = np.sin(OMEGA * times) + times
    return (c @ states + d * u)[0]


@pytest.mark.parametrize(
    ("numerator", "denominator"),
    [
        ([3], [0.1, 1]),
        ([2, 1], [1, 0.4, 9]),
        ([1, 2, 3], [2, 1, 5]),
        ([1, -2], [1, 6, 11, 6]),
        ([1, 0, 4, 1], [1, 2, 8, 3, 2]),
        ([5], [2]),
    ],
)
def test_transfer_functions(numerator, denominator):
    out = response(lambda u: da.blocks.TransferFunction("g", u, numerator, denominator))
    if len(denominator) == 1:
        expected = 2.5 * (np.sin(OMEGA * out["t"]) + out["t"])
    else:
        expected = exact(signal.TransferFunction(numerator, denominator).to_ss(), out["t"])
    assert np.abs(out["output"] - expected).max() < 1e-9


@pytest.mark.few(3)
@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 8])
def test_low_pass_is_the_filter_of_butterworth(order):
    out = response(lambda u: da.blocks.LowPass("g", u, cutoff=12.0, order=order))
    system = signal.TransferFunction(*signal.butter(order, 12.0, analog=True)).to_ss()
    assert np.abs(out["output"] - exact(system, out["t"])).max() < 1e-8


def test_lead_lag():
    out = response(lambda u: da.blocks.LeadLag("g", u, lead=0.3, lag=0.05, gain=2.0))
    system = signal.TransferFunction([0.6, 2.0], [0.05, 1.0]).to_ss()
    assert np.abs(out["output"] - exact(system, out["t"])).max() < 1e-9


def test_state_space():
    a, b, c, d = [[0, 1], [-4, -0.5]], [[0], [1]], [[1, 2], [0, 1]], [[0.5], [0]]
    names = ("output1", "output2")
    out = response(lambda u: da.blocks.StateSpace("g", (u,), a, b, c, d), names)
    for row, name in enumerate(names):
        system = signal.StateSpace(a, b, c[row : row + 1], d[row : row + 1])
        assert np.abs(out[name] - exact(system, out["t"])).max() < 1e-9


def test_start_at_rest_with_an_input():
    """A constant input before the start leaves every block where it is."""
    system = da.System("constant")
    system.add(planar.Particle("body", mass=1.0))
    for name, block in {
        "low": da.blocks.LowPass("low", 2.0, cutoff=3.0, order=3, start=2.0),
        "lag": da.blocks.LeadLag("lag", 2.0, lead=1.0, lag=0.5, start=2.0),
        "tf": da.blocks.TransferFunction("tf", 2.0, (1, 4), (1, 3, 2), start=2.0),
        "steady": da.blocks.TransferFunction("steady", 2.0, (1, 4), (1, 3, 2), steady=True),
    }.items():
        assert system.add(block).name == name
    motion = da.solve_dynamics(system.build(), 1.0, outputs=11)
    for name, value in {"low": 2.0, "lag": 2.0, "tf": 4.0, "steady": 4.0}.items():
        assert np.abs(motion[f"{name}.output"].values - value).max() < 1e-9


@pytest.mark.few(4)
@pytest.mark.parametrize("limits", [{}, {"lower": 0.0, "upper": 40.0}])
@pytest.mark.parametrize(
    ("integrator", "tolerance"),
    [
        (da.DormandPrince853(rtol=1e-11), 2e-8),
        (da.DormandPrince(rtol=1e-10, atol=1e-12), 2e-8),
        (da.Radau(rtol=1e-9, atol=1e-11), 1e-7),
        (da.BDF(rtol=1e-9, atol=1e-11), 1e-6),
    ],
    ids=lambda value: type(value).__name__,
)
def test_pid_with_limits(integrator, tolerance, limits):
    """A controlled lift; the switches of the limits are located, so that the order is kept."""
    system = da.System("lift", gravity=(0, -10))
    cabin = system.add(planar.Particle("cabin", mass=2.0))
    system.add(planar.PinInSlot("rail", system.ground.center, cabin.center, axis=(0, 1)))
    gains = {"proportional": 80.0, "integral": 60.0, "derivative": 40.0, "filter_time": 0.01}
    options = gains | limits | {"tracking_time": 0.5, "setpoint_weight": 0.8}
    control = system.add(da.blocks.PID("control", 1.0, cabin.y, **options))
    system.add(planar.Force("drive", cabin.center, (0, control.output)))
    motion = da.solve_dynamics(system.build(), 3.0, integrator=integrator)

    def outputs(x):
        y, _, z, filtered = x
        wish = 80.0 * (0.8 - y) + z + 40.0 * (-y - filtered) / 0.01
        return wish, min(max(wish, 0.0), 40.0) if limits else wish

    def rate(t, x):
        wish, out = outputs(x)
        y, v, _, filtered = x
        return [v, out / 2 - 10, 60.0 * (1 - y) + (out - wish) / 0.5, (-y - filtered) / 0.01]

    def lower(t, x):
        return outputs(x)[0]

    def upper(t, x):
        return outputs(x)[0] - 40.0

    state, start = np.zeros(4), 0.0
    while start < 3.0:  # integrate from switch to switch
        lower.terminal = upper.terminal = bool(limits)
        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13, "events": (lower, upper)}
        part = solve_ivp(rate, (start, 3.0), state, **options)
        step = 1e-9
        state, start = part.y[:, -1], float(part.t[-1])
        if start < 3.0:
            state = state + step * np.array(rate(start, state))
            start += step
    assert motion["cabin.y"][-1].item() == pytest.approx(state[0], abs=tolerance)
    assert motion["control.integral"][-1].item() == pytest.approx(state[2], abs=10 * tolerance)


def test_proportional_control_with_limits_has_no_memory():
    """Without an integral the output depends on the present signal alone, however long limited."""
    system = da.System("weight")
    system.add(planar.Particle("body", mass=1.0))
    wave = 3 * da.sin(OMEGA * da.t)
    system.add(da.blocks.PID("c", wave, 0.0, proportional=2.0, lower=-1.0, upper=1.0, start=0.5))
    motion = da.solve_dynamics(system.build(), END, outputs=101)
    expected = np.clip(6 * np.sin(OMEGA * motion.time) + 0.5, -1, 1)
    assert np.abs(motion["c.output"].values - expected).max() < 1e-12


def test_derivative_starts_without_a_kick():
    """A resting body away from zero: the derivative part is zero at the start."""
    system = da.System("rest")
    body = system.add(planar.Particle("body", mass=1.0, position=(0.4, 0)))
    system.add(da.blocks.PID("c", 0.4, body.x, derivative=5.0, filter_time=0.01))
    motion = da.solve_dynamics(system.build(), 1.0, outputs=11)
    assert np.abs(motion["c.output"].values).max() < 1e-12


MOTOR = {"constant": 0.05, "resistance": 0.8, "inductance": 2e-3, "ratio": 20.0, "inertia": 3e-5}


def test_dc_motor_by_its_matrix():
    """Step response by the matrix exponential; inertia of the rotor counts n²-fold."""
    system = da.System("motor")
    arm = system.add(planar.Body("arm", mass=1.0, inertia=0.02))
    hinge = system.add(planar.Revolute("hinge", system.ground.center, arm.center))
    motor = planar.DCMotor("motor", hinge, voltage=12.0, damping=1e-5, **MOTOR)
    system.add(motor)
    motion = da.solve_dynamics(system.build(), 0.5, integrator=PRECISE)
    n, k = MOTOR["ratio"], MOTOR["constant"]
    inertia = 0.02 + MOTOR["inertia"] * n**2
    a = np.array(
        [
            [-MOTOR["resistance"] / MOTOR["inductance"], -k * n / MOTOR["inductance"]],
            [n * k / inertia, -1e-5 * n**2 / inertia],
        ]
    )
    b = np.array([12.0 / MOTOR["inductance"], 0.0])
    values, vectors = np.linalg.eig(a)
    rest = -np.linalg.solve(a, b)
    shares = np.linalg.solve(vectors, -rest)
    x = (vectors @ (shares * np.exp(values * 0.5))).real + rest
    assert motion["motor.current"][-1].item() == pytest.approx(x[0], rel=1e-9)
    assert motion["arm.angular_velocity"][-1].item() == pytest.approx(x[1], rel=1e-9)
    assert not motion.warnings  # the balance includes the magnetic field and the resistance
    power = motion["input_power"].values[-1]
    assert power == pytest.approx(12.0 * motion["motor.current"][-1].item(), rel=1e-9)


def test_current_control_of_a_motor():
    """A controller of the current, which is a state of the motor that it drives."""
    system = da.System("control")
    arm = system.add(planar.Body("arm", mass=1.0, inertia=0.02))
    hinge = system.add(planar.Revolute("hinge", system.ground.center, arm.center))
    motor = system.add(planar.DCMotor("motor", hinge, **MOTOR))
    gains = {"proportional": 2.0, "integral": 800.0}
    control = system.add(da.blocks.PID("control", 1.5, motor.current, **gains))
    motor.voltage = control.output
    motion = da.solve_dynamics(system.build(), 0.2)
    lag = (20.0 * 0.05) ** 2 / (0.02 + 3e-5 * 20**2) / 800.0  # of a ramp of the induced voltage
    assert motion["motor.current"][-1].item() == pytest.approx(1.5 / (1 + lag), rel=1e-7)
    torque = motion["motor.moment"][-1].item()
    assert torque == pytest.approx(20.0 * 0.05 * motion["motor.current"][-1].item(), rel=1e-12)


CYLINDER = {"area": 2e-3, "rod_side_area": 1e-3, "stroke": 0.5, "retracted_length": 1.0}


def test_hydraulic_cylinder():
    """Motion against the equations of its pressures by SciPy, and the steady speed."""
    system = da.System("press")
    ram = system.add(planar.Particle("ram", mass=50.0, position=(1.2, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, ram.center))
    numbers = {
        "rated_flow": 2e-4,
        "rated_pressure": 4e6,
        "leakage": 1e-13,
        "damping": 200.0,
        "start_a": 2e6,
        "start_b": 4e6,
    }
    ends = system.ground.center, ram.center
    opening = 0.5 * da.sin(20 * da.t)
    system.add(planar.HydraulicCylinder("c", *ends, opening=opening, **numbers, **CYLINDER))
    motion = da.solve_dynamics(system.build(), 0.3, integrator=da.DormandPrince853(rtol=1e-11))
    supply, bulk, dead, smooth = 1e7, 1.4e9, 1e-4, 1e-4 * 1e7

    def rate(t, state):
        x, v, a, b = state
        u = 0.5 * np.sin(20 * t)

        def flow(source, sink):
            drop = source - sink
            return 1e-7 * abs(u) * drop / (drop**2 + smooth**2) ** 0.25

        flow_a = flow(supply if u >= 0 else 0.0, a)
        flow_b = flow(0.0 if u >= 0 else supply, b)
        leak = 1e-13 * (a - b)
        rate_a = bulk / (dead + 2e-3 * x) * (flow_a - 2e-3 * v - leak)
        rate_b = bulk / (dead + 1e-3 * (0.5 - x)) * (flow_b + 1e-3 * v + leak)
        return [v, (2e-3 * a - 1e-3 * b - 200.0 * v) / 50.0, rate_a, rate_b]

    state, start = np.array([0.2, 0.0, 2e6, 4e6]), 0.0
    scale = np.array([1e-13, 1e-13, 1e-6, 1e-6])
    for end in (np.pi / 20, 0.3):  # the valve passes its centre
        options = {"method": "DOP853", "rtol": 1e-12, "atol": scale}
        state, start = solve_ivp(rate, (start, end), state, **options).y[:, -1], end
    assert motion["ram.x"][-1].item() - 1 == pytest.approx(state[0], abs=1e-9)
    assert motion["c.pressure_a"][-1].item() == pytest.approx(state[2], rel=1e-6)
    assert motion["c.pressure_b"][-1].item() == pytest.approx(state[3], rel=1e-6)


def test_bristle_friction_is_that_of_contacts():
    """Friction of a joint with the coefficient of a contact times its normal force."""
    normal, mu, sigma = 9.81, 0.3, 1e4

    def sledge(kind: str) -> da.Model:
        system = da.System(kind, gravity=(0, -9.81))
        start = {"velocity": (0.2, 0.0)}
        if kind == "joint":
            body = system.add(planar.Body("body", mass=1.0, inertia=1.0, **start))
            rail = system.add(planar.Prismatic("rail", system.ground.center, body.center))
            numbers = {"coulomb": mu * normal, "stiffness": sigma * normal, "damping": 20 * normal}
            system.add(planar.BristleFriction("rub", rail, **numbers))
        else:
            body = system.add(planar.Particle("body", mass=1.0, position=(0, -1e-5), **start))
            law = planar.contact.KelvinVoigt(stiffness=normal / 1e-5, damping=500.0)
            ends = planar.contact.HalfPlane(system.ground.point(0, 0)), body.center
            friction = planar.contact.LuGre(mu, stiffness=sigma, damping=20.0)
            system.add(planar.Contact("rub", *ends, law=law, friction=friction))
        return system.build()

    ends = [
        da.solve_dynamics(sledge(kind), 0.2, integrator=da.Radau(rtol=1e-9))["body.x"][-1].item()
        for kind in ("joint", "contact")
    ]
    assert ends[0] == pytest.approx(ends[1], abs=1e-8)
