"""Tables as functions: values, derivatives, ranges, and one and the same run by every backend."""

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import dalembert as da
from dalembert import planar
from dalembert.io.analyses import make_analysis
from dalembert.io.model_file import load_model_file
from dalembert.symbolic.evaluation.backends import BACKENDS
from dalembert.symbolic.evaluation.columns import VirtualColumns, instructions
from dalembert.symbolic.evaluation.lanes import LaneColumns
from dalembert.symbolic.native.llvm import SHORT

RNG = np.random.default_rng(5)
X = np.sort(RNG.uniform(0.0, 1.0, 12))
Y = np.sin(5 * X)
BETWEEN = np.linspace(X[0], X[-1], 41)


@pytest.mark.few(1)
@pytest.mark.parametrize("ends", [None, "not-a-knot", "clamped", "natural", "periodic"])
def test_the_spline_is_that_of_scipy_and_the_line_the_straight_one(ends):
    y = Y if ends != "periodic" else np.r_[Y[:-1], Y[0]]
    spline, line = (
        CubicSpline(X, y, bc_type=ends or "not-a-knot"),
        da.Interpolation(X, y, kind="linear"),
    )
    table = da.Interpolation(X, y, **({"ends": ends} if ends else {}))
    for x in BETWEEN:
        assert float(table(x)) == pytest.approx(spline(x), abs=1e-13)
        assert float(line(x)) == pytest.approx(np.interp(x, X, y), abs=1e-14)


def test_the_second_derivative_holds_up_to_the_ends():
    """A cubic is reproduced by few rows and by many, at both ends themselves, too."""
    x = ca.SX.sym("x")
    for rows in (4, 7, 40):
        knots = np.linspace(0.2, 1.7, rows)
        for law in (
            da.Interpolation(knots, knots**3)(da.Expression(x)).sx,
            da.Table(list(knots), list(knots**3)).value(x),
            da.Interpolation(knots, knots**3, outside="clamp")(da.Expression(x)).sx,
        ):
            bend = ca.Function("bend", [x], [ca.gradient(ca.gradient(law, x), x)])
            for place in (0.2, 0.9, 1.7):
                assert float(bend(place)) == pytest.approx(6 * place, rel=1e-9)


def robot_arm(law, duration=2.0):
    """Torque at the start of an arm whose angle follows a law, by inverse dynamics."""
    system = da.System("arm", gravity=(0.0, -9.81))
    arm = system.add(planar.Bar("arm", length=1.0, mass=3.0))
    system.add(planar.Revolute("O", system.ground.center, arm.start))
    system.add(planar.RotationalDriver("motor", system.ground, arm, law))
    model = system.build()
    run = da.solve_inverse_dynamics(model, duration, outputs=21)
    return run.values("motor.effort"), [text for _, text in model.diagnosis.messages]


def test_inverse_dynamics_of_a_sampled_motion():
    """Torque ``I q̈ + m g (l/2) cos q`` at both ends and between, or a warning that says why not."""
    times = np.linspace(0, 2, 41)
    q, bend = 0.5 * np.cos(2 * times) + times**2, 2 - 2 * np.cos(2 * times)
    exact = (bend + 3 * 9.81 * 0.5 * np.cos(q))[::2]
    for law in (da.Table(list(times), list(q)), da.Interpolation(times, q)(da.t)):
        effort, warnings = robot_arm(law)
        np.testing.assert_allclose(effort, exact, atol=2e-2)
        assert not warnings
    rough = [
        (da.Table(list(times), list(q), ends="natural"), "natural ends"),
        (2 * da.Interpolation(times, q / 2, ends="natural")(da.t), "natural ends"),
        (da.Table(list(times), list(q - times), ends="clamped"), "clamped ends"),
        (da.Table(list(times[::5]), list(q[::5])), "uncertain by"),
    ]
    for law, message in rough:
        effort, warnings = robot_arm(law)
        assert len(warnings) == 1 and message in warnings[0], message


@pytest.mark.parametrize("kind", ["spline", "linear"])
def test_beyond_the_ends(kind):
    slope = CubicSpline(X, Y)(X[-1], 1)
    if kind == "linear":
        slope = (Y[-1] - Y[-2]) / (X[-1] - X[-2])
    beyond = X[-1] + 0.25
    assert np.isnan(float(da.Interpolation(X, Y, kind)(beyond).sx))
    assert float(da.Interpolation(X, Y, kind, "clamp")(beyond)) == pytest.approx(Y[-1])
    straight = Y[-1] + 0.25 * slope
    assert float(da.Interpolation(X, Y, kind, "extrapolate")(beyond)) == pytest.approx(straight)
    for x in (X[0], X[-1]):  # the ends themselves are inside
        assert np.isfinite(float(da.Interpolation(X, Y, kind)(x)))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"x": [0, 1]}, "table gas: 2 abscissae but 3 values"),
        ({"x": [0, 2, 1]}, "abscissae must increase, but row 3"),
        ({"x": [0, 1, "b"]}, "row 3: expected a number"),
        ({"x": [0, 1, float("nan")]}, "not a finite number"),
        ({"kind": "cubic"}, "unknown kind 'cubic'"),
        ({"ends": "natral"}, "unknown ends 'natral' .did you mean 'natural'"),
        ({"outside": "clmp"}, "unknown outside 'clmp' .did you mean 'clamp'"),
        ({"units": ("mmm", "")}, "unknown unit 'mmm'"),
        ({"x": range(2000), "y": range(2000)}, "has 2000 rows; thin it out"),
    ],
)
def test_invalid_tables_are_refused(arguments, message):
    with pytest.raises(da.ModelError, match=message):
        da.Interpolation(**{"x": [0, 1, 2], "y": [1, 2, 3], "name": "gas", **arguments})


def pendulum(rows=30, kind="spline", outside="error", top=4.0, angle=0.5, constant=False):
    """A pendulum under a torque by a table of its angle, the last of whose numbers may be given."""
    system = da.System("x", gravity=(0.0, -9.81))
    size, level = system.parameter("size", 2.0), system.parameter("level", 0.3)
    bob = system.add(planar.Bar("bob", length=0.5, mass=1.0, angle=angle))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bob.start))
    x = np.linspace(-top, top, rows)
    values = [*np.sin(3 * x[:-1]), 0.3 if constant else level]
    torque = system.table("torque", x, values, kind=kind, outside=outside)
    system.add(planar.Torque("M", bob, size * torque(bob.angle)))
    return system.build()


def evaluated(table, at, order=0):
    """Derivatives of a table by its argument at many places."""
    x = ca.SX.sym("x")
    value = table(da.Expression(x)).sx
    for _ in range(order):
        value = ca.jacobian(value, x)
    return np.array(ca.Function("y", [x], [value])(at.reshape(1, -1))).ravel()


@pytest.mark.parametrize("rows", [17, 100, 1000])
def test_rows_that_are_looked_up_are_those_written_out(rows):
    x = np.arange(rows) + RNG.uniform(0.0, 0.5, rows)
    y = np.sin(x)
    at = np.concatenate([RNG.uniform(x[0], x[-1], 500), (x[:-1] + x[1:]) / 2])
    spline, line = CubicSpline(x, y), da.Interpolation(x, y, kind="linear")
    for order in range(3):
        computed = evaluated(da.Interpolation(x, y), at, order)
        assert computed == pytest.approx(spline(at, order), abs=1e-13)
    assert evaluated(da.Interpolation(x, y), x) == pytest.approx(y, abs=1e-14)
    assert evaluated(line, at) == pytest.approx(np.interp(at, x, y), abs=1e-14)


def test_many_rows_cost_a_formula_no_more_than_few():
    x, angle = np.linspace(0, 1, 1000), ca.SX.sym("angle")

    def operations(rows):
        value = da.Interpolation(x[:rows], x[:rows] ** 2)(da.Expression(angle)).sx
        both = [value, ca.jacobian(value, angle)]
        return ca.Function("y", [angle], both, {"cse": True}).n_instructions()

    assert operations(17) < 90 and operations(1000) < 90


@pytest.mark.thorough
def test_look_ups_among_many_operations_are_compiled():
    """In text of several pieces, for numbers and for lanes."""
    x = np.linspace(0, 1, 50)
    curve, begin, size = (
        da.Interpolation(x, np.cos(3 * x), outside="clamp"),
        ca.SX.sym("a"),
        ca.SX.sym("b"),
    )
    value = begin
    for _ in range(20):
        value = curve(da.Expression(value)).sx
        for _ in range(120):
            value = (value + size) / (2 + value)
    function = ca.Function("many", [begin, size], [value])
    assert instructions(function) > SHORT
    begins, sizes = RNG.uniform(0, 1, (5, 1, 8)), RNG.uniform(0.5, 1, (5, 1, 8))
    usual = [VirtualColumns(function)(8, a, b) for a, b in zip(begins, sizes, strict=True)]
    code = BACKENDS["jit"]()._compile(function, False, ())
    lanes = LaneColumns(function)
    assert code.compiled
    side_by_side = lanes(8, begins, sizes)
    assert lanes.side_by_side is not None
    for k, (a, b) in enumerate(zip(begins, sizes, strict=True)):
        for own, one, row in zip(usual[k], code(8, a, b), side_by_side, strict=True):
            assert np.array_equal(own, one)
            assert row[k] == pytest.approx(own, rel=1e-9, abs=1e-12)


def test_absurd_numbers_are_not_looked_up():
    x = np.arange(30.0)
    absurd = evaluated(da.Interpolation(1e-40 * x, 1e80 * x**2), 1e-40 * (x + 0.5))
    usual = CubicSpline(x, x**2)(3.5)
    assert absurd[3] == pytest.approx(1e80 * usual, rel=1e-12)


@pytest.mark.parametrize("kind", ["spline", "linear"])
def test_gradients_are_those_of_the_run(kind):
    model = pendulum(kind=kind)
    motion = da.solve_dynamics(model, 0.3, step=0.01)
    final = da.final("bob.angle")
    results = {
        method: da.sensitivity(motion, final, method=method).values.ravel()
        for method in ("adjoint", "direct", "finite-difference")
    }
    assert results["adjoint"] == pytest.approx(results["direct"], rel=1e-9, abs=1e-15)
    assert results["adjoint"] == pytest.approx(results["finite-difference"], rel=1e-5, abs=1e-9)
    assert np.abs(results["adjoint"][0]) > 1e-3


@pytest.mark.parametrize("integrator", [da.RK4(), da.Radau()])
def test_large_tables_have_an_adjoint_too(integrator):
    model = pendulum(rows=301, constant=True)
    motion = da.solve_dynamics(model, 0.1, step=0.01, integrator=integrator)
    adjoint = da.sensitivity(motion, da.final("bob.angle"), method="adjoint")
    direct = da.sensitivity(motion, da.final("bob.angle"), method="direct")
    assert adjoint.values == pytest.approx(direct.values, rel=1e-9, abs=1e-15)


@pytest.mark.few(2)
@pytest.mark.parametrize("backend", ["jit", "c"])
@pytest.mark.parametrize("rows", [8, 60])
def test_every_backend_runs_the_same(backend, rows):
    model = pendulum(rows=rows, constant=True)
    usual = da.solve_dynamics(model, 0.2, step=0.01, backend="vm")
    other = da.solve_dynamics(model, 0.2, step=0.01, backend=backend)
    assert other.values("bob.angle") == pytest.approx(usual.values("bob.angle"), abs=1e-12)


@pytest.mark.parametrize("rows", [8, 60])
def test_a_batch_is_its_runs(rows):
    model = pendulum(rows=rows, constant=True)
    sizes = [0.0, 1.0, 2.5]
    batch = da.solve_dynamics(model, 0.2, step=0.01, parameters={"size": sizes})
    for k, size in enumerate(sizes):
        one = da.solve_dynamics(model, 0.2, step=0.01, parameters={"size": size})
        computed = batch["bob.angle"].values[k, -1]
        assert computed == pytest.approx(one.values("bob.angle")[-1], abs=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("integrator", [da.RK4(), da.DormandPrince(), da.Radau()])
def test_a_run_that_leaves_a_table_ends_and_names_it(integrator):
    motion = da.solve_dynamics(pendulum(top=0.6, angle=0.0), 1.0, step=0.01, integrator=integrator)
    assert not motion.status.success
    assert "the table 'torque' goes from -0.6 to 0.6" in motion.status.message
    assert abs(motion.values("bob.angle")[-1]) <= 0.6 + 1e-6


def test_a_driven_motion_that_leaves_a_table_names_it():
    system = da.System("x")
    bob = system.add(planar.Bar("bob", length=0.5, mass=1.0))
    system.add(planar.Revolute("O", system.ground.center, bob.start))
    system.add(planar.RotationalDriver("motor", system.ground, bob, law=2 * da.t))
    torque = system.table("torque", [-0.5, 0, 0.5], [1, 2, 3])
    system.add(planar.Torque("M", bob, torque(bob.angle)))
    motion = da.solve_inverse_dynamics(system.build(), 1.0, step=0.01)
    assert not motion.status.success and motion.time[-1] == pytest.approx(0.25)
    assert "after t = 0.25 s the table 'torque' goes from -0.5 to 0.5" in motion.status.message


def test_a_start_outside_of_a_table_is_refused():
    with pytest.raises(da.ModelError, match=r"at the start the table 'torque' goes from -0.6"):
        pendulum(top=0.6, angle=2.0)


GAS = (
    "stroke [mm],force [kN],temperature\n# measured\n0,2,300\n10,1.5,310\n20,0.9,320\n30,0.3,330\n"
)
SLIDER = """
format = 1

[parameters]
bore = 1.5

[tables.gas]
file = "gas.csv"
x = "stroke"
y = "force"

[tables.ramp]
x = ["0 ms", "10 ms", 0.02]
y = [0, 1, "bore"]
kind = "linear"
outside = "clamp"

[bodies.piston]
mass = "2 kg"
inertia = 0

[bodies.piston.points]
pin = ["10 mm", 0]

[joints.guide]
type = "Prismatic"
connect = [{ body = "ground", at = [0, 0] }, "piston.pin"]

[forces.push]
type = "Force"
connect = ["piston.pin"]
vector = ["interp(piston.pin.x, gas)*interp(t, ramp)", 0]

[analysis]
type = "Dynamics"
duration = "5 ms"
step = "0.1 ms"

[responses.pressure]
type = "Final"
measure = "interp(piston.pin.x, gas)"
"""


def written(tmp_path, text=SLIDER, gas=GAS):
    (tmp_path / "gas.csv").write_text(gas, encoding="utf-8")
    path = tmp_path / "slider.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_tables_of_a_file(tmp_path):
    file = load_model_file(written(tmp_path))
    model = file.model()
    motion = make_analysis(file, model).run(model)
    x = motion.values("piston.pin.x")[-1]
    gas = CubicSpline([0, 0.01, 0.02, 0.03], [2000, 1500, 900, 300])
    assert motion.values("push.force.x")[-1] == pytest.approx(gas(x) * 0.5, rel=1e-12)
    assert motion.values("interp(piston.pin.x, gas)")[-1] == pytest.approx(gas(x), rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('x = "stroke"', 'x = "strok"', r"tables.gas.*unknown column 'strok'.*'stroke'"),
        ('file = "gas.csv"', 'file = "air.csv"', r"tables.gas"),
        ('kind = "linear"', 'kind = "lineal"', r"tables.ramp.*unknown kind 'lineal'"),
        ('y = [0, 1, "bore"]', "y = [0, 1]", r"tables.ramp.*3 abscissae but 2 values"),
        ('y = [0, 1, "bore"]', "", r"tables.ramp.*give x and y as lists"),
        ("interp(t, ramp)", "interp(t, rmp)", r"forces.push.*unknown name 'rmp'.*'ramp'"),
        ("interp(t, ramp)", "ramp", r"forces.push.*tables, have no such operation"),
        ("interp(t, ramp)", "interp(ramp, t)", r"forces.push"),
        ("interp(piston.pin.x, gas)*", "interp(3 kg, gas)*", r"3 kg does not fit, expected m"),
        ("interp(piston.pin.x, gas)*", "interp(t, gas)*", r"t \[s\] does not fit, expected m"),
        ("[tables.ramp]", "[tables.bore]", r"the name is already used"),
    ],
)
def test_a_file_is_told_what_is_wrong(tmp_path, old, new, message):
    assert old in SLIDER
    path = written(tmp_path, SLIDER.replace(old, new))
    with pytest.raises(da.DalembertError, match=message):
        load_model_file(path).model()


@pytest.mark.parametrize(
    ("text", "message"),
    [("a,b\n", "no rows"), ("a,b\n1,2\n3\n", "line 3: has 1 columns"), ("1,2\nx,3\n", "line 2")],
)
def test_files_that_are_no_tables(tmp_path, text, message):
    path = written(tmp_path, gas=text)
    with pytest.raises(da.FileError, match=message):
        load_model_file(path).build()


def test_a_load_of_a_structure_by_a_table(tmp_path):
    structure = da.Structure("bar")
    a, b = structure.node("a", 0, 0), structure.node("b", 1, 0)
    structure.add(da.structures.Truss("r", a, b, area=1e-4, modulus=2e11, density=7850))
    structure.support(a)
    structure.support(b, uy=0)
    ramp = structure.table("ramp", ["0 s", "1 s"], [0, "3 kN"], kind="linear", outside="clamp")
    structure.load(b, fx=ramp(da.t))
    motion = da.solve_transient(structure.build(), 1e-3, step=1e-5)
    assert motion.status.success


def test_a_table_within_a_switch_is_held_with_it():
    """A torque that begins beyond an angle, where the run stops and goes on."""
    system = da.System("x")
    bob = system.add(planar.Bar("bob", length=0.5, mass=1.0, angular_velocity=1.0))
    system.add(planar.Revolute("O", system.ground.center, bob.start))
    x = np.linspace(0, 4, 60)
    torque = system.table("torque", x, x**2)
    system.add(planar.Torque("M", bob, da.where(torque(bob.angle) > 0.25, torque(bob.angle), 0)))
    for integrator in (da.DormandPrince(rtol=1e-10, atol=1e-12), da.Radau(rtol=1e-10, atol=1e-12)):
        motion = da.solve_dynamics(system.build(), 1.0, outputs=3, integrator=integrator)
        assert motion.values("bob.angle")[1] == pytest.approx(0.5, abs=1e-9)  # at 0.5 s
        energy = motion.values("kinetic_energy")[-1] - motion.values("kinetic_energy")[0]
        angle = motion.values("bob.angle")[-1]
        assert energy == pytest.approx((angle**3 - 0.5**3) / 3, rel=1e-5)


@pytest.mark.parametrize("share", [1.0, 0.999])
def test_a_driver_law_with_knots_is_followed_at_coarse_steps(share):
    """Beyond a knot the prediction of a step is poor; the position satisfies the law."""
    times = [0.0, 0.52867460, 1.12710250, 1.42800571, 1.83192321, 2.39619671, 3.17564312]
    values = [-0.43842592, 0.45358887, -0.05337283, 0.05639878, -0.11125681, 0.38276982]
    values.append(values[0])
    system = da.System("driven arm")
    arm = system.add(planar.Bar("arm", length=0.5))
    system.add(planar.Revolute("O", system.ground.center, arm.start))
    law = da.Table(times=times, values=values, periodic=True)
    system.add(planar.RotationalDriver("motor", system.ground, arm, law))
    motion = da.solve_kinematics(system.build(), 1.7 * times[-1], step=share * times[-1] / 83)
    twin = CubicSpline(times, values, bc_type="periodic", extrapolate="periodic")
    assert motion.status.outcome is da.Outcome.COMPLETED
    for order, name in enumerate(("angle", "angular_velocity", "angular_acceleration")):
        computed = motion[f"arm.{name}"].values
        np.testing.assert_allclose(computed, twin(motion.time, order), atol=1e-9)
