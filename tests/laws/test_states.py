"""Laws of states of first order: every method integrates them alike, with exact gradients."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

INTEGRATORS = {
    "automatic": ({}, 1e-9),
    "RK4": ({"step": 1e-3}, 1e-9),
    "DormandPrince": ({"integrator": da.DormandPrince()}, 1e-7),
    "Radau": ({"integrator": da.Radau()}, 1e-8),
    "BDF": ({"integrator": da.BDF()}, 1e-6),
    "CVODES": ({"integrator": da.CVODES()}, 1e-7),
    "IDA": ({"integrator": da.IDA()}, 1e-7),
    "Trapezoidal": ({"step": 1e-3, "integrator": da.Trapezoidal()}, 1e-5),
    "GeneralizedAlpha": ({"step": 1e-3, "integrator": da.GeneralizedAlpha()}, 1e-5),
    "HHT": ({"step": 1e-3, "integrator": da.HHT()}, 1e-5),
    "Newmark": ({"step": 1e-3, "integrator": da.Newmark()}, 1e-5),
}
FORMULATIONS = [
    da.KKT(),
    da.NullSpace(),
    da.RangeSpace(),
    da.AugmentedLagrangian(),
    da.VelocityPartitioning(),
    da.DAE(),
]
END = 3.0


def oscillator(size: float = 1.0) -> da.Model:
    """A spring–mass system and two states of a size that depend on it and on each other."""
    system = da.System("oscillator")
    k = system.parameter("k", 4.0, bounds=(1, 9))
    gain = system.parameter("gain", 2.0)
    body = system.add(planar.Particle("body", mass=1.0, position=(1.0, 0)))
    x = system.add(da.blocks.State("x", start=size * gain / 2))
    z = system.add(da.blocks.State("z", rate=-gain * x.value))
    x.rate = gain * z.value - 0.1 * x.value + size * body.x
    system.add(planar.Force("spring", body.center, (-k * body.x + 0.3 / size * z.value, 0)))
    return system.build()


def reference(k: float, gain: float) -> np.ndarray:
    """``x``, speed and states at the end by an independent integrator."""

    def rate(t, u):
        x, v, a, b = u
        return [v, -k * x + 0.3 * b, gain * b - 0.1 * a + x, -gain * a]

    start = [1.0, 0.0, gain / 2, 0.0]
    return solve_ivp(rate, (0, END), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]


def ends(motion) -> np.ndarray:
    names = "body.x", "body.vx", "x.value", "z.value"
    return np.array([motion[name][-1].item() for name in names])


@pytest.mark.few(5)
@pytest.mark.parametrize("name", INTEGRATORS)
def test_integrators_agree(name):
    options, tolerance = INTEGRATORS[name]
    motion = da.solve_dynamics(oscillator(), END, **options)
    assert motion.status.success
    assert np.allclose(ends(motion), reference(4.0, 2.0), rtol=0, atol=tolerance)


@pytest.mark.few(5)
@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e6])
@pytest.mark.parametrize("name", ["automatic", "DormandPrince", "BDF"])
def test_units_of_states_do_not_matter(name, size):
    options, tolerance = INTEGRATORS[name]
    computed = ends(da.solve_dynamics(oscillator(size), END, **options)) / [1, 1, size, size]
    assert np.allclose(computed, reference(4.0, 2.0), rtol=0, atol=3 * tolerance)


def arm() -> da.Model:
    """A double pendulum whose first angle is controlled."""
    system = da.System("arm", gravity=(0, -9.81))
    target = system.parameter("target", 0.5)
    mass = system.parameter("mass", 1.0, "kg")
    upper = system.add(planar.Bar("upper", length=1.0, mass=mass, angle=0.3))
    lower = system.add(planar.Bar("lower", length=0.7, mass=0.5, angle=0.1))
    system.add(planar.Revolute("shoulder", system.ground.center, upper.start))
    system.add(planar.Revolute("elbow", upper.end, lower.start))
    gains = {"proportional": 60.0, "integral": 30.0, "derivative": 8.0, "filter_time": 0.02}
    control = system.add(da.blocks.PID("control", target, upper.angle, **gains))
    system.add(planar.Torque("drive", upper, control.output))
    return system.build()


ARM = "upper.angle", "lower.angle", "control.integral", "control.filtered"


@pytest.mark.few(1)
@pytest.mark.parametrize("formulation", FORMULATIONS, ids=lambda f: type(f).__name__)
def test_formulations_agree(formulation):
    model = arm()
    motions = [da.solve_dynamics(model, 1.0, formulation=f) for f in (da.KKT(), formulation)]
    one, other = ([motion[name][-1].item() for name in ARM] for motion in motions)
    assert np.allclose(one, other, rtol=0, atol=1e-7)


def test_joint_coordinates_agree():
    model = arm()
    one, other = (
        da.solve_dynamics(model, 1.0, coordinates=c)
        for c in (da.AbsoluteCoordinates(), da.JointCoordinates())
    )
    for name in ARM:
        assert one[name][-1].item() == pytest.approx(other[name][-1].item(), abs=1e-8)


@pytest.mark.parametrize("method", [da.Direct(), da.Adjoint()])
def test_gradients_are_those_of_the_reference(method):
    motion = da.solve_dynamics(oscillator(), END)
    finals = [da.Final(name) for name in ("body.x", "x.value", "z.value")]
    gradient = da.sensitivity(motion, finals, method=method).values
    h, rows = 1e-4, [0, 2, 3]
    for column, (k, gain) in enumerate([(h, 0), (0, h)]):
        change = reference(4 + k, 2 + gain) - reference(4 - k, 2 - gain)
        assert np.allclose(gradient[:, column], change[rows] / (2 * h), rtol=1e-6, atol=1e-7)


def test_equilibrium_includes_states():
    """The integral holds the weight; the equilibrium is where a long motion ends."""
    model = arm()
    rest = da.solve_equilibrium(model)
    assert rest.status.success
    assert rest["upper.angle"].item() == pytest.approx(0.5, abs=1e-10)
    weight = (1.0 * 0.5 + 0.5 * 1.0) * 9.81 * np.cos(0.5)
    assert rest["control.integral"].item() == pytest.approx(weight, rel=1e-9)
    gradients = [
        da.sensitivity(rest, da.Final("control.integral"), method=m).values
        for m in (da.Direct(), da.Adjoint())
    ]
    expected = [-9.81 * np.sin(0.5), 0.5 * 9.81 * np.cos(0.5)]  # by target and mass
    for gradient in gradients:
        assert np.allclose(gradient, [expected], rtol=1e-8)


def levitation(gain: float) -> da.Model:
    """A ball below a magnet with resistance and inductance."""
    system = da.System("levitation", gravity=(0, -9.81))
    ball = system.add(planar.Particle("ball", mass=0.5, position=(0, -0.01)))
    system.add(planar.PinInSlot("rail", system.ground.center, ball.center, axis=(0, 1)))
    current = system.add(da.blocks.State("current", start=2.2, unit="A"))
    gap = -ball.y
    pull = 1e-4 * current.value**2 / gap**2
    system.add(planar.Force("magnet", ball.center, (0, pull)))
    control = gain * (gap - 0.01) - 0.05 * gain * ball.vy
    current.rate = (2.2 + control - current.value) / 0.01
    return system.build()


def test_stability_of_an_equilibrium_counts_states():
    held = da.solve_equilibrium(levitation(2000.0))
    assert held.statistics["stable"] and not held.warnings
    loose = da.solve_equilibrium(levitation(0.0))
    assert loose.status.success and not loose.statistics["stable"]
    assert any("grow" in warning for warning in loose.warnings)


def test_linearization_has_the_poles_of_states():
    system = da.System("lag")
    system.add(planar.Particle("body", mass=1.0))
    x = system.add(da.blocks.State("x"))
    y = system.add(da.blocks.State("y", rate=-3 * x.value))
    x.rate = -2 * x.value + y.value
    values = da.linearize(system.build(), equilibrium=False).eigenvalues
    expected = -1 + 1j * np.sqrt(2)  # root of s² + 2 s + 3; of a pair, one is listed
    assert np.abs(values - expected).min() < 1e-12


def test_steady_states_begin_at_rest():
    system = da.System("steady")
    gain = system.parameter("gain", 3.0)
    body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    x = system.add(da.blocks.State("x", steady=True))
    x.rate = gain * body.x - x.value**3 - x.value
    y = system.add(da.blocks.State("y", start=2 * gain))
    y.rate = x.value - y.value
    model = system.build()
    motion = da.solve_dynamics(model, 1.0)
    start = motion["x.value"][0].item()
    assert start**3 + start == pytest.approx(1.5, abs=1e-12)
    assert motion["x.value"][-1].item() == pytest.approx(start, abs=1e-9)
    gradient = da.sensitivity(motion, [da.Final("x.value"), da.Final("y.value")]).values
    slope = 0.5 / (3 * start**2 + 1)
    decay = np.exp(-1.0)
    expected = [slope, slope * (1 - decay) + 2 * decay]
    assert np.allclose(gradient[:, 0], expected, rtol=1e-8)
    designs = da.solve_dynamics(model, 1.0, parameters={"gain": [1.0, 3.0]})
    assert designs["y.value"].values[1, -1] == pytest.approx(motion["y.value"][-1].item(), 1e-12)


def test_batches_are_single_runs():
    model, values = oscillator(), [2.0, 4.0, 7.0]
    batch = da.solve_dynamics(model, 1.0, parameters={"k": values}, step=1e-2)
    single = [da.solve_dynamics(model, 1.0, parameters={"k": k}, step=1e-2) for k in values]
    for row, motion in zip(batch["z.value"].values, single, strict=True):
        assert np.array_equal(row, motion["z.value"].values)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: da.blocks.LowPass("f", cutoff=1.0), "has no input"),
        (lambda: da.blocks.State("x"), "has no rate"),
        (lambda: da.blocks.PID("c", 1.0), "has no measured"),
    ],
)
def test_missing_inputs_are_named(make, message):
    system = da.System("missing")
    system.add(planar.Particle("body", mass=1.0))
    system.add(make())
    with pytest.raises(da.ModelError, match=message):
        system.build()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: da.blocks.LowPass("f", 1.0, order=0), "order is 0"),
        (lambda: da.blocks.TransferFunction("f", 1.0, (1, 2, 3), (1, 2)), "above that of the"),
        (lambda: da.blocks.TransferFunction("f", 1.0, (1,), (0, 2)), "first coefficient is 0"),
        (lambda: da.blocks.StateSpace("f", (), [[1, 2]], [[1]], [[1]]), "fits the others"),
        (lambda: da.blocks.StateSpace("f", (), [[1], [1, 2]], [[1]], [[1]]), "different lengths"),
    ],
)
def test_impossible_blocks_are_refused(make, message):
    with pytest.raises(da.ModelError, match=message):
        make()
