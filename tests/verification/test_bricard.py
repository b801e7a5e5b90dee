"""IFToMM A04, Bricard mechanism: six hinges in one loop, one freedom, one redundant equation.

Source: IFToMM library of computational benchmark problems, problem A04 (M. González et al. 2006):
five rods of 1 m and 1 kg and the ground, released at rest. Positions of the observed point by an
independent integration: the loop by arc length, the energy as the equation of the one freedom.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial

POINTS = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], float)
AXES = np.array([(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)], float)
ALONG, ACROSS = 1 / 600, 1.01 / 12
"""Of a square section of 0.1 m and 100 kg/m³."""
OBSERVED = {
    0.25: (0.9400569683, -0.9983080640, -0.0581464481),
    0.5: (0.7747178080, -0.9798150477, -0.1999061590),
    1.0: (0.2744813193, -0.8867079387, -0.4623300027),
    1.5: (-0.2790175754, -0.8873613788, -0.4610745963),
    2.0: (-0.7781353730, -0.9803526834, -0.1972526706),
    2.5: (-0.9999831853, -0.9999999999, -0.0000168146),
    5.0: (0.9999327423, -0.9999999977, -0.0000672554),
    10.0: (0.9997309873, -0.9999999639, -0.0002689765),
}


def mechanism() -> da.System:
    system = da.System("Bricard", gravity=(0.0, -9.81, 0.0))
    carriers, origins = [system.ground], [np.zeros(3)]
    for k in range(5):
        start, end = POINTS[k], POINTS[k + 1]
        direction, middle = end - start, (start + end) / 2
        rod = spatial.Body(
            f"rod{k + 1}",
            mass=1.0,
            inertia=tuple(np.where(abs(direction) > 0.5, ALONG, ACROSS)),
            position=tuple(middle),
            rotation=da.rotation.identity(),
            points={"end": tuple(end - middle)},
        )
        carriers.append(system.add(rod))
        origins.append(middle)
    for k in range(6):
        frames = [
            carriers[n].frame(tuple(POINTS[k] - origins[n]), axis=tuple(AXES[k]))
            for n in (k, (k + 1) % 6)
        ]
        system.add(spatial.Revolute(f"J{k}", *frames))
    return system


@pytest.fixture(scope="module")
def model() -> da.Model:
    return mechanism().build()


def test_one_freedom_and_one_redundant_equation_are_told(model):
    diagnosis = model.diagnosis
    assert (diagnosis.degrees_of_freedom, diagnosis.gruebler) == (1, 0)
    (redundancy,) = diagnosis.redundancies
    assert {redundancy.joint, *redundancy.shared_with} == {f"J{k}" for k in range(6)}


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "formulation",
    [da.AugmentedLagrangian(), da.RangeSpace()],
    ids=["all equations kept", "one left out"],
)
def test_ten_seconds(model, formulation):
    """Within 1e-5; the published criterion of the energy is 1e-3 J."""
    motion = da.solve_dynamics(
        model,
        10.0,
        formulation=formulation,
        integrator=da.DormandPrince(1e-8, 1e-8),
        outputs=list(OBSERVED),
    )
    assert motion.status.success, motion.status
    computed = np.stack([motion[f"rod2.end.{axis}"].values for axis in "xyz"], axis=1)
    np.testing.assert_allclose(computed, list(OBSERVED.values()), atol=1e-6)
    np.testing.assert_allclose(motion["balance_error"], 0.0, atol=1e-5)
    assert float(motion["position_violation"].max()) <= 1e-12
