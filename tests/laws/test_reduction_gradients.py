"""Reduced matrices follow the parameters: forwards, backwards and by differences."""

import numpy as np
import pytest
import scipy.linalg

import dalembert as da
from dalembert.structures import Frame, rectangle_mesh
from dalembert.structures.reduction.slopes import ReductionSlopes


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
    found = [v @ (dk - w * dm) @ v for w, v in zip(squares, vectors.T, strict=True)]
    step = 1e-4 * model.nominal[parameter]
    ends_of = [
        scipy.linalg.eigvalsh(*clamped(model.nominal + s * step * dp)[1]) for s in (-2, -1, 1, 2)
    ]
    one, two = (ends_of[2] - ends_of[1]) / (2 * step), (ends_of[3] - ends_of[0]) / (4 * step)
    np.testing.assert_allclose(found, (4 * one - two) / 3, rtol=1e-6, atol=1e-8 * squares.max())
