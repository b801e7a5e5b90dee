"""Derivatives of steps of a stepper by parameters: differences, and gradients of whole runs."""

from __future__ import annotations

import itertools

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

STRATEGIES = {
    "joint coordinates": {},
    "absolute": {"coordinates": da.AbsoluteCoordinates()},
    "implicit": {"integrator": da.Trapezoidal()},
    "memory": {"integrator": da.GeneralizedAlpha()},
    "null space": {"coordinates": da.AbsoluteCoordinates(), "formulation": da.NullSpace()},
    "virtual machine": {"backend": "vm"},
}


def four_bar() -> da.Model:
    """A closed loop whose lengths and ground points are parameters, with the state of a filter."""
    system = da.System("four-bar", gravity=(0, -9.81))
    length = system.parameter("length", 0.3, "m")
    mass = system.parameter("mass", 5.0, "kg")
    base = system.parameter("base", 1.0, "m")
    cutoff = system.parameter("cutoff", 20.0, "rad/s")
    crank = system.add(planar.Bar("crank", length=length, mass=1.5, angle=1.2))
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=mass))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(base, 0), rocker.start))
    torque = system.input("torque", unit="N m")
    smooth = system.add(da.blocks.LowPass("smooth", torque, cutoff=cutoff))
    system.add(planar.Torque("motor", crank, smooth.output + da.sin(3 * da.t)))
    system.output("angle", crank.angle)
    system.output("rocker", "rocker.angular_velocity")
    system.output("reaction", "O1.force")
    return system.build()


def top() -> da.Model:
    """Euler parameters, whose start depends on the tilt."""
    system = da.System("top", gravity=(0, 0, -9.81))
    tilt, spin = system.parameter("tilt", 0.4, "rad"), system.parameter("spin", 9.0, "rad/s")
    axial, arm = system.parameter("axial", 0.1, "kg m^2"), system.parameter("arm", 0.3, "m")
    rotation = da.rotation.axis_angle((1, 0, 0), tilt)
    rotor = spatial.Body(
        "rotor",
        mass=1.0,
        inertia=(0.2, 0.2, axial),
        rotation=rotation,
        angular_velocity=(0, 0, spin),
    )
    system.add(rotor)
    system.add(spatial.Spherical("O", system.ground.point(0, 0, 0), rotor.point(0, 0, -arm)))
    brake = system.input("torque")
    system.add(spatial.Torque("brake", rotor, (0, brake, 1)))
    system.output("height", rotor.position[2])
    system.output("turning", "rotor.angular_velocity")
    return system.build()


def sampled() -> da.Model:
    """A pendulum under a controller of two rates; its substeps have different samples."""
    system = da.System("sampled", gravity=(0, -9.81))
    length = system.parameter("length", 1.0, "m")
    gain, pole = system.parameter("gain", 30.0), system.parameter("pole", 0.5)
    system.parameter("unused", 1.0)
    rod = system.add(planar.Bar("rod", length=length, mass=1.0, angle=0.4))
    system.add(planar.Revolute("pin", system.ground.center, rod.start))
    push, b = system.input("torque", unit="N m"), da.blocks
    law = {"numerator": (1 - pole,), "denominator": (1, -pole)}
    smooth = b.SampledTransferFunction("smooth", rod.angle, sample_time=0.01, **law)
    late = system.add(b.Delay("late", system.add(smooth).output, sample_time=0.01))
    gains = {"proportional": gain, "integral": 9.0, "derivative": 2.0}
    timing = {"sample_time": 0.02, "first_sample": 0.01}
    pid = system.add(b.SampledPID("pid", 0.2, late.output, **gains, **timing))
    system.add(planar.Torque("motor", rod, pid.output + push))
    system.output("angle", rod.angle)
    system.output("speed", rod.angular_velocity)
    return system.build()


MODELS = {"four-bar": four_bar, "top": top, "sampled": sampled}


def closed(plant: da.Stepper, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray:
    """The state with dependent entries that satisfy joints at these parameters, by Newton."""
    entries = plant.plant.entries
    if not entries.dependent:
        return x
    e = entries.e
    levels = ca.vertcat(
        e.constraints[list(e.holds), :], e.manifold.bounds, ca.densify(e.velocity_constraints)
    )
    symbols = ca.vertcat(e.y, e.v)
    slopes = ca.jacobian(levels, symbols[entries.dependent])
    function = ca.Function("levels", [e.t, symbols, e.p], [ca.densify(levels), ca.densify(slopes)])
    x = x.copy()
    for _ in range(6):
        open_, matrix = (part.full() for part in function(t, x[: symbols.numel()], p))
        x[entries.dependent] -= np.linalg.solve(matrix, open_).ravel()
    return x


@pytest.mark.few(1)
@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("name", MODELS)
def test_derivatives_by_parameters_are_limits_of_differences(name, strategy):
    """Errors of central differences fall by four when the change is halved, to 1e-8."""
    plant = da.Stepper(MODELS[name](), step=0.02, substeps=2, **STRATEGIES[strategy])
    for k in range(6):
        plant.step(np.sin(k))
    jacobians, state = plant.jacobians(0.5), plant.save()
    names, free = list(plant.model.parameters), plant.plant.entries.free
    whole = np.vstack([jacobians.parameter, jacobians.output_parameter])
    assert jacobians.parameter_names == [n for n in names if n != "torque"]

    def after(parameter: str, change: float) -> np.ndarray:
        p = state.parameters.copy()
        p[names.index(parameter)] += change
        x = closed(plant, plant.time, state.x, p)
        plant.restore(da.StepperState(state.count, state.start, x, p, state.mode))
        y = plant.step(0.5)
        result = np.append(plant.state[free], y)
        plant.restore(state)
        return result

    for column, parameter in zip(whole.T, jacobians.parameter_names, strict=True):
        size = abs(state.parameters[names.index(parameter)])
        errors, quotients = [], []
        for h in (2e-2 * size, 1e-2 * size, 5e-3 * size):
            quotients.append((after(parameter, h) - after(parameter, -h)) / (2 * h))
            errors.append(np.abs(quotients[-1] - column).max())
        largest = max(1.0, np.abs(column).max())
        if errors[0] > 1e-7 * largest:
            assert 3.5 < errors[0] / errors[1] < 4.6 and 3.5 < errors[1] / errors[2] < 4.6
        first, second = ((4 * b - a) / 3 for a, b in itertools.pairwise(quotients))
        extrapolated = (16 * second - first) / 15
        np.testing.assert_allclose(extrapolated, column, rtol=0, atol=2e-8 * largest)


@pytest.mark.few(1)
@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("name", MODELS)
def test_steps_accumulate_to_gradients_of_the_run(name, strategy):
    """``S⁺ = A S + E`` forwards, and its transpose backwards, are the gradients of a run."""
    options = dict(STRATEGIES[strategy])
    plant = da.Stepper(MODELS[name](), step=0.02, substeps=2, **options)
    model, steps = plant.model, 10
    plant.reset({"torque": 0.7})
    measures = list(model.outputs.values())
    tangent, rows, matrices = plant.start_jacobian(), [], []
    for _ in range(steps):
        jacobians = plant.jacobians()
        matrices.append(jacobians)
        rows.append(jacobians.output_state @ tangent + jacobians.output_parameter)
        tangent = jacobians.state @ tangent + jacobians.parameter
        plant.step()
    options = {"coordinates": plant.plant.kernel.coordinates} | options
    motion = da.solve_dynamics(
        model, 0.02 * steps, step=0.01, parameters={"torque": 0.7}, **options
    )
    responses = [
        da.final(part)
        for m in measures
        for part in ([m] if len(m) == 1 else [m[k] for k in range(len(m))])
    ]
    forward = rows[-1]
    backward = []
    for k in range(len(responses)):
        weight, total = np.zeros(len(tangent)), np.zeros(tangent.shape[1])
        for index, jacobians in enumerate(reversed(matrices)):
            output = np.eye(len(responses))[k] if index == 0 else None
            weight, _, by_parameters = jacobians.parameter_adjoint(weight, output)
            total += by_parameters
        backward.append(total + plant.start_jacobian().T @ weight)
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(motion, responses, method=method)
        expected = gradient.sel(parameter=jacobians.parameter_names).values
        size = np.maximum(1.0, np.abs(expected).max(axis=1, keepdims=True))
        assert (np.abs(forward - expected) / size).max() < 1e-10
        assert (np.abs(np.array(backward) - expected) / size).max() < 1e-10


def test_products_are_those_of_the_matrices():
    plant = da.Stepper(four_bar(), step=0.02)
    plant.step(1.0)
    jacobians, rng = plant.jacobians(), np.random.default_rng(2)
    w, v = rng.normal(size=len(jacobians.state_names)), rng.normal(size=len(jacobians.output_names))
    by_state, by_input, by_parameter = jacobians.parameter_adjoint(w, v)
    pairs = [
        (by_state, jacobians.state.T @ w + jacobians.output_state.T @ v),
        (by_input, jacobians.input.T @ w + jacobians.output_input.T @ v),
        (by_parameter, jacobians.parameter.T @ w + jacobians.output_parameter.T @ v),
    ]
    for computed, expected in pairs:
        np.testing.assert_allclose(computed, expected, rtol=1e-9, atol=1e-10)
