"""IFToMM A02, double four-bar: parallel cranks and couplers, all uniform rods of 1 m and 1 kg.

Source: IFToMM library of computational benchmark problems, problem A02. Started with the cranks
up and the first crank's end moving at 1 m/s. The cranks stay parallel, so the motion reduces to
``[(N + 1)/3 + N] φ̈ = −[(N + 1)/2 + N] g cos φ``. All bars align at φ = 0, a singular position;
the first comparison ends before it.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

G = 9.81


def mechanism(count: int = 2) -> da.System:
    system = da.System("double-four-bar", gravity=(0.0, -G))
    cranks = [
        system.add(
            planar.Bar(
                f"crank{k}",
                length=1.0,
                mass=1.0,
                angle=np.pi / 2,
                position=(k, 0.5),
                angular_velocity=-1.0,
                velocity=(0.5, 0.0),
            )
        )
        for k in range(count + 1)
    ]
    for k, crank in enumerate(cranks):
        system.add(planar.Revolute(f"O{k}", system.ground.point(k, 0), crank.start))
    for k in range(count):
        bar = system.add(
            planar.Bar(
                f"coupler{k}",
                length=1.0,
                mass=1.0,
                angle=0.0,
                position=(k + 0.5, 1.0),
                velocity=(1.0, 0.0),
            )
        )
        system.add(planar.Revolute(f"A{k}", cranks[k].end, bar.start))
        system.add(planar.Revolute(f"B{k}", bar.end, cranks[k + 1].end))
    return system


def nearly_level(t, state):
    return state[0] - 0.05


nearly_level.terminal = True


def exact(times, through: bool = False, count: int = 2):
    """Angle and its rate by the one equation of the motion."""
    ratio = ((count + 1) / 2 + count) / ((count + 1) / 3 + count)

    def flow(t, state):
        return [state[1], -ratio * G * np.cos(state[0])]

    events = None if through else nearly_level
    start = [np.pi / 2, -1.0]
    return solve_ivp(flow, (0, 10), start, "DOP853", times, events=events, rtol=1e-13, atol=1e-14)


def test_motion_up_to_the_singular_position():
    end = exact(None).t[-1]
    times = np.linspace(0, end, 6)[1:-1]
    angle = exact(times).y[0]
    motion = da.solve_dynamics(
        mechanism().build(), end, integrator=da.DormandPrince(1e-12, 1e-12), outputs=times
    )
    expected = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    computed = motion.data.point_position.sel(point="crank0.end").values
    np.testing.assert_allclose(computed, expected, atol=1e-8)
    np.testing.assert_allclose(motion.data.balance_error, 0.0, atol=1e-8)


def test_reduced_motion_has_the_printed_positions():
    """The one equation, started past no singularity of its own, gives the published table."""
    times = [1.0, 2.0, 4.0, 5.0, 10.0]
    printed = [
        (-0.195020301949, -0.980799205662),
        (0.057815795768, 0.998327267863),
        (0.117616102376, 0.993059138451),
        (-0.811310461000, -0.584615545356),
        (0.328458111534, 0.944518538181),
    ]
    angle = exact(times, through=True).y[0]
    np.testing.assert_allclose(np.stack([np.cos(angle), np.sin(angle)], axis=1), printed, atol=1e-9)


def test_one_degree_of_freedom_and_no_redundancy():
    diagnosis = mechanism().build().diagnosis
    assert diagnosis.degrees_of_freedom == 1
    assert not diagnosis.redundancies


@pytest.mark.thorough
def test_forty_windows_through_singular_positions():
    """81 bars in 40 loops, 5 s; no step ends exactly where all bars align."""
    motion = da.solve_dynamics(mechanism(40).build(), 5.0, step=0.002, outputs=2)
    angle = exact([5.0], through=True, count=40).y[0, 0]
    computed = motion.data.point_position.sel(point="crank0.end").values[-1]
    np.testing.assert_allclose(computed, [np.cos(angle), np.sin(angle)], atol=1e-5)
