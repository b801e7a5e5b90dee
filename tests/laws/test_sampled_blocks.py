"""Laws of sampled blocks: exact samples in all integrators, delay, quantisation, gradients."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

import dalembert as da
from dalembert import planar
from dalembert.errors import AnalysisError, ModelError, UnsupportedError

T, END = 0.05, 2.0
INTEGRATORS = {
    "steps that fit": {"step": 0.01},
    "steps that do not fit": {"step": 0.0073},
    "automatic": {},
    "DormandPrince": {"integrator": da.DormandPrince(rtol=1e-11, atol=1e-13)},
    "Radau": {"integrator": da.Radau()},
    "Trapezoidal": {"step": 0.01, "integrator": da.Trapezoidal()},
    "joint coordinates": {"step": 0.01, "coordinates": da.JointCoordinates()},
    "null space": {"step": 0.01, "formulation": da.NullSpace()},
}
"""The held plant has polynomials of second degree as solutions, which all of them integrate."""


def lift() -> da.Model:
    """A cabin under gravity with a sampled PID controller whose output is limited."""
    system = da.System("lift", gravity=(0, -10))
    gain = system.parameter("gain", 80.0, bounds=(40, 120))
    mass = system.parameter("mass", 2.0, "kg", bounds=(1, 4))
    cabin = system.add(planar.Particle("cabin", mass=mass))
    system.add(planar.PinInSlot("rail", system.ground.center, cabin.center, axis=(0, 1)))
    gains = {"proportional": gain, "integral": 60.0, "derivative": 40.0, "filter_time": 0.02}
    limits = {"lower": -100.0, "upper": 60.0, "tracking_time": 0.5}
    control = da.blocks.SampledPID("control", 1.0, cabin.y, sample_time=T, **gains, **limits)
    system.add(control)
    system.add(planar.Force("drive", cabin.center, (0, control.output)))
    return system.build()


def exact(gain: float = 80.0, mass: float = 2.0) -> tuple[float, float, float]:
    """Position, speed and force at the end, by the matrix exponential of the held plant."""
    matrix = np.zeros((4, 4))
    matrix[0, 1], matrix[1, 2], matrix[1, 3] = 1.0, 1 / mass, -10.0
    advance, x = expm(matrix * T), np.array([0.0, 0.0, 0.0, 1.0])
    integral = derived = previous = 0.0
    for k in range(round(END / T)):
        change = -x[0] - previous if k else 0.0
        derived = (0.02 * derived + 40 * change) / (0.02 + T)
        wish = gain * (1 - x[0]) + integral + derived
        x[2] = min(max(wish, -100.0), 60.0)
        integral += T * (60 * (1 - x[0]) + (x[2] - wish) / 0.5)
        previous = -x[0]
        x = advance @ x
    return x[0], x[1], x[2]


@pytest.mark.few(3)
@pytest.mark.parametrize("name", INTEGRATORS)
def test_sampled_controller_agrees_with_matrix_exponential(name):
    motion = da.solve_dynamics(lift(), END, **INTEGRATORS[name])
    assert motion.status.success
    values = [motion[n][-1].item() for n in ("cabin.y", "cabin.vy", "control.output")]
    assert np.allclose(values, exact(), rtol=0, atol=1e-10)


@pytest.mark.few(1)
@pytest.mark.parametrize("options", [{"step": 0.01}, {}], ids=["fixed", "adaptive"])
def test_gradients_pass_through_samples(options):
    motion = da.solve_dynamics(lift(), END, **options)
    responses = [da.Final("cabin.y"), da.Final("control.output"), da.integral("cabin.y")]
    gradient = da.sensitivity(motion, responses, certificate=True)
    certificate = gradient.attrs["certificate"]
    assert certificate.passed, certificate.table()
    gradient = gradient.values[:2]
    h = 1e-5
    for column, changes in enumerate([{"gain": 80.0}, {"mass": 2.0}]):
        ((name, value),) = changes.items()
        up, down = (exact(**{name: value + s * h}) for s in (1, -1))
        expected = [(up[k] - down[k]) / (2 * h) for k in (0, 2)]
        assert np.allclose(gradient[:, column], expected, rtol=1e-6, atol=1e-8)


def test_continued_run_samples_as_a_whole_one():
    model = lift()
    for step in ({"step": 0.01}, {}):
        motion = da.solve_dynamics(model, 0.93, **step).continued(END - 0.93)
        assert motion["cabin.y"][-1].item() == pytest.approx(exact()[0], abs=1e-10)


def moving(*blocks) -> da.Motion:
    """A particle with ``x = t`` and blocks of it."""
    system = da.System("sensors")
    body = system.add(planar.Particle("body", mass=1.0, velocity=(1.0, 0)))
    for make in blocks:
        system.add(make(system, body))
    return da.solve_dynamics(system.build(), 1.0, step=0.01)


@pytest.mark.parametrize("samples", [1, 3, 7])
def test_delay_by_samples(samples):
    motion = moving(
        lambda s, b: da.blocks.Delay("late", b.x, samples=samples, sample_time=0.1, start=-1.0)
    )
    k = np.floor(motion.time / 0.1 + 1e-9)
    k[-1] -= 1  # the sample at the end belongs to a continuation
    expected = np.where(k >= samples, 0.1 * (k - samples), -1.0)
    assert np.allclose(motion["late.output"], expected, atol=1e-12)


def test_quantizer_and_hold():
    motion = moving(
        lambda s, b: da.blocks.Quantizer("adc", b.x, resolution=0.25, upper=0.5, sample_time=0.1),
        lambda s, b: da.blocks.ZeroOrderHold("hold", b.x, sample_time=0.2, first_sample=0.1),
    )
    k = np.floor(motion.time / 0.1 + 1e-9)
    k[-1] -= 1
    quantized = np.minimum(0.25 * np.floor(0.1 * k / 0.25 + 0.5), 0.5)
    assert np.allclose(motion["adc.output"], quantized, atol=1e-12)
    held = np.where(
        motion.time < 0.1 - 1e-9, 0.0, 0.1 + 0.2 * np.floor((motion.time - 0.1) / 0.2 + 1e-9)
    )
    assert np.allclose(motion["hold.output"], held, atol=1e-12)


def test_cascade_takes_new_values_and_delays_break_cycles():
    def first(system, body):
        return da.blocks.SampledState("a", body.x + 1, sample_time=0.1)

    def second(system, body):
        return da.blocks.SampledState("b", 2 * system.elements["a"].value, sample_time=0.1)

    motion = moving(first, second)
    assert np.allclose(motion["b.value"], 2 * motion["a.value"], atol=1e-15)
    system = da.System("cycle")
    system.add(planar.Particle("body", mass=1.0))
    a = system.add(da.blocks.SampledState("a", sample_time=0.1))
    b = system.add(da.blocks.SampledState("b", a.value + 1, sample_time=0.1))
    a.next = b.value
    with pytest.raises(ModelError, match=r"a, b are sampled at the same instant.*Delay"):
        da.solve_dynamics(system.build(), 1.0, step=0.1)
    delay = system.add(da.blocks.Delay("delay", b.value, sample_time=0.1))
    a.next = delay.output
    motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    assert motion["b.value"][-1].item() == 10.0  # a[k] = b[k-1], b[k] = a[k] + 1


def test_sampled_linear_systems_agree_with_a_recurrence():
    law = {"numerator": (0.2, 0.5), "denominator": (1, -0.7, 0.1)}
    matrices = {"A": [[0, 1], [-0.1, 0.7]], "B": [[0], [1]], "C": [[0.5, 0.2]]}
    motion = moving(
        lambda s, b: da.blocks.SampledTransferFunction("g", b.x, sample_time=0.1, **law),
        lambda s, b: da.blocks.SampledStateSpace("h", (b.x,), sample_time=0.1, **matrices),
    )
    outputs = np.zeros(10)
    u = 0.1 * np.arange(10)
    for k in range(10):
        past = lambda series, n, k=k: series[k - n] if k >= n else 0.0  # noqa: E731
        outputs[k] = 0.7 * past(outputs, 1) - 0.1 * past(outputs, 2)
        outputs[k] += 0.2 * past(u, 1) + 0.5 * past(u, 2)
    for name in ("g.output", "h.output1"):
        values = motion[name].sel(time=u + 0.05, method="nearest")
        assert np.allclose(values, outputs, atol=1e-12)


@pytest.mark.parametrize("order", [1, 2, 5])
def test_transport_delay_has_the_phase_of_a_delay(order):
    """Unit gain at all frequencies, and the exact phase at low ones."""
    w, delay = 2.0, 0.3
    system = da.System("pipe")
    system.add(planar.Particle("body", mass=1.0))
    late = da.blocks.TransportDelay("late", da.sin(w * da.t), delay=delay, order=order)
    system.add(late)
    motion = da.solve_dynamics(system.build(), 20.0, outputs=np.linspace(10, 20, 500))
    basis = np.column_stack([np.sin(w * motion.time), np.cos(w * motion.time)])
    a, b = np.linalg.lstsq(basis, motion["late.output"].values, rcond=None)[0]
    assert math.hypot(a, b) == pytest.approx(1.0, abs=1e-5)
    assert math.atan2(b, a) == pytest.approx(-w * delay, abs=(w * delay) ** (2 * order + 1) / 10)


def test_samples_need_fixed_times():
    with pytest.raises(ModelError, match="no sample_time"):
        da.blocks.ZeroOrderHold("hold", 1.0)
    system = da.System("x")
    period = system.parameter("period", 0.1, "s")
    with pytest.raises(ModelError, match=r"hold.sample_time: depends on parameters"):
        da.blocks.ZeroOrderHold("hold", 1.0, sample_time=period)
    with pytest.raises(ModelError, match="steady"):
        da.blocks.ZeroOrderHold("hold", 1.0, sample_time=0.1, steady=True)


def pushed() -> da.Model:
    system = da.System("cart")
    cart = system.add(planar.Particle("cart", mass=2.0, position=(1.0, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    push = system.input("push", unit="N")
    system.add(planar.Force("drive", cart.center, (push, 0)))
    system.output("place", cart.x)
    system.output("speed", cart.vx)
    return system.build()


@pytest.mark.parametrize("options", [{"step": 0.01}, {"step": 0.007}, {}])
def test_python_controller_is_called_once_per_sample(options):
    calls = []

    def controller(t, y):
        calls.append(t)
        return {"push": -3 * y["place"] - 4 * y["speed"]}

    motion = da.solve_dynamics(pushed(), 2.0, controller=controller, sample_time=0.1, **options)
    matrix = np.zeros((3, 3))
    matrix[0, 1], matrix[1, 2] = 1.0, 0.5
    advance, x = expm(matrix * 0.1), np.array([1.0, 0.0, 0.0])
    for _ in range(20):
        x[2] = -3 * x[0] - 4 * x[1]
        x = advance @ x
    assert np.allclose(calls, 0.1 * np.arange(20), atol=1e-12)
    assert motion["place"][-1].item() == pytest.approx(x[0], abs=1e-11)
    assert motion["push"][-1].item() == pytest.approx(x[2], abs=1e-11)
    with pytest.raises(UnsupportedError, match="sampled blocks"):
        da.sensitivity(motion, da.Final("place"))


def test_errors_of_python_controllers():
    model, options = pushed(), {"step": 0.01, "sample_time": 0.1}
    with pytest.raises(AnalysisError, match="'pull'; the inputs are push"):
        da.solve_dynamics(model, 1.0, controller=lambda t, y: {"pull": 1.0}, **options)
    with pytest.raises(ZeroDivisionError):
        da.solve_dynamics(model, 1.0, controller=lambda t, y: 1 / 0, **options)
    with pytest.raises(AnalysisError, match="sample_time"):
        da.solve_dynamics(model, 1.0, step=0.01, controller=lambda t, y: 1.0)
    batch = {"push": np.zeros(3)}
    with pytest.raises(UnsupportedError, match="lanes"):
        da.solve_dynamics(model, 1.0, parameters=batch, controller=lambda t, y: 1.0, **options)


@pytest.mark.thorough
@pytest.mark.parametrize("options", [{"step": 0.01}, {}], ids=["fixed", "adaptive"])
def test_contact_feels_a_sampled_force(options):
    """A block under dry friction begins to slide at the sample at which the force exceeds it."""
    system = da.System("block", gravity=(0, -10))
    friction = planar.contact.Coulomb(system.parameter("friction", 0.55))
    block = system.add(planar.Body("block", mass=1.0, inertia=1.0, position=(0, 0)))
    floor = planar.contact.HalfPlane(system.ground.point(0, 0))
    for name, x in (("left", -1), ("right", 1)):
        shapes = planar.contact.Vertex(block.point(x, 0)), floor
        law = planar.contact.Restitution(0.0)
        system.add(planar.Contact(name, *shapes, law=law, friction=friction))
    ramp = system.add(da.blocks.SampledState("ramp", sample_time=0.1))
    ramp.next = ramp.value + 1.0  # 6 N at the sixth sample, t = 0.5 s
    system.add(planar.Force("push", block.center, (ramp.value, 0)))
    motion = da.solve_dynamics(system.build(), 1.0, **options)
    speed = slid = 0.0
    for force in (6, 7, 8, 9, 10):  # held for a tenth of a second each
        slid += 0.1 * speed + (force - 5.5) * 0.1**2 / 2
        speed += 0.1 * (force - 5.5)
    assert motion["block.x"][-1].item() == pytest.approx(slid, abs=1e-9)
    gradient = da.sensitivity(motion, da.Final("block.x"), certificate=True)
    assert gradient.attrs["certificate"].passed
    assert gradient.item() == pytest.approx(-10 * 0.5**2 / 2, rel=1e-9)
