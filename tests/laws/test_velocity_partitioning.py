"""Velocity partitioning: exact speeds, partitions exchanged on the way without a trace."""

from __future__ import annotations

import functools
import math
import re

import numpy as np
import pytest
from registry import CONSTRAINED, model_of

import dalembert as da
from dalembert import planar

OUTPUTS = np.linspace(0, 2, 21)
PARTITIONED = da.VelocityPartitioning()


def slider_crank() -> da.System:
    """Turns fully: the slider stands still at both dead centres."""
    system = da.System("slider-crank", gravity=(0.0, -9.81))
    r, l, mass = (system.parameter(n, v) for n, v in (("r", 0.2), ("l", 0.5), ("m", 3.0)))
    crank = system.add(planar.Bar("crank", length=r, mass=0.4, angle=0.3, angular_velocity=9.0))
    rod = system.add(planar.Bar("rod", length=l, mass=1.0, angle=-0.1))
    slider = system.add(planar.Body("slider", mass=mass, inertia=0.01, angle=0.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("C", system.ground.point(0, 0), slider.center))
    return system


def four_bar() -> da.System:
    """The four-bar of section 5.4.3 with a crank fast enough to turn fully."""
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1, m2 = system.parameter("l1", 0.3), system.parameter("m2", 5.0)
    crank = system.add(
        planar.Bar("crank", length=l1, mass=1.5, angle=math.pi / 2, angular_velocity=12.0)
    )
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=m2))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system


MECHANISMS = {"slider-crank": slider_crank, "four-bar": four_bar}


@functools.cache
def mechanism(name: str) -> da.Model:
    return MECHANISMS[name]().build()


@functools.cache
def exact(name: str) -> np.ndarray:
    method = da.DormandPrince853(1e-13, 1e-13)
    motion = da.solve_dynamics(mechanism(name), 2.0, integrator=method, outputs=OUTPUTS)
    turned = abs(float(motion["crank.angle"][-1] - motion["crank.angle"][0]))
    assert turned > 4 * math.pi  # two turns at least
    return motion.trajectory.y


def run(name: str, formulation=PARTITIONED, stabilization=None, **options) -> da.Motion:
    options = {"step": 0.002, "outputs": OUTPUTS} | options
    return da.solve_dynamics(
        mechanism(name),
        2.0,
        formulation=formulation,
        stabilization=stabilization or da.Stabilization(),
        **options,
    )


def error(name: str, motion: da.Motion) -> float:
    return float(np.abs(motion.trajectory.y - exact(name)).max())


@pytest.mark.few(16)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_velocity_constraints_hold_without_correction(name):
    """|Ψ| ≤ 1e-12 at steps and between them, though nothing corrects them."""
    motion = da.solve_dynamics(
        model_of(name),
        0.2,
        step=0.02,
        outputs=np.linspace(0, 0.2, 7),
        formulation=PARTITIONED,
        stabilization=da.Stabilization(),
    )
    assert motion.status.success
    scale = 1 + np.abs(motion.trajectory.v).max()
    assert float(motion.data.velocity_violation.max()) < 1e-12 * scale


def test_positions_drift_as_the_integrator_makes_them():
    """The position violation of RK4 falls with the fourth power of the step, and is not zero."""
    drift = [
        float(run("slider-crank", step=h).data.position_violation.max()) for h in (4e-3, 2e-3, 1e-3)
    ]
    assert drift[0] > 1e-9
    assert math.log2(drift[0] / drift[2]) / 2 > 3.7


@pytest.mark.few(1)
@pytest.mark.parametrize("every", [None, 1, 7])
@pytest.mark.parametrize("name", MECHANISMS)
def test_as_accurate_as_all_speeds_through_all_switches(name, every):
    """With equal steps, against range space that nothing corrects either."""
    stabilization = da.Projection(every=every) if every else da.Stabilization()
    motion = run(name, stabilization=stabilization)
    assert motion.statistics["variant changes"] >= 6
    assert float(motion.data.velocity_violation.max()) < 1e-12
    assert error(name, motion) < error(name, run(name, da.RangeSpace()))


@pytest.mark.parametrize("name", MECHANISMS)
def test_nothing_jumps_at_a_switch(name):
    """Both partitions see the same state: y, v to round-off, v̇ and λ with it."""
    motion = run(name, stabilization=da.Projection(every=7))
    kernel, steps = motion.record.kernel, motion.record.steps
    switches = np.flatnonzero(np.diff(steps.mode)) + 1
    assert switches.size >= 6
    for k in switches:
        before, after = (
            kernel.variants[mode].bodies(steps.t[k], steps.x[:, k], motion.parameters)
            for mode in (steps.mode[k - 1], steps.mode[k])
        )
        np.testing.assert_array_equal(before[0].full(), after[0].full())
        for old, new in zip(before[1:], after[1:], strict=True):
            size = 1 + np.abs(old.full()).max()
            np.testing.assert_allclose(new.full(), old.full(), atol=1e-10 * size)


def test_adaptive_steps_switch_too():
    method = da.DormandPrince(1e-9, 1e-11)
    motion = run("slider-crank", integrator=method, step=None)
    assert motion.statistics["variant changes"] >= 6
    assert error("slider-crank", motion) < 1e-6


def test_a_fixed_bad_partition_fails():
    """The slider stands still at dead centres: it cannot be independent for whole turns."""
    slider = da.VelocityPartitioning(("slider.x",), limit=1e9)
    assert error("slider-crank", run("slider-crank", slider)) > 1e4 * error(
        "slider-crank", run("slider-crank")
    )
    stopped = run("slider-crank", da.VelocityPartitioning(("slider.x",)))
    assert not stopped.status.success
    assert re.search(r"times as fast as slider\.x.*limit 50", stopped.status.message)
    assert 1.0 < stopped.time[-1] < 2.0  # what came before is kept
    crank = run("slider-crank", da.VelocityPartitioning("crank.angle"))
    assert "variant changes" not in crank.statistics
    assert error("slider-crank", crank) < 1e-4


@pytest.mark.parametrize(
    ("names", "kind", "message"),
    [
        (("slider.z",), da.UnsupportedError, "no coordinate 'slider.z'; nearest: slider"),
        (("slider.x", "crank.angle"), da.UnsupportedError, "1 independent speeds.*2 are named"),
        (("slider.y",), da.SingularityError, r"t = 0 s slider\.y do not determine"),
    ],
)
def test_useless_names_are_refused(names, kind, message):
    with pytest.raises(kind, match=message):
        run("slider-crank", da.VelocityPartitioning(names))


def test_useless_options_are_refused():
    with pytest.raises(da.UnsupportedError, match="Baumgarte nothing to act on"):
        run("slider-crank", stabilization=da.Baumgarte())
    with pytest.raises(da.UnsupportedError, match=r"at least 1\.1"):
        da.VelocityPartitioning(limit=1.0)
    e = mechanism("four-bar").equations
    with pytest.raises(da.UnsupportedError, match="choose"):
        PARTITIONED.solver(e.inertia, e.jacobian, e.massless)


@pytest.mark.thorough
@pytest.mark.parametrize("stabilization", [da.Stabilization(), da.Projection(every=3)])
def test_gradients_across_switches(stabilization):
    """Direct and adjoint agree to 1e-9, with differences of the same steps to 1e-6."""
    motion = run("slider-crank", stabilization=stabilization, step=0.004)
    assert motion.statistics["variant changes"] >= 6
    response = da.mean("slider.x")
    direct, adjoint, difference = (
        da.sensitivity(motion, response, method=method).values
        for method in ("direct", "adjoint", "finite-difference")
    )
    size = np.abs(direct).max()
    assert size > 1e-3
    np.testing.assert_allclose(adjoint, direct, atol=1e-9 * size)
    np.testing.assert_allclose(difference, direct, atol=1e-6 * size)
