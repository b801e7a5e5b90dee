"""Motion laws and splines: values, derivatives, and continuity where their pieces meet."""

from __future__ import annotations

import functools
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, strategies as st
from registry import LAWS, Builder, Observer
from scipy.interpolate import CubicSpline as SciPySpline

import dalembert as da
from dalembert import SplineCurve, planar, t
from dalembert.elements.laws import Harmonic, Polynomial, Product, Sum, Table
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.end_conditions import ENDS
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.spline import CubicSpline

TIMES = np.linspace(-0.73, 3.1, 211)


@functools.cache
def compiled(name: str) -> tuple[ca.Function, SimpleNamespace]:
    """``time → f, f', f'', f'''`` of a law at its numbers."""
    builder = Builder("law", False, Observer())
    law = LAWS[name].make(builder)
    numbers = {n: p.value for n, p in builder.system.parameters.items()}
    time = ca.SX.sym("time")
    rows = [law.value(time)]
    for _ in range(3):
        rows.append(ca.jacobian(rows[-1], time))
    symbols = ca.vertcat(*(p.sx for p in builder.system.parameters.values()))
    values = ca.DM(list(numbers.values()))
    table = ca.substitute(ca.vertcat(*rows), symbols, values) if numbers else ca.vertcat(*rows)
    return ca.Function("law", [time], [ca.densify(table)]), SimpleNamespace(**numbers)


def derivatives(name: str, times) -> np.ndarray:
    return compiled(name)[0](np.atleast_2d(times)).full()


def _apart(times, breaks) -> np.ndarray:
    """Times away from the places where pieces meet."""
    far = np.all(np.abs(times[:, None] - np.array([*breaks, -9.0])) > 0.02, axis=1)
    return times[far]


@pytest.mark.parametrize("name", LAWS)
def test_values_are_the_formulas(name):
    """f(t) against its twin."""
    inside = (TIMES >= -0.5) & (TIMES <= 2.6)  # where the twin of a table ends
    times = TIMES[inside] if name in ("Table", "Table of formulas", "Sum") else TIMES
    numbers = compiled(name)[1]
    expected = [LAWS[name].twin(numbers, s) for s in times]
    np.testing.assert_allclose(derivatives(name, times)[0], expected, atol=1e-13)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("name", LAWS)
def test_derivatives_are_slopes(name, order):
    """Each derivative is the slope of the one before, away from the joints of the pieces."""
    period = 1.1 if "repeated" in name else 3.1
    breaks = [b + k * period for b in LAWS[name].breaks for k in range(-1, 4)]
    times, h = _apart(TIMES, [*breaks, -0.5, 2.6]), 1e-3
    shifted = {d: derivatives(name, times + d * h)[order - 1] for d in (-2, -1, 1, 2)}
    slope = (8 * (shifted[1] - shifted[-1]) - (shifted[2] - shifted[-2])) / (12 * h)
    computed = derivatives(name, times)[order]
    np.testing.assert_allclose(computed, slope, atol=1e-7 * (1 + np.abs(computed).max()))


@pytest.mark.parametrize("name", [n for n, law in LAWS.items() if law.breaks])
def test_pieces_meet_as_smoothly_as_claimed(name):
    """f … f⁽ˢ⁾ are continuous where pieces meet; the next derivative is not."""
    law, e = LAWS[name], 1e-9
    breaks = np.array(law.breaks)
    before, after = derivatives(name, breaks - e), derivatives(name, breaks + e)
    size = 1 + np.abs(derivatives(name, TIMES)).max(axis=1)
    jump = np.abs(after - before).max(axis=1) / size
    assert np.all(jump[: law.smooth + 1] < 1e-5)
    if law.smooth < 3:
        assert jump[law.smooth + 1] > 1e-2


@pytest.mark.parametrize("name", [n for n in LAWS if "repeated" in n])
def test_repeated_rises_repeat(name):
    np.testing.assert_allclose(
        derivatives(name, TIMES)[0], derivatives(name, TIMES + 1.1)[0], atol=1e-13
    )


def test_table_continues_along_its_end_slopes():
    value, slope, curvature, _ = derivatives("Table", np.array([-0.5, -1.5, 2.6, 4.6]))
    assert value[1] == pytest.approx(value[0] - slope[0])
    assert value[3] == pytest.approx(value[2] + 2 * slope[2])
    np.testing.assert_allclose(curvature[[1, 3]], 0.0, atol=1e-12)


@given(
    gaps=st.lists(st.floats(0.2, 2.0), min_size=3, max_size=8),
    periodic=st.booleans(),
    ends=st.sampled_from(ENDS),
    seed=st.integers(0, 99),
)
def test_cubic_spline_is_scipys(gaps, periodic, ends, seed):
    """Value and two derivatives of any spline, between and at its knots."""
    knots = np.concatenate([[0.3], 0.3 + np.cumsum(gaps)])
    values = np.random.default_rng(seed).standard_normal(knots.size)
    if periodic:
        values[-1] = values[0]
    x = ca.SX.sym("x")
    s = CubicSpline(knots, list(values), periodic, "spline", ends)(x)
    first = ca.jacobian(s, x)
    function = ca.Function("s", [x], [ca.vertcat(s, first, ca.jacobian(first, x))])
    theirs = SciPySpline(knots, values, bc_type="periodic" if periodic else ends)
    places = np.sort(np.concatenate([knots[:-1], np.linspace(knots[0], knots[-1], 40)[:-1]]))
    computed = function(places[None, :]).full()
    for order in range(3):
        np.testing.assert_allclose(computed[order], theirs(places, order), atol=1e-9)


@pytest.mark.parametrize("ends", [*ENDS, "periodic"])
@pytest.mark.parametrize("rows", [3, 4, 7])
def test_splines_are_differentiable_by_their_knots_and_values(rows, ends):
    """Against differences of SciPy's splines."""
    rng = np.random.default_rng(rows)
    knots, values = np.cumsum(rng.uniform(0.5, 1.5, rows)), rng.standard_normal(rows)
    periodic = ends == "periodic"
    k, v, x = ca.SX.sym("k", rows), ca.SX.sym("v", rows), ca.SX.sym("x")
    closed = [*(v[i] for i in range(rows - 1)), v[0] if periodic else v[rows - 1]]
    spline = CubicSpline(
        [Expression(k[i]) for i in range(rows)],
        list(map(Expression, closed)),
        periodic,
        "spline",
        "natural" if periodic else ends,
    )
    slopes = ca.Function("slopes", [x, k, v], [ca.jacobian(spline(x), ca.vertcat(k, v))])

    def theirs(numbers):
        table = numbers[rows:].copy()
        if periodic:
            table[-1] = table[0]
        return SciPySpline(numbers[:rows], table, bc_type=ends)

    inputs, h = np.concatenate([knots, values]), 1e-5
    for place in np.linspace(knots[0] + 0.1, knots[-1] - 0.1, 7):
        computed = slopes(place, knots, values).full().ravel()
        wanted = [
            (theirs(inputs + h * e)(place) - theirs(inputs - h * e)(place)) / (2 * h)
            for e in np.eye(2 * rows)
        ]
        np.testing.assert_allclose(computed, wanted, atol=1e-8)


@pytest.mark.few(1)
@pytest.mark.parametrize("periodic", [False, True])
def test_large_tables_are_looked_up(periodic):
    """Two hundred thousand rows are one node of the graph, and the same spline, ends included."""
    knots = np.linspace(0.0, 2 * np.pi, 200_001)
    x = ca.SX.sym("x")
    s = Table(knots, np.sin(knots), periodic=periodic).value(x)
    assert ca.n_nodes(s) < 100
    first = ca.jacobian(s, x)
    function = ca.Function("s", [x], [ca.vertcat(s, first, ca.jacobian(first, x))])
    inside = np.array([0.0, 0.3, 3.0, 6.2])
    computed = function(inside[None, :]).full()
    np.testing.assert_allclose(computed[:2], [np.sin(inside), np.cos(inside)], atol=1e-9)
    beyond = function(np.array([[2 * np.pi + 0.5, -0.5]])).full()[0]
    wanted = np.sin([0.5, -0.5]) if periodic else [0.5, -0.5]
    np.testing.assert_allclose(beyond, wanted, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Table([0, 1, np.nan], [0, 1, 0]), r"abscissa in row 3: nan"),
        (lambda: Table([0, 1, 2], [0, np.inf, 0]), r"value in row 2: inf"),
        (lambda: Table([0, 1, 2], [0, 1e300, 0]), r"value in row 2: 1e\+300"),
        (lambda: Table([0, 1, 2], [0, "one", 0]), r"value in row 2.*'one'"),
        (lambda: Table([0, 1, 2], [0, True, 0]), r"value in row 2.*True"),
        (lambda: Table([0, 1, 1], [0, 1, 0]), r"row 3 \(1.0\) does not follow row 2"),
        (lambda: Table(3, [0, 1, 0]), "times must be a list, got 3"),
        (lambda: Table([0, 1, 2], "abc"), "value in row 1"),
        (lambda: Table([0, 1, 2], [0, 1, 0], periodic=1), "periodic is 1"),
        (lambda: Table([0, 1, 2], [0, 1, 1], periodic=True), "misses by 1"),
        (lambda: Harmonic(np.nan, 1.0), "amplitude: nan"),
        (lambda: Harmonic("one", 1.0), "amplitude.*'one'"),
        (lambda: SplineCurve(5), "points must be a list"),
        (lambda: Sum([]), "at least one"),
        (lambda: Product(3), "must be a list"),
        (lambda: Polynomial(velocity=1.0) + np.nan, r"Sum.laws\[1\]: nan"),
        (lambda: Polynomial(velocity=1.0) * "two", r"Product.laws\[1\].*'two'"),
    ],
)
def test_wrong_numbers_in_laws_are_typed_errors(make, words):
    with pytest.raises(ModelError, match=words):
        make()


def test_rows_that_do_not_increase_with_some_parameters():
    system = da.System("crank")
    late = system.parameter("late", 3.0)
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), bar.start))
    law = Table([0.0, 2.0, late], [0.0, 1.0, 0.0])
    system.add(planar.RotationalDriver("motor", system.ground, bar, law))
    model = system.build()
    with pytest.raises(ModelError, match="motor: abscissae must increase, but row 3"):
        da.solve_kinematics(model, 1.0, parameters={"late": 1.0})


def test_laws_add_and_multiply_with_formulas_and_numbers():
    law, k, x = Polynomial(velocity=2.0), da.System("k").parameter("k", 3.0), ca.SX.sym("x")
    combination = k * law - 1 + t * law - (-law) + np.float64(2.0) * law
    function = ca.Function("f", [x, k.sx], [combination.value(x)])
    assert float(function(0.5, 3.0)) == pytest.approx(3 * 1 - 1 + 0.5 + 1 + 2)
