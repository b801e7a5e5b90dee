"""The examples of structures and their numbers, found elsewhere.

The numbers come from closed forms, from the one equation of a mechanism with one freedom, from
published solutions, or from a calculation by hand; none is recorded from our own output.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from example_runs import numbers, script
from scipy.integrate import solve_ivp
from scipy.optimize import minimize


def test_truss_by_the_method_of_sections(pictures: Path) -> None:
    printed = numbers("truss", pictures)
    height, load = 1.6, 30e3
    moment = 1.5 * load * 3 - load * 2  # about u1 of the forces on the left
    assert printed["force in the bottom chord [N]"] == pytest.approx(moment / height, rel=1e-9)
    diagonal = -1.5 * load * math.hypot(1, height) / height
    assert printed["force in the first diagonal [N]"] == pytest.approx(diagonal, rel=1e-9)
    assert printed["reaction on the left, wind [N]"] == pytest.approx(-20e3, rel=1e-9)

    def lightest(height: float) -> float:  # statically determinate: least areas for given stresses
        chord = moment / height / 120e6
        web = 1.5 * load * math.hypot(1, height) / height / 90e6
        return 7850 * (chord * 10 + web * 6 * math.hypot(1, height))

    least = minimize(lambda h: lightest(h[0]), [1.6], bounds=[(0.8, 3.0)], tol=1e-12).fun
    assert printed["lightest mass [kg]"] == pytest.approx(least, rel=1e-6)
    assert printed["stress in the chord of the lightest [Pa]"] == pytest.approx(120e6, rel=1e-6)


def test_plate_bends_like_a_beam(pictures: Path) -> None:
    printed = numbers("plate", pictures)
    assert printed["force on the end [N]"] == pytest.approx(9 * 2000.0, rel=1e-12)
    assert printed["deflection of the end [m]"] == pytest.approx(
        printed["deflection of a beam [m]"], rel=0.02
    )
    energy = printed["strain energy [J]"]  # inversely proportional to the thickness
    assert printed["its derivative by the thickness [J/m]"] == pytest.approx(
        -energy / 0.01, rel=1e-9
    )


def test_ten_bar_truss_is_the_published_one(pictures: Path) -> None:
    """Weight 5060.85 lb with the published areas; deflection and the stress of bar 4 at limits."""
    printed = numbers("ten_bar_truss", pictures)
    assert printed["weight"] == pytest.approx(5060.85, rel=1e-5)
    assert printed["area of bar 0"] == pytest.approx(30.5218, rel=1e-4)
    assert printed["deflection"] == pytest.approx(2.0, abs=1e-6)


@pytest.mark.thorough
def test_tuned_mass_against_the_first_mode_alone(pictures: Path) -> None:
    """One mode of the cantilever, φ(L) = 1: mass m L/4, of which 0.3915 m L feel the ground."""
    printed, tower = numbers("tuned_mass", pictures), script("tuned_mass")
    modal, felt = tower.MASS * tower.HEIGHT / 4, 0.391496 * tower.MASS * tower.HEIGHT
    beta = 2 * tower.DAMPING / tower.OMEGA

    def ground(time):
        return 0.02 * np.sin(tower.OMEGA * time) * np.exp(-(((time - 4.0) / 2.0) ** 2))

    def shaken(time, h=1e-3):
        """Acceleration of the ground."""
        return (ground(time - h) - 2 * ground(time) + ground(time + h)) / h**2

    def largest(share):
        mass, spring = share * modal, share * modal * tower.OMEGA**2 / (1 + share) ** 2

        def rate(time, s):
            sway, hung, speed, hung_speed = s
            stretch = hung - sway + beta * (hung_speed - speed)
            bent = tower.OMEGA**2 * modal * (sway + beta * speed)
            pull = (spring * stretch - bent - felt * shaken(time)) / modal
            return speed, hung_speed, pull, -spring * stretch / max(mass, 1e-9) - shaken(time)

        times = np.linspace(0, tower.DURATION, 2001)
        run = solve_ivp(rate, (0, tower.DURATION), np.zeros(4), t_eval=times, rtol=1e-6, atol=1e-8)
        return run.y[0].max()

    assert printed["without"] == pytest.approx(largest(0.0), rel=0.02)
    assert printed["with"] == pytest.approx(largest(tower.SHARE), rel=0.02)
    assert printed["slope of rms"] == pytest.approx(printed["difference of rms"], rel=1e-6)


def test_marimba_bar_sounds_one_four_ten(pictures: Path) -> None:
    """Tuned as asked; without shear an even bar has the ratios of cos βL cosh βL = 1."""
    printed = numbers("marimba_bar", pictures)
    roots = np.array([4.730040745, 7.853204624, 10.99560784]) ** 2
    assert printed["even second"] == pytest.approx(roots[1] / roots[0], rel=1e-3)
    assert printed["even third"] == pytest.approx(roots[2] / roots[0], rel=1e-3)
    assert printed["success"]
    assert printed["first"] == pytest.approx(261.63, rel=1e-8)
    assert (printed["second"], printed["third"]) == pytest.approx((4.0, 10.0), rel=1e-8)
    assert printed["first, finer"] == pytest.approx(261.63, rel=1e-3)
    assert printed["third, finer"] == pytest.approx(2616.3, rel=5e-3)
