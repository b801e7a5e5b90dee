"""A column that stretches and shears: the load at which it buckles, in closed form.

Linearised about the straight, shortened column, Reissner's beam has
``E I φ″ + P (1 + P/G A_s − P/E A) φ = 0``, so that a clamped and free one of length L buckles at

    P (1 + P (1/G A_s − 1/E A)) = π² E I / 4 L²

(Haringx 1948; Reissner 1972): half a per cent below Euler's load for a stout bar of ten heights.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import dalembert as da
from dalembert import planar

LENGTH, MODULUS, HEIGHT = 1.0, 1e9, 0.1
EA, EI, GA = MODULUS * HEIGHT**2, MODULUS * HEIGHT**4 / 12, MODULUS / 2.6 * HEIGHT**2 * 5 / 6


@pytest.fixture(scope="module")
def column() -> da.Model:
    system = da.System("column", gravity=(0, 0))
    load = system.parameter("load", 0.0, "N")
    rigid = {"axial_rigidity": EA, "shear_rigidity": GA, "bending_rigidity": EI}
    beam = planar.Beam("column", system.ground.center, length=LENGTH, mass_per_length=10.0, **rigid)
    system.add(beam)
    system.add(planar.Force("weight", beam.end.center, (-load, 0)))
    return system.build()


def test_load_at_which_it_buckles(column):
    euler, soft = np.pi**2 * EI / (4 * LENGTH**2), 1 / GA - 1 / EA
    expected = (np.sqrt(1 + 4 * soft * euler) - 1) / (2 * soft)
    assert 0.99 < expected / euler < 0.997

    def growth(load: float) -> float:
        """Square of the slowest rate, negative while it swings."""
        modes = da.linearize(column, parameters={"load": load}).data
        rate = modes["eigenvalue_real"].values + 1j * modes["eigenvalue_imag"].values
        return float((rate[np.argmin(abs(rate))] ** 2).real)

    root = brentq(growth, 0.99 * euler, euler, xtol=1e-4)
    assert root == pytest.approx(expected, rel=1e-6)
