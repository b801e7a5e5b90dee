"""Use of steppers and lanes: wrong inputs, failures, copies, threads, independence of lanes."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from laws.test_stepper import cart_pole, four_bar, top

import dalembert as da
from dalembert import planar
from dalembert.errors import AnalysisError, SolverFailure, UnsupportedError
from dalembert.symbolic.formulas.functions import maximum


def two_inputs(**options) -> da.Stepper:
    """A mass under the larger of two forces: limits hide values that are not finite."""
    system = da.System("mass")
    mass = system.add(planar.Particle("mass", mass=1.0))
    system.add(planar.PinInSlot("rail", system.ground.center, mass.center))
    low, high = system.input("low"), system.input("high")
    system.add(planar.Force("drive", mass.center, (maximum(low, high), 0)))
    system.output("x", mass.x)
    system.output("inverse", 1 / (mass.x - 1))
    return da.Stepper(system.build(), step=0.1, **options)


@pytest.mark.parametrize(
    "inputs", [1.0, [1.0], [1.0, 2.0, 3.0], [[1.0, 2.0]], "1", {"low": 1.0, "high": 1.0}, 1j]
)
def test_wrong_inputs_are_refused(inputs):
    plant = two_inputs()
    y, state = plant.step([0.0, 1.0]), plant.state
    with pytest.raises(
        AnalysisError, match=r"inputs are .*; give 2 numbers, in the order low, hig"
    ):
        plant.step(inputs)
    with pytest.raises(AnalysisError, match="give 2 numbers"):
        plant.jacobians(inputs)
    assert np.array_equal(plant.state, state) and np.array_equal(plant.outputs, y)


@pytest.mark.few(2)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("backend", ["jit", "vm"])
def test_infinite_inputs_are_refused_and_the_last_ones_remain(value, backend):
    plant, other = two_inputs(backend=backend), two_inputs(backend=backend)
    for stepper in (plant, other):
        stepper.step([0.0, 1.0])
    with pytest.raises(AnalysisError, match=rf"input low is {value}; give a finite number"):
        plant.step([value, 1.0])
    assert np.array_equal(plant.step(), other.step())
    lanes = plant.lanes(10)
    u = np.ones((10, 2))
    u[3, 0] = value
    lanes.step(u)
    assert np.flatnonzero(lanes.failed).tolist() == [3]


def test_jacobians_leave_the_inputs():
    plant, other = two_inputs(), two_inputs()
    for stepper in (plant, other):
        stepper.step([0.0, 1.0])
    plant.jacobians([5.0, 6.0])
    assert np.array_equal(plant.step(), other.step())


def test_an_infinite_output_is_named():
    plant = two_inputs()
    plant.reset(initial={"rail.displacement": 0.5})
    with pytest.raises(SolverFailure, match=r"from t = 0 s failed: the output inverse would be"):
        plant.step([0.0, 100.0])  # reaches 1 m


def test_newton_failure_keeps_the_stepper():
    """A spring of the power nine has no implicit solution at a step of a hundred seconds."""
    system = da.System("spring")
    mass = system.add(planar.Particle("mass", mass=1.0, position=(1.0, 0)))
    push = system.input("push")
    system.add(planar.Force("spring", mass.center, (-da.exp(30 * mass.x) * push, 0)))
    plant = da.Stepper(system.build(), step=1.0, outputs=["mass.x"], integrator=da.Trapezoidal())
    state = plant.state
    with pytest.raises(SolverFailure, match=r"the step from t = 0 s failed: "):
        plant.step(-1e30)
    assert np.array_equal(plant.state, state)
    assert plant.step(0.0)[0] == pytest.approx(1.0)


def test_wrong_arguments():
    model = cart_pole()
    plant = da.Stepper(model, step=0.01)
    for value, text in (
        ({"substeps": 1.5}, "substeps is 1.5; give a whole number"),
        ({"inputs": "push"}, r"inputs is 'push'; give a list of names"),
        ({"inputs": ["push", "push"]}, "give each name once"),
    ):
        with pytest.raises(AnalysisError, match=text):
            da.Stepper(model, step=0.01, **value)
    with pytest.raises(AnalysisError, match="time is nan"):
        plant.reset(time=np.nan)
    with pytest.raises(AnalysisError, match=r"hinge\.angle is nan"):
        plant.reset(initial={"hinge.angle": np.nan})
    with pytest.raises(AnalysisError, match="restore takes a StepperState"):
        plant.restore(plant.state)
    with pytest.raises(AnalysisError, match="restore states of the same model"):
        plant.restore(da.Stepper(four_bar(), step=0.01).save())
    with pytest.raises(AnalysisError, match="give a motion of the same model"):
        plant.reset(motion=da.solve_dynamics(four_bar(), 0.1, step=0.01))
    assert np.all(np.isfinite(plant.step(1.0)))


def test_wrong_arguments_of_lanes():
    plant = da.Stepper(cart_pole(), step=0.01)
    lanes = plant.lanes(9)
    for shape in ((), (9,), (5, 1), (9, 2), (20, 1)):
        with pytest.raises(AnalysisError, match=r"give an array of shape \(9, 1\), or \(1,\)"):
            lanes.step(np.zeros(shape))
    for shape in ((3,), (3, 5, 1), (3, 9)):
        with pytest.raises(AnalysisError, match=r"shape \(steps, 9, 1\), or \(steps, 1,\)"):
            lanes.rollout(np.zeros(shape))
    for chosen in ([-1], [9], [0.5], [[1, 2]]):
        with pytest.raises(AnalysisError, match="give numbers from 0 to 8, or a mask"):
            lanes.reset(chosen)
    with pytest.raises(AnalysisError, match=r"give one of shape \(9,\)"):
        lanes.reset(np.array([True, False]))
    with pytest.raises(AnalysisError, match=r"tilt has the shape \(4,\)"):
        plant.lanes(9, {"tilt": np.ones(4)})
    with pytest.raises(AnalysisError, match=r"array of shape \(2,\), of one for each"):
        lanes.reset([1, 2], parameters={"tilt": np.ones(9)})
    with pytest.raises(AnalysisError, match="workers is 0"):
        plant.lanes(9, workers=0)
    with pytest.raises(AnalysisError, match=r"give \(9, 6\)"):
        lanes.states = np.zeros((9, 4))
    with pytest.raises(UnsupportedError, match="not copied"):
        copy.copy(lanes)
    assert not lanes.failed.any() and lanes.time.max() == 0


def test_starts_of_sampled_blocks_are_at_substeps():
    system = da.System("sensor")
    body = system.add(planar.Particle("body", mass=1.0, velocity=(1.0, 0)))
    system.add(da.blocks.ZeroOrderHold("hold", body.x, sample_time=0.04))
    plant = da.Stepper(system.build(), step=0.02, outputs=["hold.output"])
    with pytest.raises(AnalysisError, match="no multiple of the substep"):
        plant.reset(time=0.03)
    plant.reset(time=0.02)  # samples at 0.04 and 0.08 s
    assert np.allclose([plant.step()[0] for _ in range(4)], [0, 0.02, 0.02, 0.06])


def test_copies_are_independent():
    plant = da.Stepper(four_bar(), step=0.01)
    plant.step(1.0)
    for other in (copy.copy(plant), copy.deepcopy(plant)):
        state = plant.save()
        first = [other.step(2.0) for _ in range(5)]
        assert np.array_equal(plant.state, state.x) and plant.time == pytest.approx(0.01)
        assert np.array_equal(first, [plant.step(2.0) for _ in range(5)])
        plant.restore(state)
    with pytest.raises(UnsupportedError, match=r"send its save\(\)"):
        pickle.dumps(plant)


def test_states_are_restored_from_files_and_in_other_steppers():
    plant = da.Stepper(four_bar(), step=0.01)
    plant.step(1.0)
    state = pickle.loads(pickle.dumps(plant.save()))
    other = da.Stepper(four_bar(), step=0.01)
    other.restore(state)
    assert np.array_equal(other.step(2.0), plant.step(2.0))


def test_steppers_in_threads():
    plants = [da.Stepper(top(), step=0.002) for _ in range(3)]

    def run(plant):
        return np.array([plant.step(np.sin(0.1 * k)) for k in range(300)])

    expected = run(plants[0])
    plants[0].reset()
    with ThreadPoolExecutor(3) as pool:
        for result in pool.map(run, plants):
            assert np.array_equal(result, expected)


@pytest.mark.few(1)
@pytest.mark.parametrize("make", [cart_pole, four_bar, top])
def test_lanes_do_not_depend_on_their_number_or_threads(make):
    plant, u = da.Stepper(make(), step=0.01), np.random.default_rng(4).normal(size=(20, 40, 1))
    whole = plant.lanes(40, workers=1).rollout(u)
    assert np.array_equal(whole, plant.lanes(40, workers=3).rollout(u))
    assert np.array_equal(whole[:, 5:18], plant.lanes(13).rollout(u[:, 5:18]))
    lanes = plant.lanes(40)
    assert np.array_equal(whole, [lanes.step(row) for row in u])


def test_a_failing_lane_leaves_others():
    plant, u = da.Stepper(cart_pole(), step=0.01), np.zeros((10, 20, 1))
    expected = plant.lanes(20).rollout(u)
    u[3, 6] = np.nan
    lanes = plant.lanes(20)
    y = lanes.rollout(u)
    others = np.arange(20) != 6
    assert np.array_equal(y[:, others], expected[:, others])
    assert lanes.failed.tolist() == (~others).tolist()
    lanes.reset([6])
    assert not lanes.failed.any()
    assert np.array_equal(lanes.rollout(np.zeros((10, 20, 1)))[:, 6], expected[:, 6])


@pytest.mark.parametrize("make", [cart_pole, four_bar])
def test_state_space_has_the_jacobians_of_a_step(make):
    plant = da.Stepper(make(), step=0.01, substeps=2)
    for _ in range(5):
        plant.step(1.0)
    jacobians, space, h = plant.jacobians(0.5), plant.state_space(0.5), 1e-6
    assert np.array_equal(space.A, jacobians.state) and np.array_equal(space.B, jacobians.input)
    state, rng = plant.save(), np.random.default_rng(3)
    entries = plant.plant.entries
    basis = entries.basis(plant.time, plant.state, state.parameters)
    direction = rng.normal(size=len(space.states))
    changes = []
    for sign in (1, -1):
        p = state.parameters.copy()
        p[plant.plant.inputs] = 0.5
        moved = state.x + sign * h * basis @ direction
        plant.restore(da.StepperState(state.count, state.start, moved, p, state.mode))
        changes.append(plant.outputs)
    difference = (changes[0] - changes[1]) / (2 * h)
    assert np.allclose(difference, space.C @ direction, rtol=1e-6, atol=1e-6)
