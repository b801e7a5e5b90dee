"""A flexible shaft with a disc at its middle: its sag, and the speed at which it whirls.

Data of the benchmark of Bauchau, Betsch, Cardona, Gerstmayr, Jonker, Masarati and Sonneville
(Validation of flexible multibody dynamics beam formulations using benchmark problems, Multibody
System Dynamics 37, 2016), which runs it up from 48 to 72 rad/s; both ends hold its slope. The sag
is that of Timoshenko's beam in closed form, and the critical speed is its lowest frequency with the
disc, from its exact dynamic stiffness: forward and backward whirl agree in a mode that does not
tilt the disc.
"""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import dalembert as da
from dalembert import spatial

LENGTH, EI, GA, GJ, EA = 6.0, 354.5e3, 60.5e6, 272.7e3, 313.4e6
MASS, DISC, RADIUS, G = 7800 * np.pi * (0.05**2 - 0.045**2), 70.573, 0.24, 9.81
ROTARY = 7800 * np.pi / 4 * (0.05**4 - 0.045**4)


@pytest.fixture(scope="module")
def shaft() -> da.Model:
    system = da.System("shaft", gravity=(0, 0, -G))
    ground, about = system.ground, DISC * RADIUS**2 / 2
    disc = spatial.Body(
        "disc",
        mass=DISC,
        inertia=(about, about / 2, about / 2),
        position=(LENGTH / 2, 0, 0),
        rotation=np.eye(3),
    )
    system.add(disc)
    section = {
        "axial_rigidity": EA,
        "shear_rigidity": GA,
        "torsional_rigidity": GJ,
        "bending_rigidity_y": EI,
        "bending_rigidity_z": EI,
        "mass_per_length": MASS,
        "rotary_inertia": (2 * ROTARY, ROTARY, ROTARY),
        "length": LENGTH / 2,
        "elements": 1,
    }
    system.add(spatial.Beam("left", ground.frame((0, 0, 0)), disc.frame((0, 0, 0)), **section))
    right = system.add(spatial.Beam("right", disc.frame((0, 0, 0)), **section))
    last, along = right.end.frame((0, 0, 0), axis=(1, 0, 0)), {"axis": (1, 0, 0)}
    system.add(spatial.Prismatic("slide", ground.frame((LENGTH, 0, 0), **along), last))
    return system.build()


@pytest.mark.thorough
def test_sag(shaft):
    equilibrium = da.solve_equilibrium(shaft)
    assert equilibrium.status.success
    bending = DISC * G * LENGTH**3 / (192 * EI) + MASS * G * LENGTH**4 / (384 * EI)
    shearing = DISC * G * LENGTH / (4 * GA) + MASS * G * LENGTH**2 / (8 * GA)
    assert float(equilibrium["disc.z"][0]) == pytest.approx(-bending - shearing, rel=1e-3)


def critical_speed() -> float:
    """Of half the shaft: clamped, and guided with half the disc."""

    def unbalanced(w: float) -> float:
        # deflection, turn of the section, moment, shear force along half the shaft
        rates = np.zeros((4, 4))
        rates[0, 1], rates[0, 3] = 1, 1 / GA
        rates[1, 2], rates[2, 3] = 1 / EI, -1
        rates[2, 1], rates[3, 0] = -ROTARY * w**2, -MASS * w**2
        along = expm(rates * LENGTH / 2)[:, 2:]  # the clamped end has a moment and a force
        guided = np.stack([along[1], along[3] - DISC / 2 * w**2 * along[0]])
        return float(np.linalg.det(guided))

    return brentq(unbalanced, 30.0, 80.0)


def test_speed_at_which_it_whirls(shaft):
    frequencies = 2 * np.pi * da.linearize(shaft).data["frequency"].values
    lowest = np.sort(frequencies)[:2]  # up and down, and across
    assert 48 < critical_speed() < 72  # the run-up of the benchmark passes it
    np.testing.assert_allclose(lowest, critical_speed(), rtol=2e-3)
