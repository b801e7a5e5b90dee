"""Laws of frequency responses, over the registry of elements and the structures of the tests."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from mode_models import carts
from registry import PLANAR, SPATIAL, model_of
from structure_models import MASSIVE, model_of as structure_of

import dalembert as da
from dalembert import planar, structures
from dalembert.analysis.frequency.moving_points import refuse_moving_points
from dalembert.errors import AnalysisError, SingularityError, UnknownNameError, UnsupportedError
from dalembert.formulations.base import dynamic_equations

OMEGA = 2 * np.pi * 0.37
STEP = 3e-6
MIXED = 2e-4


def usable(model: da.Model) -> list[str]:
    """Parameters that move no points of dampers."""
    names = []
    for name in model.parameters:
        try:
            refuse_moving_points(model, [name])
        except UnsupportedError:
            continue
        names.append(name)
    return names


def rotations(model: da.Model, y: np.ndarray) -> np.ndarray:
    """(n, n) body axes by inertial axes, for the rotations of spatial bodies."""
    e, names = model.equations, model.guesses.speed_names
    matrix = np.eye(e.speed_count)
    for body in model.bodies:
        if hasattr(body, "spin") and body.rotates:
            first = names.index(f"{body.name}.{body.speed_names[3]}")
            axes = ca.Function("axes", [e.y], [body.axes])(y).full()
            matrix[first : first + 3, first : first + 3] = axes.T
    return matrix


def by_differences(system, output) -> np.ndarray:
    """Output per input, from central differences of the nonlinear equations."""
    point = system.point
    e = point.kernel.e
    arguments = [e.t, e.y, e.v, e.a, e.multiplier, e.p]
    level = ca.densify(e.constraints) + ca.densify(e.nonholonomic)
    rows = [ca.densify(e.pose_rate), dynamic_equations(e), level]
    rows.append(ca.densify(e.without_dropped(output.sx)))
    function = ca.Function("residual", arguments, rows)
    states, n = list(e.states), e.speed_count
    rate = np.array(function(point.time, point.y, point.v, point.a, point.multiplier, point.p)[0])

    def inertial(share: float) -> np.ndarray:
        """Displacements in the coordinates of the model by those in inertial axes, on the path."""
        return rotations(point.model, point.y + share * rate.ravel())

    turned, turning = inertial(0.0), (inertial(1e-5) - inertial(-1e-5)) / 2e-5
    reading = turned.T @ ca.Function("reading", [e.y], [e.manifold.reading])(point.y).full()
    reading = np.vstack([reading, np.eye(e.coordinate_count)[states]])
    parts = [np.zeros(n + len(states)), point.v, point.a, point.multiplier, point.p]

    def placed(shift: np.ndarray, share: float) -> np.ndarray:
        """Position displaced from the path, after a time."""
        y = point.y + share * rate.ravel()
        y = np.array(e.manifold.go(y, inertial(share) @ shift[:n]), dtype=float).ravel()
        y[states] += shift[n:]
        return y

    def carried(k: int) -> np.ndarray:
        """Rate of a fixed displacement from the path, by mixed differences."""
        unit, h = np.eye(n + len(states))[k] * MIXED, MIXED
        ahead, behind = placed(unit, h) - placed(-unit, h), placed(unit, -h) - placed(-unit, -h)
        return reading @ (ahead - behind) / (4 * h * h)

    def residual(part: int, k: int, step: float) -> np.ndarray:
        moved = [column.copy() for column in parts]
        moved[part][k] += step
        if part in (1, 2):  # in inertial axes; rates have accelerations of the turning axes
            moved[part] = parts[part] + step * turned[:, k]
        if part == 1:
            moved[2] = parts[2] + step * turning[:, k]
        values = function(point.time, placed(moved[0], 0.0), *moved[1:])
        change, *rest = (np.array(value).ravel() for value in values)
        return np.concatenate([reading @ change, *rest])

    def columns(part: int) -> np.ndarray:
        sides = [
            [residual(part, k, sign * STEP) for k in range(parts[part].size)] for sign in (1, -1)
        ]
        size = residual(0, 0, 0.0).size
        slopes = (np.array(sides[0]) - np.array(sides[1])) / (2 * STEP)
        return slopes.reshape(-1, size).T

    place, speed, acceleration, force, parameter = map(columns, range(5))
    place = place.astype(complex)
    rows_of_rates = slice(0, n + len(states))
    place[rows_of_rates] -= np.array([carried(k) for k in range(n + len(states))]).T
    place[rows_of_rates] -= 1j * OMEGA * np.eye(n + len(states))
    matrix = np.hstack([place, speed + 1j * OMEGA * acceleration, force])
    inputs = parameter @ system.directions
    motion = np.linalg.solve(matrix[:-1], -inputs[:-1])
    return matrix[-1] @ motion + inputs[-1]


@pytest.mark.few(7)
@pytest.mark.parametrize("name", [*PLANAR, *SPATIAL])
def test_response_of_the_nonlinear_equations(name: str) -> None:
    model = model_of(name)
    outputs = ["kinetic_energy", "potential_energy"]
    response = da.frequency_response(
        model,
        [OMEGA / (2 * np.pi)],
        inputs=usable(model),
        outputs=outputs,
        equilibrium=False,
    )
    for output in outputs:
        values = response.complex_values(output)[0]
        expected = by_differences(response.record, response.outputs[output])
        size = max(np.abs(expected).max(), 1e-3)
        np.testing.assert_allclose(values, expected, rtol=0, atol=1e-6 * size)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", [*PLANAR[::5], *SPATIAL[::6]])
def test_gradients_over_the_registry(name: str) -> None:
    """Direct = adjoint = differences, with every number a parameter."""
    model = model_of(name)
    every = dict.fromkeys(usable(model), 1.0)
    response = da.frequency_response(
        model, [0.37], excitation=every, outputs=["kinetic_energy"], equilibrium=False
    )
    gradients = [
        da.sensitivity(response, da.at(0.37, "kinetic_energy.real"), method=method).values
        for method in ("direct", "adjoint", "finite-difference")
    ]
    size = np.abs(gradients[0]).max()
    np.testing.assert_allclose(gradients[1], gradients[0], rtol=0, atol=1e-9 * size)
    np.testing.assert_allclose(gradients[2], gradients[0], rtol=0, atol=2e-5 * size + 1e-9)


def driven(kind: str) -> da.Model:
    """A pendulum on a cart, with inputs at a force, a torque and a driver."""
    system = da.System("driven", gravity=(0, -9.81))
    names = {"torque": "N m", "push": "N", "road": "m"}
    inputs = {name: system.input(name, unit=unit) for name, unit in names.items()}
    length = system.parameter("length", 0.8, "m", bounds=(0.2, 2))
    stiffness = system.parameter("stiffness", 20.0, "N/m", bounds=(5, 80))
    cart = system.add(planar.Particle("cart", mass=1.0))
    system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    if kind == "driver":
        system.add(planar.CoordinateDriver("drive", cart.center, inputs["road"]))
    else:
        held = {"stiffness": 50.0, "damping": 1.0, "free_length": 1.0}
        system.add(planar.Spring("held", system.ground.point(-1, 0), cart.center, **held))
    bar = system.add(planar.Bar("bar", length=length, mass=1.5, angle=-0.9))
    system.add(planar.Revolute("pin", cart.center, bar.start))
    system.add(planar.Torque("turn", bar, 1.0 + inputs["torque"]))
    system.add(planar.Force("force", cart.center, (inputs["push"], 0)))
    spring = {"stiffness": stiffness, "damping": 0.3, "free_length": 0.5}
    system.add(planar.Spring("spring", system.ground.point(1, 0), bar.end, **spring))
    system.output("turn", "bar.angle", unit="rad")
    return system.build()


RESPONSES = (
    da.at(1.1, "turn.torque.amplitude"),
    da.at(0.7, "bar.angle.torque.phase"),
    da.at(2.0, "pin.force.y.push.amplitude*length"),
    da.maximum("cart.x.push.amplitude"),
    da.peak(1, "pin.force.x.torque.amplitude"),
)


@pytest.mark.thorough
@pytest.mark.parametrize("response", RESPONSES, ids=lambda r: r.label)
def test_gradients_at_an_equilibrium_that_moves(response) -> None:
    result = da.frequency_response(driven("free"))
    certificate = da.sensitivity(result, response, certificate=True).attrs["certificate"]
    assert certificate.passed, f"{certificate}\n{certificate.table()}"
    assert float(certificate.data["disagreement"].max()) <= 1e-9


@pytest.mark.thorough
def test_gradients_with_inputs_in_constraints() -> None:
    result = da.frequency_response(driven("driver"))
    for measure in ("drive.effort.road.amplitude", "turn.road.phase", "bar.ay.road.imag"):
        rows = [
            da.sensitivity(result, da.at(1.3, measure), method=method).values
            for method in ("direct", "adjoint", "finite-difference")
        ]
        size = np.abs(rows[0]).max()
        np.testing.assert_allclose(rows[1], rows[0], rtol=0, atol=1e-12 * size)
        np.testing.assert_allclose(rows[2], rows[0], rtol=0, atol=1e-6 * size)


def test_all_modes_are_the_direct_solution() -> None:
    model = driven("free")
    inputs, outputs = ["torque", "push"], ["turn", "cart.ax", "pin.force.x", "spring.force"]
    direct = da.frequency_response(model, inputs=inputs, outputs=outputs)
    modal = da.frequency_response(
        model, direct.frequencies, inputs=inputs, outputs=outputs, method="modal"
    )
    for name in outputs:
        size = np.abs(direct.complex_values(name)).max()
        difference = np.abs(modal.complex_values(name) - direct.complex_values(name)).max()
        assert difference < 1e-10 * size
    low = direct.frequencies[:5] / 20
    truncated, exact = (
        da.frequency_response(model, low, inputs=inputs, outputs=["turn"], **options)
        for options in ({"method": "modal", "count": 1}, {})
    )
    np.testing.assert_allclose(truncated.table, exact.table, rtol=3e-3)  # static correction


def test_reciprocity() -> None:
    """The displacement under one force by another is symmetric without rotation."""
    for model, force in ((driven("free"), ("torque", "push")),):
        h = da.frequency_response(model, inputs=list(force), outputs=["turn", "cart.x"])
        np.testing.assert_allclose(h.table[:, 0, 1], h.table[:, 1, 0], rtol=1e-9)


def test_state_space_is_the_frequency_response() -> None:
    model = driven("free")
    inputs, outputs = ["torque", "push"], ["turn", "cart.vx", "bar.ay", "pin.force.y"]
    space = da.linearize(model).state_space(inputs, outputs)
    assert space.A.shape == (4, 4) and space.units["cart.vx"] == "m/s"
    response = da.frequency_response(model, inputs=inputs, outputs=outputs)
    values = space.at(response.frequencies).values
    size = np.abs(response.table).max(axis=0)
    assert np.all(np.abs(values - response.table) < 1e-11 * size)
    np.testing.assert_allclose(
        np.sort(np.abs(space.poles))[::2], np.abs(da.linearize(model).eigenvalues), rtol=1e-10
    )


def test_modes_without_control_and_observation() -> None:
    """Antisymmetric mode of two equal carts, driven and observed symmetrically."""
    system = da.System("pair")
    push = system.input("push", unit="N")
    bodies = []
    for k in range(2):
        body = system.add(planar.Particle(f"m{k}", mass=1.0, position=(0.5 * (k + 1), 0)))
        system.add(planar.PinInSlot(f"r{k}", system.ground.center, body.center))
        system.add(planar.Force(f"f{k}", body.center, (push, 0)))
        ends = system.ground.point(1.5 * k, 0), body.center
        system.add(planar.Spring(f"s{k}", *ends, stiffness=100.0, free_length=0.5))
        bodies.append(body)
    ends = [body.center for body in bodies]
    system.add(planar.Spring("between", *ends, stiffness=40.0, free_length=0.5))
    space = da.linearize(system.build()).state_space(outputs=["m0.x + m1.x", "m0.x - m1.x"])
    controllability, observability = space.controllability.values, space.observability.values
    assert controllability[0, 0] > 0.1 and controllability[1, 0] < 1e-12
    assert observability[0, 1] < 1e-12 < 0.1 < observability[1, 1]


def test_excitation_is_the_sum_of_inputs() -> None:
    model = driven("driver")
    single = da.frequency_response(model, [0.8, 1.4], inputs=["torque", "road"], outputs=["turn"])
    amplitudes = {"torque": 2.0, "road": [0.1, 1.0]}
    total = da.frequency_response(model, [0.8, 1.4], excitation=amplitudes, outputs=["turn"])
    expected = single.complex_values("turn") @ [2.0, 0.1 * np.exp(1j)]
    np.testing.assert_allclose(total["turn"].values, expected, rtol=1e-12)


@pytest.mark.few(2)
@pytest.mark.parametrize("name", MASSIVE)
def test_structures_by_modes_and_reciprocity(name: str) -> None:
    model = structure_of(name)
    case = next(iter(model.loads))
    degree = next(
        degree for k, degree in enumerate(model.degrees.names) if k in model.assembly.free
    )
    options = {"inputs": [case], "outputs": [degree], "loss_factor": 0.05}
    modes = da.solve_modes(model.linearized, 3)
    frequencies = modes.frequencies[0] * np.array([0.3, 0.97, 1.8])
    direct = da.frequency_response(model, frequencies, **options)
    count = model.assembly.free.size
    modal = da.frequency_response(model, frequencies, method="modal", count=count, **options)
    size = np.abs(direct.table).max()
    np.testing.assert_allclose(modal.table, direct.table, rtol=0, atol=1e-7 * size)
    response = da.at(frequencies[1], f"{degree}.amplitude")
    rows = [
        da.sensitivity(direct, response, method=method).values for method in ("direct", "adjoint")
    ]
    np.testing.assert_allclose(rows[1], rows[0], rtol=1e-9, atol=1e-12 * np.abs(rows[0]).max())


def cable() -> da.StructuralModel:
    """A wire stiffened by its tension."""
    cable = da.Structure("cable")
    tension = cable.parameter("tension", 400.0, "N", bounds=(50, 900))
    push = cable.input("push", unit="N")
    nodes = [cable.node(f"n{k}", 0.5 * k, 0) for k in range(5)]
    for k in range(4):
        bar = {"area": 1e-5, "second_moment": 1e-9, "modulus": 2e11, "density": 7850.0}
        cable.add(structures.Frame(f"e{k}", nodes[k], nodes[k + 1], **bar))
    cable.support(nodes[0], ux=0, uy=0)
    cable.support(nodes[4], uy=0)
    cable.load(nodes[4], case="pull", fx=tension)
    cable.load(nodes[1], case="shake", fy=push)
    return cable.build()


@pytest.mark.parametrize("nonlinear", [False, True])
def test_structures_about_a_loaded_state(nonlinear: bool) -> None:
    """The first resonance is that of the stiffened wire; gradients include the statics."""
    model = cable()
    loaded = da.solve_statics(model, nonlinear=nonlinear) if nonlinear else da.solve_statics(model)
    loaded = loaded.at([loaded.case("pull")])
    options = {"inputs": ["push"], "outputs": ["n2.uy"], "about": loaded, "loss_factor": 0.01}
    frequency = da.solve_modes(model, 1, about=loaded).frequencies[0]
    response = da.frequency_response(
        model, frequency * np.array([0.5, 0.999, 1.0, 1.001]), **options
    )
    (place, _), *_ = response.peaks("n2.uy")
    assert place == pytest.approx(frequency, rel=1e-3)
    rows = [
        da.sensitivity(response, da.at(0.5 * frequency, "n2.uy.amplitude"), method=method).values
        for method in ("direct", "adjoint", "finite-difference")
    ]
    size = np.abs(rows[0]).max()
    assert size > 0
    np.testing.assert_allclose(rows[1], rows[0], rtol=0, atol=1e-9 * size)
    np.testing.assert_allclose(rows[2], rows[0], rtol=0, atol=1e-5 * size)


@pytest.mark.thorough
def test_random_gradients_by_quadrature() -> None:
    table = {"frequency": [0.3, 1.0, 4.0], "density": [1e-3, 1e-2, 2e-3]}
    analysis = da.RandomResponse(
        psd={"torque": "1/(1 + f**2)", "road": table}, outputs=["turn"], band=(0.2, 6.0)
    )
    result = analysis.run(driven("driver"))
    for measure in ("turn", "drive.effort", "bar.ax"):
        rows = [
            da.sensitivity(result, da.random_rms(measure), method=method).values
            for method in ("direct", "adjoint", "finite-difference")
        ]
        size = np.abs(rows[0]).max()
        np.testing.assert_allclose(rows[1], rows[0], rtol=0, atol=1e-12 * size)
        np.testing.assert_allclose(rows[2], rows[0], rtol=0, atol=1e-6 * size)


@pytest.mark.parametrize("damping", [1e-5, 1e-3, 0.05, 0.4])
def test_default_frequencies_resolve_the_peaks(damping: float) -> None:
    """The largest sample is within a percent of the peak, whatever the damping."""
    system = da.System("oscillator")
    push = system.input("push", unit="N")
    body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    spring = {"stiffness": 1.0, "damping": 2 * damping, "free_length": 0.5}
    system.add(planar.Spring("spring", system.ground.center, body.center, **spring))
    system.add(planar.Force("force", body.center, (push, 0)))
    response = da.frequency_response(system.build(), outputs=["body.x"])
    peak = da.evaluate(response, da.maximum("body.x.amplitude"))
    assert peak == pytest.approx(1 / (2 * damping * np.sqrt(1 - damping**2)), rel=1e-9)
    assert response.values("body.x.amplitude").max() > 0.99 * peak


WRONG = [
    ({"inputs": ["pusch"]}, AnalysisError, "did you mean 'push'"),
    ({"outputs": ["cart.xx"]}, UnknownNameError, "cart.x"),
    ({"outputs": ["cart.position"]}, AnalysisError, "2 components"),
    ({"frequencies": [-1.0]}, AnalysisError, "≥ 0"),
    ({"span": (3, 1)}, AnalysisError, "(first, last)"),
    ({"method": "modl"}, UnsupportedError, "did you mean 'modal'"),
    ({"count": 3}, AnalysisError, "method='modal'"),
    ({"excitation": {"pusch": 1}}, AnalysisError, "'push'"),
    ({"excitation": {"push": "a"}}, AnalysisError, "[amplitude, phase"),
    ({"damping_ratio": 0.1}, AnalysisError, "modal"),
    ({"loss_factor": 0.1}, UnsupportedError, "for structures"),
    ({"about": 3}, AnalysisError, "give an equilibrium"),
]


@pytest.mark.parametrize(("options", "error", "text"), WRONG)
def test_errors_name_place_and_remedy(options, error, text) -> None:
    with pytest.raises(error) as raised:
        da.frequency_response(driven("free"), **({"outputs": ["turn"]} | options))
    assert text in str(raised.value)


def test_missing_inputs_and_outputs() -> None:
    model = carts()
    with pytest.raises(AnalysisError, match=r"no inputs; declare them by system\.input"):
        da.frequency_response(model, outputs=["time"])
    with pytest.raises(AnalysisError, match=r"no outputs; declare them by system\.output"):
        da.frequency_response(model, inputs=list(model.parameters)[:1] or ["x"])


def undamped() -> da.Model:
    system = da.System("undamped")
    push = system.input("push", unit="N")
    free = system.input("pull", unit="N")
    for name, force in (("held", push), ("loose", free)):
        body = system.add(planar.Particle(name, mass=1.0, position=(0.5, 0)))
        system.add(planar.PinInSlot(f"rail_{name}", system.ground.center, body.center))
        system.add(planar.Force(f"on_{name}", body.center, (force, 0)))
        if name == "held":
            ends = system.ground.center, body.center
            system.add(planar.Spring("spring", *ends, stiffness=100.0, free_length=0.5))
    return system.build()


def test_resonance_and_free_motion_are_named() -> None:
    model, resonance = undamped(), 10 / (2 * np.pi)
    held = {"inputs": ["push"], "outputs": ["held.x"], "equilibrium": False}
    with pytest.raises(SingularityError, match=r"undamped motion of held\.x.* resonates"):
        da.frequency_response(model, [1.0, resonance], **held)
    loose = {"inputs": ["pull"], "outputs": ["loose.x"], "equilibrium": False}
    with pytest.raises(SingularityError, match=r"no static response: a motion of loose\.x"):
        da.frequency_response(model, [0.0], **loose)


def test_unstable_operating_points_warn() -> None:
    system = da.System("inverted", gravity=(0, -9.81))
    push = system.input("push", unit="N m")
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=np.pi / 2))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    system.add(planar.Torque("turn", bar, push))
    response = da.frequency_response(system.build(), [1.0], outputs=["bar.angle"])
    assert any("unstable" in text for text in response.warnings)


@pytest.mark.parametrize("damping", [0.0, 5.0])
def test_moving_points_of_dampers_are_refused(damping: float) -> None:
    system = da.System("suspended")
    road = system.input("road", unit="m")
    body = system.add(planar.Particle("body", mass=1.0, position=(0, 0.5)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center, axis=(0, 1)))
    numbers = {"stiffness": 100.0, "damping": damping, "free_length": 0.5}
    system.add(planar.Spring("strut", system.ground.point(0, road), body.center, **numbers))
    model = system.build()
    if damping:
        with pytest.raises(UnsupportedError, match="road moves a point of strut"):
            da.frequency_response(model, [1.0], outputs=["body.y"])
        return
    response = da.frequency_response(model, [1.0], outputs=["body.y"])
    expected = 100 / (100 - (2 * np.pi) ** 2)
    np.testing.assert_allclose(response["body.y"].values, expected, rtol=1e-12)


def test_inputs_in_constraints_have_no_state_space() -> None:
    modes = da.linearize(driven("driver"))
    with pytest.raises(UnsupportedError, match=r"road moves constraints.*frequency_response"):
        modes.state_space(["road"], ["turn"])
    with pytest.raises(UnsupportedError, match="method='direct'"):
        da.frequency_response(modes.model, inputs=["road"], outputs=["turn"], method="modal")


def test_results_are_saved_and_read(tmp_path) -> None:
    response = da.frequency_response(driven("free"), [0.5, 1.0], outputs=["turn"])
    data = da.load_results(response.save(tmp_path / "response.nc"))
    np.testing.assert_allclose(data["real"].values, response.table.real)
    rows = response.to_csv(tmp_path / "response.csv").read_text().splitlines()
    assert rows[0].startswith("frequency [Hz],turn.torque.amplitude [rad]") and len(rows) == 3
