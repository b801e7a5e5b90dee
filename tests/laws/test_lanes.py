"""Each lane gets what it would get alone, to the last bit, or to that of its sines and cosines."""

from __future__ import annotations

import threading

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.symbolic.evaluation.backends import Compiled, VirtualMachine
from dalembert.symbolic.evaluation.lane_tangents import LaneTangents, LinearStep
from dalembert.symbolic.evaluation.lanes import LaneColumns
from dalembert.symbolic.native import llvm
from dalembert.symbolic.native.llvm import lane_count, require_llvm

LANES = lane_count()
LAST = 4 * np.finfo(float).eps


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """An empty cache for every test."""
    monkeypatch.setenv("DALEMBERT_CACHE", str(tmp_path / "cache"))


def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0.0, -9.81))
    rod = system.add(
        planar.Bar("rod", length=system.parameter("l", 0.7), mass=system.parameter("m", 2.0))
    )
    system.add(planar.Revolute("O", system.ground.point(0.0, 0.0), rod.start))
    return system.build()


def check(
    function: ca.Function, arguments, count: int, in_lanes: bool, within: float = 0.0, **options
) -> None:
    """Every set alone, and all of them side by side; equal within a relative difference."""
    lanes = LaneColumns(function, **options)
    assert (lanes.side_by_side is not None) is in_lanes
    computed, sets = lanes(count, *arguments), max(g.shape[0] for g in arguments)
    alone = VirtualMachine().columns(function, **options)
    for s in range(sets):
        expected = alone(count, *(g[min(s, g.shape[0] - 1)] for g in arguments))
        for result, wanted in zip(computed, expected, strict=True):
            np.testing.assert_allclose(result[s], wanted, rtol=within, atol=within)


@pytest.mark.few(3)
@pytest.mark.parametrize("sets", [1, 2, LANES, 2 * LANES + 1])
@pytest.mark.parametrize("called", [False, True], ids=["one function", "calls"])
def test_steps_of_several_designs(sets, called):
    model = pendulum()
    kernel = da.Dynamics(0.1, step=0.01).kernel(model)
    rng = np.random.default_rng(2)
    designs = model.nominal * rng.uniform(0.8, 1.2, (sets, model.nominal.size))
    x, mode = kernel.initial(model.start, 0.0, model.nominal)
    step = kernel.fixed.step_of(mode).prepared.forms
    values = np.array([step.values(p).full().ravel() for p in designs])
    h, t = np.full((1, 50), 0.01), 0.01 * np.arange(50.0)[None]
    function, kind = (step.called, ca.MX) if called else (step.function, ca.SX)
    sizes = x.size, 1, 1, values.shape[1]
    s, now, length, q = (kind.sym(name, n) for name, n in zip("sthq", sizes, strict=True))
    function = ca.Function("march", [s, now, length, q], [function(now, length, s, q)])
    check(
        function,
        [np.tile(x, (sets, 1)), t, h, values],
        50,
        True,
        50 * LAST,
        carried=True,
        fixed=(3,),
    )


def test_every_kind_of_operation():
    x, y = ca.SX.sym("x", 2), ca.SX.sym("y")
    chosen = ca.if_else(x[0] < y, ca.sin(x[1]), ca.atan2(y, x[0]))
    more = ca.vertcat(ca.sign(y), ca.logic_not(x[0] > 0), ca.erf(y), ca.fmax(x[1], y) ** y)
    function = ca.Function("kinds", [x, y], [chosen, more])
    rng = np.random.default_rng(4)
    check(function, [rng.normal(size=(5, 2, 3)), rng.uniform(size=(5, 1, 3))], 3, True, LAST)


def turned() -> LaneColumns:
    x = ca.SX.sym("x")
    return LaneColumns(ca.Function("turned", [x], [ca.vertcat(ca.sin(x), ca.cos(x))]))


def test_sines_and_cosines_are_right_within_a_unit_in_the_last_place():
    rng = np.random.default_rng(7)
    near = rng.integers(-600_000, 600_000, 4000) * (np.pi / 2)
    spread = [rng.uniform(-size, size, 4000) for size in (1.0, 10.0, 1e6)]
    x = np.concatenate([near, *spread, 10.0 ** rng.uniform(-300, -1, 4000)]).reshape(4, -1)
    (computed,) = turned()(x.shape[1], x[:, None])
    for k, function in enumerate((np.sin, np.cos)):
        exact = function(x.astype(np.longdouble))
        assert (np.abs(computed[:, k] - exact) <= np.spacing(np.abs(computed[:, k]))).all()


def test_far_angles_are_left_to_the_library_and_change_no_neighbour():
    x = np.array([0.3, 1e9, -0.0, np.inf, np.nan, -2e6, 7.0, 1.0])
    with np.errstate(invalid="ignore"):
        expected = np.array([np.sin(x), np.cos(x)])
    (together,) = turned()(1, x[:, None, None])
    np.testing.assert_allclose(together[:, :, 0].T, expected, rtol=LAST)
    np.testing.assert_array_equal(np.signbit(together[2, 0]), True)
    (alone,) = turned()(1, np.repeat(x[:1], 2)[:, None, None])
    np.testing.assert_array_equal(alone[0], together[0])


def test_graphs_of_matrices():
    a, b = ca.MX.sym("a", 3, 3), ca.MX.sym("b", 3)
    chosen = ca.if_else(a[0] < b[0], ca.mtimes(a, b), ca.sin(b), True)
    function = ca.Function("both", [a, b], [chosen + ca.norm_2(b)])
    rng = np.random.default_rng(5)
    check(function, [rng.normal(size=(6, 3, 6)), rng.normal(size=(6, 3, 2))], 2, False)
    sparse = ca.Function("sparse", [a, b], [ca.diag(b) * a])
    check(sparse, [rng.normal(size=(6, 3, 6)), rng.normal(size=(6, 3, 2))], 2, True)
    smooth = ca.Function("product", [a, b], [ca.mtimes(a, b) + ca.norm_2(b) * (a[0] < b[0])])
    check(smooth, [rng.normal(size=(6, 3, 6)), rng.normal(size=(6, 3, 2))], 2, True)


def test_factorisations_that_may_fail_are_done_set_by_set():
    a, b = ca.MX.sym("a", 3, 3), ca.MX.sym("b", 3)
    function = ca.Function("solve", [a, b], [ca.solve(a + 5 * ca.DM.eye(3), b, "qr")])
    rng = np.random.default_rng(5)
    check(function, [rng.normal(size=(6, 3, 6)), rng.normal(size=(6, 3, 2))], 2, False)


def test_equations_solved_by_newton_are_solved_set_by_set():
    x, p = ca.SX.sym("x"), ca.SX.sym("p")
    residual = ca.Function("residual", [x, p], [x**2 - p])
    function = ca.rootfinder("root", "fast_newton", residual, {"abstol": 1e-12})
    rng = np.random.default_rng(6)
    check(function, [np.ones((1, 1, 4)), rng.uniform(1, 2, (6, 1, 4))], 4, False)


@pytest.mark.parametrize("count", [1, LANES, LANES + 1])
def test_directions_of_a_step(count):
    """One number stands for all lanes in the entries, and rows of them are filled up."""
    e, dx, dq = ca.SX.sym("e", 3), ca.SX.sym("dx", 2), ca.SX.sym("dq")
    along = ca.vertcat(e[0] * dx[0] + e[1] * dx[1] + dq, e[2] * dx[1] - dx[0])
    t, h, x, q = ca.SX.sym("t"), ca.SX.sym("h"), ca.SX.sym("x", 2), ca.SX.sym("q")
    entries = ca.vertcat(ca.cos(x[0]) * q, h * x[1], 1 - h * t)
    step = LinearStep(
        ca.Function("entries", [t, h, x, q], [entries]), ca.Function("along", [dx, e, dq], [along])
    )
    lanes = LaneTangents.of(step, Compiled(require_llvm), 10, count)
    rng = np.random.default_rng(1)
    inputs = [rng.normal(size=(n, 2 * LANES + 3)) for n in (1, 1, 2)]
    changes, rates = rng.normal(size=(2, count)), rng.normal(size=(1, count))
    computed = lanes(changes, inputs, np.array([0.7]), rates)
    for k in range(2 * LANES + 3):
        at = step.entries(*(g[:, k] for g in inputs), 0.7)
        changes = step.along.map(count)(changes, np.tile(at.full(), count), rates).full()
        np.testing.assert_allclose(computed[k].T, changes, rtol=1e-12, atol=1e-14)


@pytest.mark.few(1)
@pytest.mark.parametrize("method", [da.RK4(), da.DormandPrince()], ids=["fixed", "controlled"])
def test_direct_gradients_side_by_side(method):
    """As by the virtual machine, and as the adjoint."""
    model, seen = pendulum(), da.final("rod.end.y")
    options = {"step": 0.01} if isinstance(method, da.RK4) else {"outputs": 5}
    runs = [
        da.solve_dynamics(model, 0.3, integrator=method, backend=backend, **options)
        for backend in ("jit", "vm")
    ]
    computed = [da.sensitivity(run, seen, method="direct").values for run in runs]
    np.testing.assert_allclose(computed[0], computed[1], rtol=1e-10, atol=1e-12)


def test_without_llvm_sets_are_called_one_by_one(monkeypatch):
    monkeypatch.setattr(llvm, "find_spec", lambda name: None)
    x = ca.SX.sym("x")
    check(ca.Function("f", [x], [ca.sin(x)]), [np.arange(12.0).reshape(3, 4)], 4, False)


def test_threads_may_call_at_once():
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 3)
    lanes = LaneColumns(ca.Function("step", [x, p], [x + ca.sin(ca.cross(x, p)) / 100]), True, (1,))
    begins = np.random.default_rng(3).normal(size=(4, 8, 3))
    expected = [lanes(2000, begin, 1 + begin)[0] for begin in begins]
    results: dict[int, np.ndarray] = {}

    def work(k: int) -> None:
        (results[k],) = lanes(2000, begins[k], 1 + begins[k])

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k, values in enumerate(expected):
        np.testing.assert_array_equal(results[k], values)


def test_arguments_of_a_wrong_size_are_named():
    x = ca.SX.sym("x", 2)
    lanes = LaneColumns(ca.Function("f", [x], [ca.sin(x)]))
    with pytest.raises(ValueError, match="f: argument 0"):
        lanes(4, np.zeros((4, 2, 3)))
