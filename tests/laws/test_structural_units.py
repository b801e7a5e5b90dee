"""Other units of length, mass and time change nothing but units, in all analyses of structures."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import dalembert as da
from dalembert import structures

UNITS = {
    "nanometres": (1e9, 1.0, 1.0),
    "gigametres": (1e-9, 1.0, 1.0),
    "micrograms": (1.0, 1e9, 1.0),
    "million tonnes": (1.0, 1e-9, 1.0),
    "nanoseconds": (1.0, 1.0, 1e9),
    "decades": (1.0, 1.0, 1e-9),
    "all of them": (1e-6, 1e7, 1e-5),
}
"""Sizes of one metre, one kilogram and one second in other units."""


def frame(metre: float, kilogram: float, second: float) -> da.Structure:
    """A portal of frames with a panel, a bar, a spring, masses; in its units."""
    force, pressure = kilogram * metre / second**2, kilogram / metre / second**2
    moment, density = force * metre, kilogram / metre**3
    s = da.Structure("portal")
    width = s.parameter("width", 2.0 * metre)
    modulus = s.parameter("modulus", 3e5 * pressure)
    rho = s.parameter("density", 200.0 * density)
    load = s.parameter("load", 20.0 * force)
    places = {"a": (0, 0), "b": (0, 3 * metre), "c": (width, 3 * metre), "d": (width, 0)}
    a, b, c, d = (s.node(name, *place) for name, place in places.items())
    numbers = {"area": 0.02 * metre**2, "second_moment": 6e-4 * metre**4, "modulus": modulus}
    for name, ends in {"left": (a, b), "top": (b, c), "right": (d, c)}.items():
        s.add(structures.Frame(name, *ends, density=rho, **numbers))
    s.add(structures.Truss("brace", a, c, area=1e-4 * metre**2, modulus=modulus, density=rho))
    s.add(structures.GroundSpring("ground", b, stiffness_x=30.0 * force / metre))
    s.add(structures.GroundRotationSpring("turn", c, stiffness_z=40.0 * moment))
    s.add(structures.PointMass("mass", c, mass=5.0 * kilogram))
    s.add(structures.PointInertia("inertia", b, inertia_z=0.7 * kilogram * metre**2))
    panel = {"thickness": 1e-4 * metre, "poisson": 0.3, "modulus": modulus, "density": rho}
    s.add(structures.Quadrilateral("panel", (a, d, c, b), **panel))
    s.support(a)
    s.support(d, ux=0.0, uy=0.01 * metre)
    s.load(b, fx=load, fy=-8.0 * force)
    s.load(c, mz=3.0 * moment)
    return s


def results(metre: float, kilogram: float, second: float) -> dict[str, np.ndarray]:
    """Numbers without units from every analysis, and gradients by logarithms of parameters."""
    model = frame(metre, kilogram, second).build()
    energy = kilogram * metre**2 / second**2
    p, results = model.nominal, {}

    def note(name: str, result, measures: dict[str, float]) -> None:
        assert result.status.success, (name, result.status)
        assert result.status.residual < 1e-8
        scales = np.array(list(measures.values()))
        results[name] = np.array([result.values(m) for m in measures]) / scales[:, None]
        last = [da.at(result.time[-1], m) for m in measures]
        gradient = da.sensitivity(result, last, method="adjoint").values
        results[f"{name}, gradient"] = gradient * p / scales[:, None]

    placed = {"c.ux": metre, "c.rz": 1.0, "strain_energy": energy, "top.moment_i": energy}
    note("statics", da.solve_statics(model), placed)
    note("nonlinear statics", da.solve_statics(model, nonlinear=True, steps=3), placed)
    path = da.solve_load_path(model, first=0.3, until=1.0)
    note("load path", path, placed | {"load_factor": 1.0})
    note("modes", da.solve_modes(model, 3), {"frequency": 1 / second})
    note("buckling", da.solve_buckling(model, 1), {"load_factor": 1.0})
    moved = {"c.ux": metre, "c.vrz": 1 / second, "kinetic_energy": energy}
    for nonlinear in (False, True):
        options = {"nonlinear": nonlinear, "step": 0.05 * second}
        motion = da.solve_transient(model, 0.5 * second, **options)
        note(f"transient, nonlinear={nonlinear}", motion, moved)
    return results


@cache
def reference() -> dict[str, np.ndarray]:
    """In metres, kilograms and seconds."""
    return results(1.0, 1.0, 1.0)


@pytest.mark.few(1)
@pytest.mark.parametrize("units", UNITS.values(), ids=UNITS)
def test_units_change_nothing_but_units(units):
    for name, numbers in results(*units).items():
        expected = reference()[name]
        size = np.abs(expected).max(axis=-1, keepdims=True)
        size[size == 0] = 1.0  # what has no influence has none
        np.testing.assert_allclose(numbers / size, expected / size, atol=1e-7, err_msg=name)
