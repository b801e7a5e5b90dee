"""Craig–Bampton reduction of a beam held at both ends, and its cantilever.

L = EI = ρA = 1, 40 elements, both end sections as interfaces, k modes between them. Clamped–clamped
and clamped–free roots of the Euler–Bernoulli beam (Blevins, Formulas for natural frequency and mode
shape, 1979): ω = 22.37329, 61.67282, 120.90339 and 3.516015, 22.034492, 61.697214; one Hermite
element has 3.532732, 34.80689. The other digits are those of an independent reduction.
"""

import numpy as np
import pytest
import scipy.linalg

import dalembert as da
from dalembert.structures import Frame

FIXED = [22.37329, 61.67289, 120.90387]
CANTILEVER = {
    0: [3.532732, 34.80689],
    1: [3.517235, 22.126483],
    2: [3.516221, 22.058532, 61.925408],
}
EXACT = [3.516015, 22.034492, 61.697214]


def beam(count: int = 40):
    structure = da.Structure("beam")
    nodes = [structure.node(f"n{k}", k / count, 0.0) for k in range(count + 1)]
    section = {"area": 1.0, "second_moment": 1e-6, "modulus": 1e6, "density": 1.0}
    for k in range(count):
        structure.add(Frame(f"e{k}", nodes[k], nodes[k + 1], **section))
    return structure.build()


@pytest.fixture(scope="module")
def model():
    return beam()


@pytest.mark.parametrize("modes", CANTILEVER)
def test_cantilever_of_the_reduced_beam(model, modes):
    reduced = model.craig_bampton(["n0", "n40"], modes)
    np.testing.assert_allclose(reduced.frequencies, FIXED[:modes], rtol=3e-7)
    free = slice(reduced.columns["n0"].stop, None)
    squares = scipy.linalg.eigvalsh(reduced.stiffness[free, free], reduced.mass[free, free])
    expected = CANTILEVER[modes]
    np.testing.assert_allclose(np.sqrt(squares[: len(expected)]), expected, rtol=3e-7)


def test_frequencies_fall_to_the_exact_ones(model):
    computed = model.floating(["n0", "n40"], 12, frame="n0").frequencies[:3]
    np.testing.assert_allclose(computed, EXACT, rtol=2e-5)
    assert np.all(computed >= EXACT)


def test_modes_up_to_a_frequency(model):
    reduced = model.craig_bampton(["n0", "n40"], 10, up_to=100.0)
    np.testing.assert_allclose(reduced.frequencies, FIXED[:2], rtol=3e-7)
