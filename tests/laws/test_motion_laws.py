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

from dalembert.symbolic.spline import CubicSpline

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
    times = TIMES if name != "Table" else TIMES[(TIMES >= -0.5) & (TIMES <= 2.6)]
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
    found = derivatives(name, times)[order]
    np.testing.assert_allclose(found, slope, atol=1e-7 * (1 + np.abs(found).max()))


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
    np.testing.assert_allclose(curvature, 0.0, atol=1e-12)


@given(
    gaps=st.lists(st.floats(0.2, 2.0), min_size=3, max_size=8),
    periodic=st.booleans(),
    seed=st.integers(0, 99),
)
def test_cubic_spline_is_scipys(gaps, periodic, seed):
    """Value and two derivatives of any spline, between and at its knots."""
    knots = np.concatenate([[0.3], 0.3 + np.cumsum(gaps)])
    values = np.random.default_rng(seed).standard_normal(knots.size)
    if periodic:
        values[-1] = values[0]
    x = ca.SX.sym("x")
    s = CubicSpline(knots, list(values), periodic, "spline")(x)
    first = ca.jacobian(s, x)
    function = ca.Function("s", [x], [ca.vertcat(s, first, ca.jacobian(first, x))])
    theirs = SciPySpline(knots, values, bc_type="periodic" if periodic else "natural")
    places = np.sort(np.concatenate([knots[:-1], np.linspace(knots[0], knots[-1], 40)[:-1]]))
    found = function(places[None, :]).full()
    for order in range(3):
        np.testing.assert_allclose(found[order], theirs(places, order), atol=1e-9)
