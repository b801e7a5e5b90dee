"""Snap-through and snap-back: paths with limit points that are known in closed form.

Two bars of stretch stiffness EA meet in a flat toggle of half width a and height h. With the apex
at height y, ``F = 2 EA (L − l)/L · y/l``, ``l² = a² + y²``. A spring k in series with the load adds
``F/k`` to the loaded point, and a soft one makes the path snap back.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import dalembert as da
from dalembert import structures

A, H, EA, LOAD = 1.0, 0.2, 1000.0, 10.0


def force(y, a=A, h=H, ea=EA):
    length = np.hypot(a, h)
    return 2 * ea * (length - np.hypot(a, y)) / length * y / np.hypot(a, y)


def limit_load(a=A, h=H, ea=EA):
    minimum = minimize_scalar(
        lambda y: -force(y, a, h, ea),
        bounds=(0.05 * h, h),
        method="bounded",
        options={"xatol": 1e-12},
    )
    return -minimum.fun


@functools.cache
def toggle(spring: float | None = None):
    s = da.Structure("toggle")
    a, h = s.parameter("a", A), s.parameter("h", H)
    modulus = s.parameter("EA", EA)
    left, apex, right = s.node("left", -a, 0), s.node("apex", 0, h), s.node("right", a, 0)
    for name, end in (("bar1", left), ("bar2", right)):
        s.add(structures.Truss(name, end, apex, area=1.0, modulus=modulus))
    s.support(left)
    s.support(right)
    s.support(apex, ux=0)
    loaded = apex
    if spring is not None:
        loaded = s.node("top", 0, 1.0)
        s.support(loaded, ux=0)
        s.add(structures.AxialSpring("spring", apex, loaded, stiffness=spring))
    s.load(loaded, fy=-s.parameter("F", LOAD))
    return s.build()


@functools.cache
def path_of(spring: float | None = None):
    return da.solve_load_path(toggle(spring), until=2.0)


@pytest.mark.parametrize("spring", [None, 30.0])
def test_points_lie_on_the_closed_form(spring):
    path = path_of(spring)
    assert path.status.success
    y = H + path["apex.uy"]
    np.testing.assert_allclose(path.load_factors * LOAD, force(y), atol=1e-9 * EA)
    if spring is not None:  # one end follows the other by the stretch of the spring
        top = path["top.uy"]
        np.testing.assert_allclose(top, y - H - force(y) / spring, atol=1e-9)
        assert (np.diff(top) > 0).any()  # it snaps back


@pytest.mark.parametrize("spring", [None, 30.0])
def test_limit_points_are_located(spring):
    path = path_of(spring)
    assert path.limits.size == 2
    computed = path.load_factors[path.limits] * LOAD
    np.testing.assert_allclose(computed, [limit_load(), -limit_load()], rtol=1e-10)


def test_stability_is_lost_between_the_limit_points():
    path = path_of()
    first, second = path.limits
    inside = np.arange(first + 1, second)
    assert (path.negative[inside] == 1).all()
    assert path.stable[: first - 1].all() and path.stable[second + 1 :].all()


@pytest.mark.parametrize("method", ["adjoint", "direct"])
def test_gradient_of_the_limit_load(method):
    path = path_of()
    response = da.at(int(path.limits[0]), "load_factor")
    gradient = da.sensitivity(path, response, ["a", "h", "EA", "F"], method).values[0] * LOAD
    e = 1e-4

    def slope(name, value):
        return (limit_load(**{name: value * (1 + e)}) - limit_load(**{name: value * (1 - e)})) / (
            2 * e * value
        )

    expected = [slope("a", A), slope("h", H), slope("ea", EA), -limit_load() / LOAD]
    np.testing.assert_allclose(gradient, expected, rtol=2e-6)


def test_equilibrium_at_a_given_load():
    point = path_of().at_load(0.2)
    y = H + point["apex.uy"]
    assert force(y) == pytest.approx(0.2 * LOAD, rel=1e-10)
    assert y > 0.1  # the first of three
    gradient = da.sensitivity(point, da.final("apex.uy"), ["h"], "adjoint").item()
    e = 1e-5
    near = [
        da.solve_load_path(toggle(), until=0.2, parameters={"h": H + d})["apex.uy"][-1]
        for d in (e, -e)
    ]
    assert gradient == pytest.approx((near[0] - near[1]) / (2 * e), rel=1e-6)


def test_a_load_beyond_the_path_is_refused():
    with pytest.raises(da.AnalysisError, match="not 5"):
        path_of().at_load(5.0)
    with pytest.raises(da.AnalysisError, match="no load case 'wind'"):
        da.solve_load_path(toggle(), case="wind")
    with pytest.raises(da.UnsupportedError, match="first must be positive"):
        da.solve_load_path(toggle(), first=0.0)


def test_a_path_can_be_stopped():
    path = da.solve_load_path(toggle(), until=2.0, stop=lambda point: point["apex.uy"] < -H)
    assert "stopped" in path.status.message
    assert path["apex.uy"][-1] < -H <= path["apex.uy"][-2]
