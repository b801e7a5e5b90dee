"""The examples of mechanisms in motion and their numbers, found elsewhere.

The numbers come from closed forms, from the one equation of a mechanism with one freedom, from
published solutions, or from a calculation by hand; none is recorded from our own output.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from example_runs import model, motion, numbers, script, value
from one_freedom import FourBar, G, reduced_motion, slider_crank, slider_crank_inertia, slope
from scipy.integrate import solve_ivp

import dalembert as da


def test_four_bar_follows_its_one_equation(pictures: Path) -> None:
    bars = FourBar((0.3, 1.0, 0.6), (1.5, 5.0, 3.0), (1.0, 0.0), 1)
    angle = reduced_motion(bars.inertia, bars.potential, math.pi / 2, 1.0, 8.0)
    assert value("four_bar", "angle") == pytest.approx(angle, abs=1e-3)  # step of 5 ms
    fine = da.solve_dynamics(
        model("four_bar"), 8.0, outputs=3, integrator=da.DormandPrince(1e-11, 1e-11)
    )
    assert float(fine["crank.angle"][-1]) == pytest.approx(angle, abs=1e-7)
    assert numbers("four_bar", pictures)["energy error"] < 1e-4


def one_mode_of_a_rod(
    r: float, l: float, speed: float, mass: float, rigidity: float, piston: float
):
    """Largest bend of a pinned rod by its first sine mode, in the motion of rigid links.

    ``q̈ + (ω² − ψ̇² + P) q = −4/π a_n − 2/π l ψ̈`` with the share ``P`` of the axial force, which the
    piston and the inertia of the rod make.
    """
    x = np.linspace(0, l, 41)
    first = (np.pi / l) ** 4 * rigidity / mass

    def rates(t, y):
        angle, tilt = speed * t, -math.asin(r / l * math.sin(speed * t))
        spin = -r / l * speed * math.cos(angle) / math.cos(tilt)
        swing = (r / l * speed**2 * math.sin(angle) + math.sin(tilt) * spin**2) / math.cos(tilt)
        along = np.array([math.cos(tilt), math.sin(tilt)])
        across = np.array([-along[1], along[0]])
        pin = -(speed**2) * r * np.array([math.cos(angle), math.sin(angle)])
        push = -piston * (pin + swing * l * across - spin**2 * l * along)[0]
        moment = mass * l**3 / 3 * swing + mass * l**2 / 2 * (along[0] * pin[1] - along[1] * pin[0])
        side = (moment + l * along[1] * push) / (l * along[0])
        force = along @ [push, side]
        axial = force - mass * (along @ pin * (l - x) - spin**2 * (l**2 - x**2) / 2)
        share = np.trapezoid(axial * np.cos(np.pi * x / l) ** 2, x) * 2 / (mass * l)
        load = -(4 / np.pi * (across @ pin) + 2 / np.pi * l * swing)
        return [y[1], load - (first - spin**2 + share * (np.pi / l) ** 2) * y[0]]

    times = np.linspace(0, 0.05, 201)
    reference = solve_ivp(rates, (0, 0.05), [0.0, 0.0], t_eval=times, rtol=1e-8, atol=1e-12)
    return float(np.abs(reference.y[0]).max())


@pytest.mark.thorough
def test_elastic_rod_bends_as_its_first_mode(pictures: Path) -> None:
    rod = script("elastic_slider_crank")
    mass, rigidity = rod.DENSITY * rod.WIDTH**2, rod.MODULUS * rod.WIDTH**4 / 12
    bend = one_mode_of_a_rod(rod.CRANK, rod.ROD, rod.SPEED, mass, rigidity, 0.0755)
    printed = numbers("elastic_slider_crank", pictures)
    assert printed["bend"] == pytest.approx(bend, rel=0.01)
    assert printed["linear"] > 1.1 * bend


def test_slider_crank_torque_is_that_of_virtual_work(pictures: Path) -> None:
    r, l, speed = 0.05, 0.18, 20 * math.pi
    run = motion("slider_crank")
    q = speed * run.time
    x, dx = slider_crank(q, r, l)
    assert np.abs(run["piston.x"].values - x).max() < 1e-13
    gas = -1500 * (1 + np.tanh(dx * speed / 0.2)) / 2
    inertia = slope(lambda q: slider_crank_inertia(q, r, l, 0.9, 0.6, 0.8), q) * speed**2 / 2
    torque = inertia + G * (0.9 + 0.6) * r / 2 * np.cos(q) - gas * dx
    np.testing.assert_allclose(run["motor.effort"].values, torque, atol=1e-9)
    assert numbers("slider_crank", pictures)["piston_speed"] == pytest.approx(
        (dx * speed).max(), rel=1e-12
    )


def test_shaper_has_its_time_ratio_and_stroke(pictures: Path) -> None:
    printed, half = numbers("quick_return_shaper", pictures), math.asin(0.1 / 0.3)
    assert printed["time_ratio"] == pytest.approx(
        (math.pi + 2 * half) / (math.pi - 2 * half), abs=1e-10
    )
    assert printed["stroke"] == pytest.approx(2 * 0.55 * 0.1 / 0.3, abs=1e-12)


def test_excavator_holds_its_bucket_and_digs_as_long_as_its_pump_takes(pictures: Path) -> None:
    printed = numbers("excavator", pictures)
    assert printed["held"] == pytest.approx(printed["by_hand"], rel=1e-9)
    flow = 1800 / 60 * 90e-6  # m^3/s, turns per second by volume per turn
    area = math.pi * 0.12**2 / 4
    volume = area * (2 * 0.18 + 0.5 + 0.17)  # the boom goes down and up again
    assert printed["lasts"] == pytest.approx(2 * volume / flow, rel=1e-12)
    assert 0.9 < printed["depth"] < 1.0
    run = motion("excavator")
    work = sum(run.values(f"{name}_cylinder.power") for name in ("boom", "stick", "bucket"))
    soil = run.values("resistance.force.x*bucket.tooth.vx + resistance.force.y*bucket.tooth.vy")
    stored = run.values("kinetic_energy + potential_energy")
    done = np.trapezoid(work + soil, run.time)
    assert done == pytest.approx(stored[-1] - stored[0], abs=2e-3 * np.trapezoid(-soil, run.time))


def test_sewing_machine_counts_and_loops(pictures: Path) -> None:
    printed = numbers("sewing_machine", pictures)
    assert (printed["coordinates"], printed["equations"], printed["degrees of freedom"]) == (
        18,
        17,
        1,
    )
    assert printed["needle stroke"] == pytest.approx(2 * 0.015, abs=1e-12)
    run = motion("sewing_machine")
    q = run["crank.angle"].values
    needle = 0.015 * np.sin(q) - np.sqrt(0.045**2 - (0.015 * np.cos(q)) ** 2) - 0.06
    assert np.abs(run["needle_bar.needle.y"].values - needle).max() < 1e-14
    a, o = 0.011 * np.exp(1j * (q + 0.9)), -0.026 + 0.03j  # the plane as complex numbers
    d = o - a
    cosine = (abs(d) ** 2 + 0.026**2 - 0.03**2) / (2 * 0.026 * abs(d))
    lever = d / abs(d) * (cosine - 1j * np.sqrt(1 - cosine**2))  # the pin lies right of the line
    eye = a + lever * (0.06 + 0.012j)
    assert np.abs(run["take_up.eye.x"].values - eye.real).max() < 1e-14
    assert np.abs(run["take_up.eye.y"].values - eye.imag).max() < 1e-14


@pytest.mark.thorough
def test_n_four_bar_follows_its_one_equation(pictures: Path) -> None:
    factor = (1.5 + 2) / (1 + 2) * G

    def rate(_, s):
        return s[1], -factor * math.cos(s[0])

    solved = solve_ivp(rate, (0, 0.6), (math.pi / 2, -1.0), method="DOP853", rtol=1e-13, atol=1e-13)
    angle = solved.y[0, -1]
    assert value("n_four_bar", "x") == pytest.approx(math.cos(angle), abs=1e-11)
    assert value("n_four_bar", "y") == pytest.approx(math.sin(angle), abs=1e-11)
    speed = float(motion("n_four_bar")["crank2.angular_velocity"][-1])
    assert speed**2 == pytest.approx(1 + 2 * factor * (1 - math.sin(angle)), rel=1e-10)
    assert max(numbers("n_four_bar", pictures).values()) < 1e-10


def test_spring_pendulum_modes_and_motion(pictures: Path) -> None:
    printed = numbers("spring_pendulum", pictures)
    assert printed["bounce [Hz]"] == pytest.approx(math.sqrt(39.24) / (2 * math.pi), rel=1e-10)
    assert printed["swing [Hz]"] == pytest.approx(
        math.sqrt(G) / (2 * math.pi), rel=1e-10
    )  # 1 m long

    def rate(_, s):
        pull = 39.24 * (1 - 0.75 / math.hypot(s[0], s[1]))
        return s[2], s[3], -pull * s[0], -pull * s[1] - G

    exact = solve_ivp(
        rate, (0, 30), (0.03, -1.15, 0, 0), method="DOP853", rtol=1e-12, atol=1e-12
    ).y[:, -1]
    assert value("spring_pendulum", "x") == pytest.approx(exact[0], abs=2e-5)
    assert value("spring_pendulum", "y") == pytest.approx(exact[1], abs=2e-5)


def test_sliding_pendulum_against_published(pictures: Path) -> None:
    published = (0.290985380740065, -0.177394633452164, 0.286809855735754, 1.71766036161997)
    exact = (0.29098559552745, -0.17739580965382, 0.28680948821451, 1.7176631355987)
    computed = list(numbers("sliding_pendulum", pictures).values())
    np.testing.assert_allclose(computed, published, atol=1e-5)
    np.testing.assert_allclose(computed, exact, atol=1e-8)
    assert value("sliding_pendulum", "x") == pytest.approx(exact[0], abs=1e-8)
    assert value("sliding_pendulum", "angle") == pytest.approx(exact[1], abs=1e-8)


def test_carts_against_published_and_closed_form(pictures: Path) -> None:
    printed = numbers("carts", pictures)
    assert printed["A x(10)"] == pytest.approx(0.5 + 0.2 * math.pi * 10, abs=1e-12)
    assert value("cart_a", "load") == pytest.approx(24 * G / 2, rel=1e-12)
    for time, x in ((1, 0.598174778658534), (2, 1.12831856753888), (10, 6.15485457322214)):
        assert printed[f"B x({time})"] == pytest.approx(x, rel=1e-5)
    top, tau = 0.4 * math.pi, 124 * 0.4 * math.pi / 200
    for time, x, v in (
        (1, 1.04883558873404, 0.908468573453447),
        (10, 12.087308510222, 1.25663365699492),
    ):
        assert printed[f"C x({time})"] == pytest.approx(x, rel=1e-6)
        assert printed[f"C v({time})"] == pytest.approx(v, rel=1e-6)
        assert printed[f"C v({time})"] == pytest.approx(top * (1 - math.exp(-time / tau)), abs=1e-9)


def test_spherical_particle_draws_its_ellipse(pictures: Path) -> None:
    printed = numbers("spherical_particle", pictures)
    place, velocity = np.array([1.0, 0.2, 0.6]), np.array([-0.5, 2.2, 1.0])
    end = place * math.cos(16) + velocity * math.sin(16) / 4  # sqrt(k/m) = 4 rad/s, 4 s
    assert printed["r(4 s) [m]"] == pytest.approx(np.linalg.norm(end), abs=1e-8)
    assert printed["largest error [m]"] < 1e-8
    assert printed["energy drift [J]"] < 1e-7


def test_thrown_body_in_its_own_axes(pictures: Path) -> None:
    printed = numbers("body_about_a_point", pictures)
    assert printed["largest error of A [m]"] < 1e-7
    steiner = 0.15 + 2.0 * (0.45**2 + 0.1**2)
    assert printed["moment of inertia about A [kg m^2]"] == pytest.approx(steiner, rel=1e-14)
    assert printed["angular velocity at the end [rad/s]"] == pytest.approx(7.0, abs=1e-8)


def test_slider_and_link_by_momentum_and_energy(pictures: Path) -> None:
    printed = numbers("slider_and_link", pictures)
    assert max(printed["C D"], printed["C γ − ξ"]) < 1e-13
    assert printed["implicit against explicit"] < 1e-8
    m1, m2, inertia, arm = 2.0, 1.0, 0.03, 0.3
    slider = -m2 * arm / (m1 + m2)  # speeds per unit of angular velocity
    energy = (m1 * slider**2 + m2 * (slider + arm) ** 2 + inertia) / 2
    square = m2 * G * arm / energy
    speed = printed["angular velocity at the lowest point [rad/s]"]
    assert speed**2 == pytest.approx(square, rel=1e-8)
    assert printed["guide force at the lowest point [N]"] == pytest.approx(
        m1 * G + m2 * (G + arm * square), rel=1e-7
    )
