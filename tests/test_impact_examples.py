"""Examples of toys and machines with impacts and friction, beside independent calculations."""

from __future__ import annotations

import math
from pathlib import Path

import compass_walker
import feeder_twin
import gliding_top
import numpy as np
import pytest
from example_runs import model, motion, numbers, script
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import dalembert as da


@pytest.mark.thorough
def test_compass_biped_walks_in_its_gait(pictures: Path) -> None:
    """Gait, multipliers and optimum beside the return map in two angles by SciPy."""
    slope, guess = math.radians(3), (0.27, 1.09, 0.38)
    state, period, length = compass_walker.gait(slope, 0.5, guess)
    used = compass_walker.start(*state, slope)  # rounded differently in the literature
    assert used == pytest.approx((-0.2187, 0.3234, 1.0918, 0.3772), abs=1e-3)
    printed = numbers("compass_biped", pictures)
    assert printed["period [s]"] == pytest.approx(period, abs=2e-7)
    assert printed["step [m]"] == pytest.approx(length, abs=2e-7)
    columns = [
        (
            compass_walker.errors(state + change, slope, 0.5)
            - compass_walker.errors(state - change, slope, 0.5)
        )
        / 2e-6
        for change in 1e-6 * np.eye(3)
    ]
    largest = np.abs(np.linalg.eigvals(np.array(columns).T + np.eye(3))).max()
    assert printed["largest multiplier"] == pytest.approx(largest, abs=1e-6)
    strikes = [impact.name for impact in motion("compass_biped").impacts]
    assert strikes == ["right_foot", "left_foot", "right_foot", "left_foot"]


@pytest.mark.thorough
def test_compass_biped_needs_the_minimum_slope_for_its_speed(pictures: Path) -> None:
    """The masses of the legs are as high as they may be, and lower ones need a steeper slope."""

    def needed(low: float) -> float:
        def faster(slope: float) -> float:
            _, period, length = compass_walker.gait(slope, low, (0.193, 0.94, 0.296))
            return length / period - 0.729

        return math.degrees(brentq(faster, math.radians(1.2), math.radians(1.5), xtol=1e-12))

    printed = numbers("compass_biped", pictures)
    assert printed["optimised height of the masses [m]"] == 0.7
    assert printed["optimised slope [deg]"] == pytest.approx(needed(0.7), abs=1e-6)
    assert needed(0.69) > printed["optimised slope [deg]"]
    assert printed["strikes of the optimised gait"] == 5
    assert printed["violation"] < 1e-9


@pytest.mark.thorough
def test_tippe_top_turns_over(pictures: Path) -> None:
    """Final states by Jellett's constant, which the depth of contact, 1/1000 radius, changes."""
    printed = numbers("tippe_top", pictures)
    assert printed["tilt at the end [deg]"] > 179.5
    assert printed["change of Jellett's constant [share]"] < 1e-3
    spin = 155 * (math.cos(0.1) - 0.3) / 1.3
    assert printed["spin by Jellett's constant [rad/s]"] == pytest.approx(spin, rel=1e-9)
    assert printed["spin at the end [rad/s]"] == pytest.approx(spin, rel=1e-3)
    kinetic = gliding_top.AXIAL * (155**2 - spin**2) / 2
    rise = gliding_top.M * gliding_top.G * gliding_top.R * 0.3 * (1 + math.cos(0.1))
    assert printed["dissipated energy [mJ]"] == pytest.approx(1e3 * (kinetic - rise), rel=1e-3)
    assert printed["the same for the slow top"] < 1 < printed["Jellett's constant over threshold"]
    slow, lowest = (printed[f"its tilt {at} [deg]"] for at in ("at the end", "of minimum energy"))
    assert slow == pytest.approx(lowest, abs=0.1)


@pytest.mark.thorough
def test_tippe_top_beside_equations_of_a_rigid_table() -> None:
    """The difference of the tilts is proportional to the depth of contact."""
    soft, top = motion("tippe_top"), script("tippe_top")
    exact = gliding_top.tilts(155, 0.1, soft.time)
    stiff = da.solve_dynamics(
        model("tippe_top"),
        soft.time[-1],
        outputs=soft.time,
        integrator=da.DormandPrince853(1e-7, 1e-9),
        parameters={"stiffness": 4e4},
    )
    off, less = (np.degrees(np.abs(top.tilt(run) - exact).max()) for run in (soft, stiff))
    assert off < 1.3
    assert less < 0.28 * off


@pytest.mark.thorough
def test_vibratory_feeder_transports_at_the_speed_of_its_twin(pictures: Path) -> None:
    """Way and optimum line of vibration beside phases of stick, slip and flight by SciPy."""
    printed, time = numbers("vibratory_feeder", pictures), 0.4
    way, landings = feeder_twin.way(math.radians(30), time)
    assert printed["speed [mm/s]"] == pytest.approx(1e3 * way / time, abs=1e-6)
    assert printed["landings"] == landings == 10
    line = feeder_twin.fastest((math.radians(48), math.radians(52)), time)
    assert printed["optimised line [deg]"] == pytest.approx(math.degrees(line), abs=0.01)
    best, _ = feeder_twin.way(line, time)
    assert printed["optimised speed [mm/s]"] == pytest.approx(1e3 * best / time, abs=1e-5)


@pytest.mark.thorough
@pytest.mark.parametrize("degrees", [15, 25, 45, 50])
def test_gradient_of_the_way_through_stick_slip_and_hops(degrees: float) -> None:
    """Exact beside central differences of the twin; without hops at 15°."""
    line, h = math.radians(degrees), 1e-5
    feeder, turned = script("vibratory_feeder"), {"line": line}
    run = feeder.RUN.run(model("vibratory_feeder"), parameters=turned)
    slope = da.sensitivity(run, da.final(feeder.WAY), wrt=["line"]).item()
    ways = [feeder_twin.way(line + step, feeder.TIME)[0] for step in (h, -h)]
    assert -slope == pytest.approx((ways[0] - ways[1]) / (2 * h), abs=1e-8)


def lag_of_a_gripped_disc(grip: float) -> float:
    """Of a point that jaws lift by creeping friction from an elastic floor [m]."""
    mass, gravity, rise, height, floor = 1.0, 9.81, 0.6, 0.2, 1e6

    def rates(time: float, state: np.ndarray) -> list[float]:
        up = height / rise * (1 - math.cos(2 * math.pi * time / rise)) if time < rise else 0.0
        pull = 2 * 0.3 * grip * math.tanh(4 * (up - state[1]) / 1e-3)
        bearing = max(-floor * state[0] - 200 * state[1], 0.0) if state[0] < 0 else 0.0
        return [state[1], (pull + bearing) / mass - gravity]

    sunk = mass * gravity / floor
    run = solve_ivp(rates, (0, 0.8), (-sunk, 0.0), method="LSODA", rtol=1e-10, atol=1e-13)
    return height - (run.y[0, -1] + sunk)


@pytest.mark.thorough
def test_friction_gripper_lifts_what_its_force_permits(pictures: Path) -> None:
    """The disc lags as a creeping point does, and stays down where ``2 μ N < m g``."""
    printed = numbers("friction_gripper", pictures)
    assert printed["lag at 30 N [mm]"] == pytest.approx(1e3 * lag_of_a_gripped_disc(30), abs=2e-5)
    least = printed["smallest force [N]"]
    assert lag_of_a_gripped_disc(least) == pytest.approx(3e-4, abs=2e-8)
    assert least == pytest.approx((9.81 + 0.2 * 2 * math.pi / 0.6**2) / 0.6, rel=0.01)
    assert printed["height at 15 N [mm]"] < 0.02
    assert printed["floor bears during the lift at 15 N [N]"] == pytest.approx(
        9.81 - 2 * 0.3 * 15, abs=0.01
    )


@pytest.mark.thorough
def test_ratchet_turns_one_way_by_whole_pitches(pictures: Path) -> None:
    """Contact forces of the pawl that bears the load by statics; tips sink in by 0.1 mm."""
    printed, example = numbers("ratchet", pictures), script("ratchet")
    assert printed["first swing [pitches]"] == pytest.approx(1, abs=0.01)
    for swing in ("second", "third"):
        assert printed[f"{swing} swing [pitches]"] == pytest.approx(1, abs=1e-4)
    assert printed["farthest back [pitches]"] == pytest.approx(0.3, abs=0.01)
    _, top, root, _ = example.tooth(-1)
    normal = np.array([root[1] - top[1], top[0] - root[0]]) / math.dist(root, top)
    x, y = example.seat()
    touched = (x, y) - example.TIP * normal
    arm = -example.HIGHER, example.ARM
    balance = [
        [x, touched[1] * normal[0] - touched[0] * normal[1]],  # of the wheel, by face and back
        [-arm[0], arm[0] * normal[1] - arm[1] * normal[0]],  # of the pawl about its pivot
    ]
    forces = np.linalg.solve(balance, (example.LOAD, -example.SPRING * example.PRESS))
    assert (forces > 0).all()
    assert printed["contact forces of the holding pawl [N]"] == pytest.approx(
        forces.sum(), rel=0.02
    )
    supplied, lost = (printed[f"energy {how} in a swing [J]"] for how in ("supplied", "dissipated"))
    assert supplied == pytest.approx(lost, rel=0.01)
