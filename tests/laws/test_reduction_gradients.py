"""Reduced matrices and floating shapes follow the parameters: by slopes and by differences."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from flexible_bodies import ENDS, tapered

import dalembert as da
from dalembert.elements.flexible.shapes import SectionShapes
from dalembert.model.assembled.reduction.slopes import ReductionSlopes
from dalembert.structures import Frame, rectangle_mesh


def frames():
    """Beams whose places, sections and masses are parameters."""
    structure = da.Structure("beam")
    length, area = structure.parameter("L", 1.3), structure.parameter("A", 0.02)
    modulus, density = structure.parameter("E", 3.0), structure.parameter("rho", 1.1)
    nodes = [structure.node(f"n{k}", length * k / 6, 0.02 * length * k) for k in range(7)]
    for k in range(6):
        inertia = area**2 / 12 * (1 + 0.1 * k)
        numbers = {"area": area, "second_moment": inertia, "modulus": modulus}
        structure.add(Frame(f"e{k}", nodes[k], nodes[k + 1], density=density, **numbers))
    return structure.build(), {"root": "n0", "tip": "n6"}


def plate():
    """Solid elements, whose interfaces are faces that a parameter stretches."""
    structure = da.Structure("plate")
    height, modulus = structure.parameter("h", 0.3), structure.parameter("E", 2.0)
    points, cells = rectangle_mesh((1.0, 1.0), (5, 2))
    stretched = np.array([[x, height * y] for x, y in points], dtype=object)
    numbers = {"modulus": modulus, "poisson": 0.3, "density": 1.0, "thickness": height}
    nodes = structure.add_mesh("m", (stretched, cells), **numbers).nodes()
    left, right = (nodes[np.flatnonzero(points[:, 0] == x)] for x in (0.0, 1.0))
    return structure.build(), {"root": left, "tip": right}


CASES = {"frames": frames, "plate": plate}


@pytest.mark.parametrize("name", CASES)
def test_forwards_and_backwards_agree(name):
    model, ends = CASES[name]()
    slopes = ReductionSlopes(model.craig_bampton(ends, 3), model.degrees)
    rng = np.random.default_rng(1)
    size = slopes.reduced.stiffness.shape
    bars = [rng.normal(size=size) for _ in range(2)]
    dp = rng.normal(size=model.nominal.size) * model.nominal
    forwards = sum(float(np.sum(b * c)) for b, c in zip(bars, slopes.push(dp), strict=True))
    assert slopes.pull(*bars) @ dp == pytest.approx(forwards, rel=1e-9)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("parameter", [0, 1])
def test_frequencies_of_the_reduced_structure(name, parameter):
    """Of the clamped one, whose slopes no basis of the shapes changes, against differences."""
    model, ends = CASES[name]()

    def clamped(p):
        reduced = model.craig_bampton(
            ends, 3, parameters=dict(zip(model.parameters, p, strict=True))
        )
        free = slice(reduced.columns["tip"].start, None)
        return reduced, [m[free, free] for m in (reduced.stiffness, reduced.mass)], free

    reduced, (k, m), free = clamped(model.nominal)
    squares, vectors = scipy.linalg.eigh(k, m)
    dp = np.zeros(model.nominal.size)
    dp[parameter] = 1.0
    dk, dm = (c[free, free] for c in ReductionSlopes(reduced, model.degrees).push(dp))
    computed = [v @ (dk - w * dm) @ v for w, v in zip(squares, vectors.T, strict=True)]
    step = 1e-4 * model.nominal[parameter]
    ends_of = [
        scipy.linalg.eigvalsh(*clamped(model.nominal + s * step * dp)[1]) for s in (-2, -1, 1, 2)
    ]
    one, two = (ends_of[2] - ends_of[1]) / (2 * step), (ends_of[3] - ends_of[0]) / (4 * step)
    np.testing.assert_allclose(computed, (4 * one - two) / 3, rtol=1e-6, atol=1e-8 * squares.max())


FLOATING = CASES | {"space": lambda: (tapered(3), ENDS)}


def _tables(shapes) -> list[np.ndarray]:
    numbers = [shapes.inertia, shapes.stiffness, shapes.critical]
    for section in shapes.sections.values():
        numbers += [section.place, section.shift, section.turn]
    return numbers


def _numbers(shapes) -> list[np.ndarray]:
    return [table.ravel() for table in (*_tables(shapes), shapes.origin)]


@pytest.mark.few(4)
@pytest.mark.parametrize("name", FLOATING)
@pytest.mark.parametrize(("frame", "second"), [("root", False), ("mean", False), ("root", True)])
def test_numbers_of_floating_shapes(name, frame, second):
    """Inertia, stiffness, damping and sections, away from where the shapes were chosen.

    Forwards against differences, backwards against forwards.
    """
    model, ends = FLOATING[name]()
    modes = 0 if second else 2
    following = model.following(ends, modes, frame=frame, second_order=second)
    values = {n: 1.05 * v for n, v in zip(model.parameters, model.nominal, strict=True)}
    parameter = next(iter(model.parameters))
    slopes = following.push(values, {parameter: 1.0})
    step = 2e-3 * values[parameter]
    ahead = [
        _numbers(following.at(values | {parameter: values[parameter] + o * step}))
        for o in (-1.0, -0.5, 0.5, 1.0)
    ]
    at = _numbers(following.at(values))
    for computed, here, *four in zip(_numbers(slopes), at, *ahead, strict=True):
        expected = np.array([1 / 6, -4 / 3, 4 / 3, -1 / 6]) @ np.array(four) / step
        size = np.abs(here).max(initial=0.0) / values[parameter]
        np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-7 * size + 1e-300)
    weights = [np.random.default_rng(2).normal(size=x.shape) for x in _tables(slopes)]
    forwards = sum(float(np.sum(w * x)) for w, x in zip(weights, _tables(slopes), strict=True))
    inertia, stiffness, critical, *rest = weights
    sections = {
        label: SectionShapes(*rest[3 * k : 3 * k + 3]) for k, label in enumerate(slopes.sections)
    }
    weighed = replace(
        slopes,
        inertia=inertia,
        stiffness=stiffness,
        critical=critical,
        mass=np.zeros_like(stiffness),
        sections=sections,
    )
    backwards = following.pull(values, weighed, [parameter]).item()
    assert backwards == pytest.approx(forwards, rel=1e-9)
