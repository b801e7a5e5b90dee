"""Equal parts of a model are compiled once, and give what each gives alone, to the last bit."""

from __future__ import annotations

from functools import partial

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.symbolic.evaluation import backends
from dalembert.symbolic.evaluation.columns import NativeColumns, VirtualColumns
from dalembert.symbolic.evaluation.lanes import SideBySide
from dalembert.symbolic.native import code_cache, source, straight_line, translation
from dalembert.symbolic.native.llvm import Llvm
from dalembert.symbolic.native.toolchain import ENTRY

REPEATING = partial(Llvm, short=300)
"""Cuts bodies up that are compiled as a whole else."""
ROUNDING = 1e-12


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """An empty cache for every test."""
    monkeypatch.setenv("DALEMBERT_CACHE", str(tmp_path))


def four_bars(count: int) -> da.Model:
    """So many four-bars in a row; masses are parameters, some damping is not."""
    system = da.System("row", gravity=(0.0, -9.81))
    last = None
    for i in range(count + 1):
        mass = system.parameter(f"m{i}", 1.0 + 0.1 * i)
        crank = system.add(planar.Bar(f"c{i}", length=1.0, mass=mass, angle=1.4))
        ground = system.ground.point(float(i), 0.0)
        system.add(planar.Revolute(f"O{i}", ground, crank.start))
        system.add(planar.TorsionSpring(f"S{i}", system.ground, crank, damping=0.1 + 0.01 * i))
        if last is not None:
            bar = system.add(planar.Bar(f"b{i}", length=1.0, mass=0.5, angle=0.0))
            system.add(planar.Revolute(f"A{i}", last.end, bar.start))
            system.add(planar.Revolute(f"B{i}", bar.end, crank.end))
        last = crank
    return system.build()


def step_of(model: da.Model, lanes: bool = False) -> tuple[ca.Function, np.ndarray, np.ndarray]:
    """A step as it is compiled, a state, and what the step needs of the parameters."""
    kernel = da.Dynamics(0.1, step=0.01).kernel(model)
    x, mode = kernel.initial(model.start, 0.0, model.nominal)
    forms = kernel.fixed.marched(mode).forms
    function = forms.side_by_side if lanes else forms.called or forms.function
    return function, x, forms.values(model.nominal).full().ravel()


def repeated(count: int) -> ca.Function:
    """Operations of all kinds on one pair of numbers after the other, with other constants."""
    x, outputs = ca.SX.sym("x", 2, count), []
    before = ca.SX(1.0)
    for k in range(count):
        a, b = x[0, k], x[1, k]
        c = 0.5 + 0.37 * k
        swing = ca.sin(a) * b + c * ca.cos(a) - ca.atan2(b, 1 + a**2)
        chosen = ca.if_else(ca.logic_or(a < b, swing >= c), ca.exp(-(swing**2)), ca.fabs(b) / c)
        more = ca.sign(a) * ca.fmax(chosen, b) + ca.erf(swing) - ca.sqrt(1 + b**2)
        before = ca.tanh(0.1 * before + more - ca.logic_not(b > c))
        outputs += [before, chosen + c]
    return ca.Function("repeated", [x], [ca.vertcat(*outputs), before])


def native(function: ca.Function, toolchain: Llvm, **how) -> NativeColumns:
    loop = code_cache.compiled_loop(source.c_source(function), toolchain)
    return NativeColumns(function, loop, "LLVM", **how)


def test_operations_of_all_kinds_with_other_constants():
    function = repeated(60)
    inputs = np.random.default_rng(1).normal(size=(2, 60 * 3))
    columns = native(function, REPEATING())
    for computed, wanted in zip(
        columns(3, inputs), VirtualColumns(function)(3, inputs), strict=True
    ):
        np.testing.assert_array_equal(computed, wanted)
    pieces, different = columns.pieces
    assert different < pieces / 3


def test_what_differs_everywhere_is_cut_all_the_same(monkeypatch):
    monkeypatch.setattr(straight_line, "PIECE", 7)
    x = ca.SX.sym("x", 6)
    value = x
    for k in range(12):
        value = ca.sin(value) + ca.cumsum(value) * (k + 1) - value[::-1] / (2 + x**2)
    function = ca.Function("long", [x], [value, ca.sum1(value)])
    inputs = np.random.default_rng(2).random((6, 3))
    columns = native(function, Llvm(short=7))
    for computed, wanted in zip(
        columns(3, inputs), VirtualColumns(function)(3, inputs), strict=True
    ):
        np.testing.assert_array_equal(computed, wanted)
    assert columns.pieces[0] > 5


def test_a_result_that_nobody_wants_is_stored_nowhere():
    """Only the first result of a called function is wanted."""
    inner = repeated(40)
    x = ca.MX.sym("x", 2, 40)
    last = inner(x)[1]
    function = ca.Function("outer", [x], [last, inner(2 * x)[1]])
    inputs = np.random.default_rng(3).normal(size=(2, 40))
    for computed, wanted in zip(
        native(function, REPEATING())(1, inputs), VirtualColumns(function)(1, inputs), strict=True
    ):
        np.testing.assert_array_equal(computed, wanted)


@pytest.mark.thorough
def test_steps_of_a_row_of_mechanisms():
    function, x, q = step_of(four_bars(8))
    inputs = x, 0.01 * np.arange(20.0), np.full(20, 0.01), np.ones(20), q
    columns = native(function, REPEATING(), carried=True, fixed=(4,))
    expected = VirtualColumns(function, True, (4,))(20, *inputs)[0]
    np.testing.assert_array_equal(columns(20, *inputs)[0], expected)


@pytest.mark.thorough
def test_code_does_not_grow_with_the_number_of_equal_mechanisms():
    few, many = (
        translation.distinct_operations(source.c_source(step_of(four_bars(n))[0]), ENTRY, 300)
        for n in (15, 45)
    )
    assert many < 2 * few  # rows end where they end, which three times as many do alike


@pytest.mark.thorough
def test_lanes_go_the_same_way():
    function, x, q = step_of(four_bars(6), lanes=True)
    lanes, rng = 4, np.random.default_rng(4)
    values = q * rng.uniform(0.98, 1.02, (lanes, q.size))
    steps = [np.tile(v, (lanes, 1)) for v in (x, 0.01 * np.arange(5.0), np.full(5, 0.01))]
    inputs = [*steps, np.ones((lanes, 5)), values]
    loop = code_cache.compiled_loop(source.c_source(function), Llvm(lanes, short=300))
    computed = SideBySide(lanes, function, loop, "LLVM", True, (4,)).group(5, inputs)[0]
    alone = VirtualColumns(function, True, (4,))
    for lane in range(lanes):
        expected = alone(5, *(g[lane] for g in inputs))[0]
        np.testing.assert_allclose(computed[lane], expected, rtol=ROUNDING, atol=ROUNDING)


@pytest.mark.few(1)
@pytest.mark.parametrize("count", [2, pytest.param(4, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("method", ["direct", "adjoint"])
def test_gradients_go_the_same_way(method, count, monkeypatch):
    monkeypatch.setitem(backends.BACKENDS, "jit", lambda: backends.Compiled(REPEATING))
    model = four_bars(count)
    gradients = []
    for backend in ("vm", "jit"):
        motion = da.solve_dynamics(model, 0.2, step=1e-3, outputs=[0.2], backend=backend)
        gradients.append(da.sensitivity(motion, da.final("c0.angle"), method=method).values)
    assert motion.statistics["distinct code blocks"] < motion.statistics["code blocks"]
    np.testing.assert_allclose(gradients[1], gradients[0], rtol=1e-10, atol=1e-12)
