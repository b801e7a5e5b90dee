"""Analyses and gradients know no unit: in nanometres, tonnes or years they go as in metres."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from registry import CASES, model_of
from thorough import crossed
from units import Units, in_other_units

import dalembert as da
from dalembert import planar

OTHERS = [
    Units(length=1e-9),
    Units(length=1e9),
    Units(mass=1e9, time=1e-9),
    Units(length=1e6, mass=1e-6, time=1e3),
    Units(length=1e-9, mass=1e-9, time=1e-9),
    Units(length=1e9, mass=1e9, time=1e9),
]
STEP, DURATION = 0.01, 0.2
STRATEGIES = {
    "KKT": {"formulation": da.KKT()},
    "NullSpace": {"formulation": da.NullSpace()},
    "VelocityPartitioning": {"formulation": da.VelocityPartitioning()},
    "AugmentedLagrangian": {"formulation": da.AugmentedLagrangian()},
    "JointCoordinates": {"coordinates": da.JointCoordinates()},
    "EnergyProjection": {"stabilization": da.EnergyProjection()},
    "DormandPrince": {"integrator": da.DormandPrince()},
    "Radau": {"integrator": da.Radau()},
    "BDF": {"integrator": da.BDF(rtol=1e-6)},
    "CVODES": {"integrator": da.CVODES()},
    "IDA": {"integrator": da.IDA(), "formulation": da.DAE(index=1)},
    "BackwardEuler": {"integrator": da.BackwardEuler()},
    "GeneralizedAlpha, index 3": {
        "integrator": da.GeneralizedAlpha(),
        "formulation": da.DAE(index=3),
    },
    "Radau, index 3": {"integrator": da.Radau(), "formulation": da.DAE(index=3)},
    "Radau, stabilised index 2": {
        "integrator": da.Radau(),
        "formulation": da.DAE(index=2, stabilized=True),
    },
}
GAINS = {
    "Baumgarte": lambda u: {"stabilization": da.Baumgarte(10 / u.time)},
    "Penalty": lambda u: {
        "formulation": da.Penalty(omega=10 / u.time, eta=10 / u.time),
        "integrator": da.DormandPrince(),
    },
}
MEASURED = {"crank.angle": "rad", "coupler.vx": "m/s", "A.force_norm": "N"}
COUNTED = {"DormandPrince", "Radau", "BDF", "Radau, index 3"}


def linkage(motor: bool = False, crank: float = 0.3) -> da.System:
    """A four-bar that swings against a spring; with a motor it turns, or locks where it cannot."""
    system = da.System("linkage", gravity=(0.0, -9.81))
    length = system.parameter("l1", crank)
    stiffness = system.parameter("k", 40.0)
    first = system.add(
        planar.Bar("crank", length=length, mass=1.5, angle=1.2, angular_velocity=1.0)
    )
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=5.0, angle=0.2))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.2))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), first.start))
    system.add(planar.Revolute("A", first.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    anchor = system.ground.point(0.5, 0.9)
    system.add(
        planar.Spring(
            "S", anchor, coupler.center, stiffness=stiffness, damping=2.0, free_length=0.4
        )
    )
    if motor:
        system.add(planar.RotationalDriver("motor", system.ground, first, 1.2 + 2 * da.t))
    return system


@functools.cache
def model(units: Units, motor: bool = False, crank: float = 0.3) -> da.Model:
    return in_other_units(linkage(motor, crank), units).build()


def same(computed, wanted, tolerance: float = 1e-7) -> None:
    """Equal relative to the largest."""
    wanted = np.asarray(wanted)
    np.testing.assert_allclose(computed, wanted, rtol=0, atol=tolerance * np.abs(wanted).max())


def swing(units: Units, chosen: dict) -> da.Motion:
    step, duration = STEP * units.time, DURATION * units.time
    return da.solve_dynamics(model(units), duration, step=step, outputs=5, **chosen)


@functools.cache
def plain_swing(name: str) -> da.Motion:
    return swing(Units(), STRATEGIES[name] if name in STRATEGIES else GAINS[name](Units()))


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "units"), crossed([*STRATEGIES, *GAINS], OTHERS), ids=str)
def test_dynamics(name, units):
    motion = swing(units, STRATEGIES[name] if name in STRATEGIES else GAINS[name](units))
    plain = plain_swing(name)
    assert motion.status.outcome is plain.status.outcome is da.Outcome.COMPLETED
    if name in COUNTED:  # a rounding may decide whether the last step is a little longer
        assert abs(motion.statistics["steps"] - plain.statistics["steps"]) <= 1
    for measure, unit in (
        ("crank.angle", "rad"),
        ("coupler.vx", "m/s"),
        ("A.force_norm", "N"),
    ):
        same(motion[measure].values / units(unit), plain[measure].values)


@pytest.mark.few(1)
@pytest.mark.parametrize("units", OTHERS, ids=str)
def test_gradients(units):
    responses = {da.Final("A.force_norm"): "N", da.integral("coupler.vx"): "m"}
    sizes = np.array([[units(unit)] for unit in responses.values()])
    for method in ("direct", "adjoint"):
        computed, plain = (
            da.sensitivity(swing(u, {}), list(responses), method=method) for u in (units, Units())
        )
        for one, other in zip(computed.values / sizes, plain.values, strict=True):
            same(one, other)


@pytest.mark.few(2)
@pytest.mark.parametrize("units", OTHERS, ids=str)
def test_equilibrium_and_modes(units):
    rest, plain = da.solve_equilibrium(model(units)), da.solve_equilibrium(model(Units()))
    assert rest.status.outcome is plain.status.outcome is da.Outcome.COMPLETED
    for name in ("iterations", "stable"):
        assert rest.statistics[name] == plain.statistics[name]
    same(rest["crank.angle"].values, plain["crank.angle"].values)
    modes, linearized = da.linearize(model(units), rest), da.linearize(model(Units()), plain)
    same(modes.eigenvalues * units.time, linearized.eigenvalues)


@pytest.mark.few(2)
@pytest.mark.parametrize("units", OTHERS, ids=str)
def test_driven_motion(units):
    computed, plain = (
        da.solve_inverse_dynamics(model(u, True), 4 * u.time, step=STEP * u.time, outputs=9)
        for u in (units, Units())
    )
    assert computed.status.outcome is plain.status.outcome is da.Outcome.COMPLETED
    assert computed.statistics["substeps"] == plain.statistics["substeps"]
    same(computed["rocker.angle"].values, plain["rocker.angle"].values)
    same(computed["motor.effort"].values / units("N m"), plain["motor.effort"].values)


@pytest.mark.few(2)
@pytest.mark.parametrize("units", OTHERS, ids=str)
def test_dead_centres(units):
    """A crank too long for whole turns."""
    computed, plain = (
        da.solve_kinematics(model(u, True, 0.9), 4 * u.time, step=STEP * u.time)
        for u in (units, Units())
    )
    assert computed.status.outcome is plain.status.outcome is da.Outcome.LOCKED
    same(computed.events[-1].time / units.time, plain.events[-1].time, 1e-9)
    assert (
        computed.status.message.partition("driver")[2]
        == plain.status.message.partition("driver")[2]
    )


@pytest.mark.few(7)
@pytest.mark.parametrize("number", range(len(CASES)), ids=list(CASES))
def test_accelerations_and_reactions(number):
    """Of every element, in one of the units."""
    name, units = list(CASES)[number], OTHERS[number % len(OTHERS)]
    if model_of(name).diagnosis.massless:
        pytest.skip("has no accelerations")
    ends = []
    for one, u in ((model_of(name), Units()), (None, units)):
        one = one or in_other_units(model_of(name).parts, units).build()
        motion = da.solve_dynamics(one, 0.01 * u.time, step=0.005 * u.time)
        assert motion.status.success, motion.status
        s, natural = motion.trajectory, one.scales
        a = s.a * (natural.time / natural.speeds)[:, None]
        rows = one.scales.multipliers
        ends.append(np.concatenate([a[:, -1], s.multiplier[:, -1] / rows]))
    same(ends[1], ends[0])
