"""Princeton beam: a flat aluminium cantilever bent about both axes by a weight at its end.

Experiments of Dowell and Traybar (1975). Deflections of the tip by the angle of the load to the
height of the section are those of beam elements of ANSYS (Obrezkov, Mikkola and Matikainen,
Performance review of locking alleviation methods for continuum ANCF beam elements, Nonlinear
Dynamics 109, 2022), as published with Exudyn (ANCFBeamTest).
"""

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial
from dalembert.structures import Material, rectangle

LENGTH, HEIGHT, WIDTH, WEIGHT = 0.508, 12.3777e-3, 3.2024e-3, 8.896
ALONG = [1.071417630e-2, 1.061328706e-2, 1.011169630e-2, 8.837226265e-3, 6.604665004e-3]
ALONG += [3.538889001e-3, 0.0]
ACROSS = [0.0, 4.208232124e-2, 7.939482948e-2, 0.108987937, 0.129887616, 0.142194370, 0.146245978]


@pytest.fixture(scope="module")
def model() -> da.Model:
    system = da.System("Princeton beam", gravity=(0, 0, 0))
    angle = system.parameter("angle", 0.0, "rad")
    section = rectangle(WIDTH, HEIGHT).spatial_beam(Material(71.7e9, 0.31, 2700.0))
    beam = system.add(
        spatial.Beam(
            "beam", system.ground.frame((0, 0, 0)), length=LENGTH, elements=1, order=3, **section
        )
    )
    load = (0.0, WEIGHT * da.cos(angle), WEIGHT * da.sin(angle))
    system.add(spatial.Force("weight", beam.end.center, load))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize("case", range(7))
def test_deflections_of_the_tip(model, case):
    equilibrium = da.solve_equilibrium(model, parameters={"angle": np.radians(15.0 * case)})
    assert equilibrium.status.success
    y, z = (float(equilibrium[f"beam.end.{axis}"][0]) for axis in "yz")
    np.testing.assert_allclose([y, z], [ALONG[case], ACROSS[case]], rtol=0.01, atol=1e-9)
