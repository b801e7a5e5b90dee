"""A tilted coin that spins on a smooth floor, beside the equation of its tilt.

Its centre moves vertically only; the angular momenta about the vertical, ``L``, and about its axis,
``I₃ ω₃``, are constant, and the tilt θ follows from Lagrange's equation with
``z = R sin θ + c cos θ`` and the effective potential ``(L − I₃ ω₃ cos θ)²/(2 I₁ sin² θ) + m g z``
(Goldstein, Classical Mechanics, 5.7).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import spatial

G, MASS, RADIUS, HALF, TILT, DURATION = 9.81, 0.1, 0.1, 0.002, 0.3, 0.2
ACROSS, ALONG = MASS * (3 * RADIUS**2 + 4 * HALF**2) / 12, MASS * RADIUS**2 / 2


def heights(spin: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Heights of the centre from the angular velocity at the start."""
    axis = np.array([0, -np.sin(TILT), np.cos(TILT)])
    own = ALONG * (spin @ axis)
    vertical = own * np.cos(TILT) + ACROSS * (spin[2] - spin @ axis * np.cos(TILT))

    def rates(t: float, state: np.ndarray) -> list[float]:
        tilt, rate = state
        sine, cosine = np.sin(tilt), np.cos(tilt)
        slope, bend = RADIUS * cosine - HALF * sine, -RADIUS * sine - HALF * cosine
        swing = vertical - own * cosine
        moment = swing * own / (ACROSS * sine) - swing**2 * cosine / (ACROSS * sine**3)
        moment += MASS * G * slope
        inertia = ACROSS + MASS * slope**2
        return [rate, (-moment - MASS * slope * bend * rate**2) / inertia]

    fine = {"rtol": 1e-11, "atol": 1e-13, "t_eval": times}
    tilt = solve_ivp(rates, (0.0, DURATION), [TILT, 0.0], **fine).y[0]
    return RADIUS * np.sin(tilt) + HALF * np.cos(tilt)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("scheme", "error"), [(da.AnticipatedImpacts(), 1e-4), (da.MoreauJean(), 6e-4)]
)
def test_coin_on_a_smooth_floor(scheme, error):
    """The tilt falls from 0.3 to 0.05 and returns; the centre sinks by 24 mm."""
    spin = np.array([0.0, -2.4, 8.0])
    system, contact = da.System("coin", gravity=(0, 0, -G)), spatial.contact
    start = {
        "position": (0, 0, RADIUS * np.sin(TILT) + HALF * np.cos(TILT)),
        "rotation": da.rotation.axis_angle((1, 0, 0), TILT),
        "angular_velocity": tuple(spin),
    }
    sizes = {"radius": RADIUS, "length": 2 * HALF, "mass": MASS}
    coin = system.add(spatial.Cylinder("coin", **sizes, **start))
    ends = coin.point(0, 0, -HALF), coin.point(0, 0, HALF)
    floor = contact.HalfSpace(system.ground.frame())
    system.add(spatial.Collisions("floor", [contact.Cylinder(*ends, RADIUS), floor]))
    motion = da.solve_nonsmooth(system.build(), DURATION, step=1e-3, integrator=scheme)
    assert motion.status.success
    exact = heights(spin, np.asarray(motion.time))
    assert np.ptp(exact) > 0.024
    np.testing.assert_allclose(motion["coin.z"].values, exact, atol=error)
