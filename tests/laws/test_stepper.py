"""Laws of steppers: steps of runs, Jacobians, restored states, lanes; models of many kinds."""

import numpy as np
import pytest
from registry import model_of

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import AnalysisError, SolverFailure, UnsupportedError

KINDS = (
    "internal gears on an arm",
    "rotational driver Table of formulas",
    "plane frame",
    "contact",
    "cable",
    "universal",
    "spatial coupling",
)
"""Among them splines, switches, closed loops and Euler parameters."""
STRATEGIES = {
    "joint coordinates": {},
    "absolute": {"coordinates": da.AbsoluteCoordinates()},
    "implicit": {"integrator": da.Trapezoidal()},
    "memory": {"integrator": da.GeneralizedAlpha()},
    "null space": {"coordinates": da.AbsoluteCoordinates(), "formulation": da.NullSpace()},
    "virtual machine": {"backend": "vm"},
}


def cart_pole() -> da.Model:
    system = da.System("cart-pole", gravity=(0, -9.81))
    tilt = system.parameter("tilt", 1.5, "rad")
    mass = system.parameter("mass", 0.1, "kg")
    cart = system.add(planar.Body("cart", mass=1.0, inertia=0.1))
    system.add(planar.Prismatic("rail", system.ground.center, cart.center))
    pole = system.add(planar.Bar("pole", length=1.0, mass=mass, angle=tilt))
    system.add(planar.Revolute("hinge", cart.center, pole.start))
    push = system.input("push", unit="N", bounds=(-10, 10))
    system.add(planar.Force("drive", cart.center, (push, 0)))
    for name in ("cart.x", "pole.angle", "cart.vx", "pole.angular_velocity", "hinge.force"):
        system.output(name.replace(".", "_"), name)
    return system.build()


def four_bar() -> da.Model:
    """A closed loop with a torque and the state of a filter."""
    system = da.System("four-bar", gravity=(0, -9.81))
    crank = system.add(planar.Bar("crank", length=0.3, mass=1.5, angle=1.2))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=5.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    torque = system.input("torque", unit="N m")
    smooth = system.add(da.blocks.LowPass("smooth", torque, cutoff=20.0))
    system.add(planar.Torque("motor", crank, smooth.output + da.sin(3 * da.t)))
    system.output("angle", crank.angle)
    system.output("rocker", "rocker.angular_velocity")
    return system.build()


def top() -> da.Model:
    """A body with Euler parameters."""
    system = da.System("top", gravity=(0, 0, -9.81))
    rotation = da.rotation.axis_angle((1, 0, 0), 0.4)
    rotor = spatial.Body(
        "rotor", mass=1.0, inertia=(0.2, 0.2, 0.1), rotation=rotation, angular_velocity=(0, 0, 9)
    )
    system.add(rotor)
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), rotor.point(0, 0, -0.3)))
    brake = system.input("brake")
    system.add(spatial.Torque("torque", rotor, (0, brake, 1)))
    system.output("height", rotor.position[2])
    system.output("spin", "rotor.angular_velocity")
    return system.build()


MODELS = {"cart-pole": cart_pole, "four-bar": four_bar, "top": top}


@pytest.mark.few(1)
@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("name", MODELS)
def test_steps_are_those_of_a_run(name, strategy):
    model, options = MODELS[name](), dict(STRATEGIES[strategy])
    stepper = da.Stepper(model, step=0.02, substeps=2, **options)
    (u,) = model.inputs
    options = {"coordinates": stepper.plant.kernel.coordinates} | options
    motion = da.solve_dynamics(model, 1.0, step=0.01, parameters={u: 2.0}, **options)
    stepper.reset({u: 2.0})
    for k in range(1, 51):
        y = stepper.step()
        expected = np.hstack([motion[n][2 * k].values.ravel() for n in model.outputs])
        assert np.allclose(y, expected, rtol=0, atol=1e-12 * max(1, np.abs(expected).max()))
    assert stepper.time == pytest.approx(1.0)


@pytest.mark.parametrize("name", KINDS)
def test_models_of_many_kinds(name):
    model = model_of(name)
    absolute = {"coordinates": da.AbsoluteCoordinates()}
    stepper = da.Stepper(model, step=1e-3, outputs=["kinetic_energy"], backend="vm", **absolute)
    motion = da.solve_dynamics(model, 0.02, step=1e-3, backend="vm")
    for _ in range(20):
        y = stepper.step()
    assert y[0] == pytest.approx(motion["kinetic_energy"][-1].item(), rel=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("strategy", ["joint coordinates", "absolute", "implicit"])
@pytest.mark.parametrize("name", MODELS)
def test_jacobians_against_differences(name, strategy):
    """Changes of independent entries, made consistent by the joints."""
    stepper = da.Stepper(MODELS[name](), step=0.02, **STRATEGIES[strategy])
    for k in range(10):
        stepper.step(np.sin(k))
    jacobians, plant = stepper.jacobians(0.5), stepper.plant
    t, x, state = stepper.time, stepper.state, stepper.save()
    entries, h = plant.entries, 1e-6
    basis, variant = entries.basis(t, x, state.parameters), plant.kernel.variants[state.mode]
    correction = variant.problem.correction or variant.problem.upkeep

    def after(dx, u=0.5):
        moved = x + dx
        if correction is not None and np.any(dx):
            moved = correction.function(t, moved, state.parameters).full().ravel()
            moved += basis @ (x[entries.free] + dx[entries.free] - moved[entries.free])
            moved = correction.function(t, moved, state.parameters).full().ravel()
        change = moved[entries.free] - x[entries.free]
        copy = da.StepperState(state.count, state.start, moved, state.parameters, state.mode)
        stepper.restore(copy)
        y = stepper.step(u)
        return np.append(stepper.state[entries.free], y), change

    n = len(jacobians.state_names)
    whole = np.vstack([jacobians.state, jacobians.output_state])
    for column in basis.T:
        up, forth = after(h * column)
        down, back = after(-h * column)
        size = np.maximum(1, np.abs(whole).max())
        assert np.allclose(
            (up - down) / (2 * h), whole @ (forth - back) / (2 * h), atol=2e-7 * size
        )
    both = (after(0 * x, 0.5 + h)[0] - after(0 * x, 0.5 - h)[0]) / (2 * h)
    direct = np.vstack([jacobians.input, jacobians.output_input])[:, 0]
    assert np.allclose(both, direct, atol=1e-7 * max(1, np.abs(direct).max()))
    rng = np.random.default_rng(1)
    w, v = rng.normal(size=n), rng.normal(size=len(jacobians.output_names))
    state_product, input_product = jacobians.adjoint(w, v)
    expected = jacobians.state.T @ w + jacobians.output_state.T @ v
    assert np.allclose(state_product, expected, rtol=1e-9, atol=1e-10)
    expected = jacobians.input.T @ w + jacobians.output_input.T @ v
    assert np.allclose(input_product, expected, rtol=1e-9, atol=1e-10)


@pytest.mark.few(2)
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_restored_steps_are_identical(strategy):
    stepper = da.Stepper(four_bar(), step=0.01, **STRATEGIES[strategy])
    for _ in range(5):
        stepper.step(1.0)
    state = stepper.save()
    first = [stepper.step(np.cos(k)) for k in range(20)]
    stepper.reset()
    stepper.restore(state)
    assert np.array_equal(first, [stepper.step(np.cos(k)) for k in range(20)])


def test_reset_takes_parameters_and_entries():
    stepper = da.Stepper(cart_pole(), step=0.01)
    y = stepper.reset({"tilt": 1.2}, initial={"rate of hinge.angle": 0.5})
    assert np.allclose(y[[1, 3]], [1.2, 0.5], atol=1e-12)
    with pytest.raises(AnalysisError, match=r"hinge\.angle"):
        stepper.reset(initial={"hinge.angel": 0.5})
    absolute = da.Stepper(cart_pole(), step=0.01, coordinates=da.AbsoluteCoordinates())
    with pytest.raises(AnalysisError, match=r"contradicts the joints"):
        absolute.reset(initial={"cart.y": 0.5})


def test_parameters_of_a_stepper_last():
    model = cart_pole()
    stepper = da.Stepper(model, step=0.01, parameters={"tilt": 1.3, "mass": 0.3})
    first = stepper.step(1.0)
    stepper.reset({"tilt": 1.4})
    assert np.array_equal(stepper.reset()[1:2], [1.3])
    assert np.array_equal(stepper.step(1.0), first)
    lanes = stepper.lanes(9, {"tilt": np.linspace(1.2, 1.4, 9)})
    lanes.reset([2, 3], parameters={"mass": 0.2})
    assert np.allclose(lanes.outputs[:, 1], np.linspace(1.2, 1.4, 9), atol=1e-12)
    assert np.allclose(lanes.step([1.0])[4], first, atol=1e-12)


def test_lanes_are_steppers():
    model, rng = four_bar(), np.random.default_rng(2)
    stepper = da.Stepper(model, step=0.01, substeps=2)
    lanes, u = stepper.lanes(21, workers=2), rng.normal(size=(12, 21, 1))
    y = np.array([lanes.step(row) for row in u[:6]])
    y = np.concatenate([y, lanes.rollout(u[6:])])
    assert not lanes.failed.any()
    for lane in (0, 7, 20):
        stepper.reset()
        single = np.array([stepper.step(row[lane]) for row in u])
        assert np.allclose(single, y[:, lane], rtol=0, atol=1e-13)
    lanes.reset([3, 20])
    assert np.array_equal(lanes.outputs[3], stepper.reset())
    assert lanes.time[[0, 3, 20]].tolist() == pytest.approx([0.12, 0, 0])


def test_lanes_have_their_own_parameters():
    model = cart_pole()
    stepper, tilts = da.Stepper(model, step=0.01), np.linspace(1.2, 1.8, 11)
    lanes = stepper.lanes(11, {"tilt": tilts, "mass": 0.2})
    for _ in range(10):
        y = lanes.step([1.0])
    for lane in (0, 5, 10):
        stepper.reset({"tilt": tilts[lane], "mass": 0.2})
        for _ in range(10):
            single = stepper.step(1.0)
        assert np.allclose(single, y[lane], rtol=0, atol=1e-12)


@pytest.mark.thorough
def test_samples_of_blocks_are_between_substeps():
    system = da.System("cart")
    cart = system.add(planar.Particle("cart", mass=2.0, position=(1.0, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    gains = {"proportional": 3.0, "derivative": 4.0}
    slow = da.blocks.SampledPID("slow", 0.0, cart.x, sample_time=0.06, **gains)
    system.add(slow)
    system.add(planar.Force("drive", cart.center, (slow.output, 0)))
    model = system.build()
    stepper = da.Stepper(model, step=0.04, substeps=2, outputs=["cart.x", "slow.output"])
    motion = da.solve_dynamics(model, 2.0, step=0.02)
    for k in range(1, 50):
        y = stepper.step()
        held = motion["slow.output"][2 * k - 1].item()  # a sample at the end is in the next step
        assert np.allclose(y, [motion["cart.x"][2 * k].item(), held], atol=1e-12)
    with pytest.raises(AnalysisError, match=r"slow is sampled every 0\.06 s"):
        da.Stepper(model, step=0.05)


def test_failures_are_raised_and_the_state_remains():
    system = da.System("runaway")
    body = system.add(planar.Particle("body", mass=1.0, position=(1.0, 0)))
    system.add(planar.Force("push", body.center, (body.x**9, 0)))
    stepper = da.Stepper(system.build(), step=0.5, outputs=["body.x"])
    while abs(stepper.state[0]) < 1e30:
        stepper.step()
    before = stepper.save()
    with pytest.raises(SolverFailure, match=r"the step from t = .* failed: the state would not be"):
        stepper.step()
    assert np.array_equal(stepper.state, before.x)
    lanes = stepper.lanes(3)
    for _ in range(20):
        lanes.step()
    assert lanes.failed.all()


def test_models_that_cannot_be_stepped():
    with pytest.raises(UnsupportedError, match="chooses its own steps"):
        da.Stepper(cart_pole(), step=0.01, integrator=da.DormandPrince())
    system = da.System("ball", gravity=(0, -10))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 1)))
    law = planar.contact.Restitution(0.5)
    vertex, floor = (
        planar.contact.Vertex(ball.center),
        planar.contact.HalfPlane(system.ground.point(0, 0)),
    )
    system.add(planar.Contact("floor", vertex, floor, law=law))
    with pytest.raises(UnsupportedError, match=r"floor is a rigid contact"):
        da.Stepper(system.build(), step=0.01)
    with pytest.raises(AnalysisError, match="push"):
        da.Stepper(cart_pole(), step=0.01, inputs=["pusch"])
