"""Certificates: right gradients pass on every kind of analysis, wrong ones do not."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from thorough import crossed

import dalembert as da
from dalembert import planar, structures
from dalembert.model.assembled.model import StructuralModel
from dalembert.sensitivity.checks.certificate import certify
from dalembert.sensitivity.registry import ENGINES, engine_for

PLACES = {"a": (0.0, 0.0), "b": (1.0, -0.1), "c": (2.0, 0.0)}


@cache
def propped_bar(driven: bool = False) -> da.Model:
    """A bar on a pin, held by an inclined spring, with a parameter that nothing uses."""
    system = da.System("propped bar", gravity=(0.0, -9.81))
    length = system.parameter("length", 1.2, "m", bounds=(1.2, 2.0))
    mass = system.parameter("mass", 3.0, "kg")
    stiffness = system.parameter("stiffness", 400.0, "N/m")
    start = system.parameter("start", 0.2, "rad")
    offset = system.parameter("offset", 0.0, "m", bounds=(-0.2, 0.2))
    system.parameter("idle", 7.0)
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=start))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    top = system.ground.point(0.3 + offset, 1.0)
    system.add(planar.Spring("spring", top, bar.end, stiffness=stiffness, free_length=0.5))
    if driven:
        law = da.Formula(start + 0.5 * da.t + 0.1 * da.sin(3 * da.t))
        system.add(planar.RotationalDriver("motor", system.ground, bar, law=law))
    return system.build()


@cache
def cable() -> StructuralModel:
    """Two inclined bars under a load, area in m^2 and modulus in Pa."""
    structure = da.Structure("cable")
    area = structure.parameter("area", 2e-6, "m^2", bounds=(1e-6, 5e-6))
    modulus = structure.parameter("modulus", 2.1e11, "Pa")
    load = structure.parameter("load", -500.0, "N")
    a, b, c = (structure.node(n, *p) for n, p in PLACES.items())
    for name, i, j in (("ab", a, b), ("bc", b, c)):
        bar = structures.Truss(name, i, j, area=area, modulus=modulus, density=7850.0)
        structure.add(bar)
    structure.support(a)
    structure.support(c)
    structure.load(b, fy=load)
    return structure.build()


def dynamics(duration: float = 0.4, **choices) -> da.Motion:
    return da.solve_dynamics(propped_bar(), duration, step=0.02, outputs=9, **choices)


MECHANICAL = (
    da.final("bar.end.x", name="place"),
    da.integral("pin.force_norm", name="force"),
    da.rms("spring.force", name="spring"),
)
STATIC = (da.final("b.uy"), da.final("ab.force"), da.final("a.fx"))


def rubbing():
    """A block that a spring holds back slides over a floor, which it touches all the time."""
    system = da.System("block", gravity=(0.0, -9.81))
    friction, stiffness = system.parameter("friction", 0.2), system.parameter("k", 3.0, "N/m")
    start = {"position": (0.0, 0.1 - 1e-7), "velocity": (2.0, 0.0), "angle": 0.0}
    block = system.add(planar.Body("block", mass=1.0, inertia=1e9, **start))
    floor = [planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))]
    system.add(
        planar.Collisions("floor", [planar.contact.Circle(block, 0.1), *floor], friction=friction)
    )
    system.add(planar.Force("spring", block.center, (-stiffness * block.x, 0.0)))
    scheme = da.MoreauJean(projection=False)
    return da.solve_nonsmooth(system.build(), 0.2, step=0.01, integrator=scheme)


RESULTS = {
    "statics": (lambda: da.solve_statics(cable()), STATIC),
    "nonlinear statics": (lambda: da.solve_statics(cable(), nonlinear=True), STATIC),
    "equilibrium": (lambda: da.solve_equilibrium(propped_bar()), MECHANICAL[:1]),
    "kinematics": (
        lambda: da.solve_kinematics(propped_bar(True), 0.5, step=0.05),
        (da.final("bar.end.x"), da.maximum("bar.end.vx", smooth=0.1), da.mean("bar.ax")),
    ),
    "inverse dynamics": (
        lambda: da.solve_inverse_dynamics(propped_bar(True), 0.5, step=0.05),
        (da.rms("motor.moment"), *MECHANICAL[1:]),
    ),
    "explicit": (dynamics, MECHANICAL),
    "adaptive": (lambda: dynamics(integrator=da.DormandPrince()), MECHANICAL),
    "partitioned": (lambda: dynamics(formulation=da.VelocityPartitioning()), MECHANICAL),
    "implicit": (lambda: dynamics(integrator=da.GeneralizedAlpha()), MECHANICAL),
    "event": (
        lambda: dynamics(events={"low": da.Event("bar.end.x", terminal=True, direction=-1)}),
        (da.event_time("low"), da.final("bar.end.vx"), da.integral("kinetic_energy")),
    ),
    "index 3": (
        lambda: dynamics(0.2, formulation=da.DAE(index=3), integrator=da.Radau()),
        MECHANICAL,
    ),
    "sundials": (lambda: dynamics(integrator=da.CVODES()), MECHANICAL[:1]),
    "many contacts": (lambda: rubbing(), (da.final("block.x"), da.rms("block.vx"))),
    "modes": (lambda: da.linearize(propped_bar()), (da.final("frequency", name="f"),)),
    "vibration": (lambda: da.solve_modes(cable(), 2), (da.at(1, "frequency"),)),
    "buckling": (lambda: da.solve_buckling(cable(), 1, negative=True), (da.at(1, "load_factor"),)),
    "frequency response": (
        lambda: da.frequency_response(
            propped_bar(), [0.5, 1.3], inputs=["stiffness"], outputs=["bar.end.x"]
        ),
        (da.at(1.3, "bar.end.x.stiffness.amplitude"),),
    ),
    "structural frequency response": (
        lambda: da.frequency_response(cable(), [20.0, 45.0], outputs=["b.uy"]),
        (da.at(45.0, "b.uy.amplitude"),),
    ),
    "load path": (lambda: da.solve_load_path(cable()), (da.final("b.uy"), da.final("ab.force"))),
    "transient": (
        lambda: da.solve_transient(cable(), 0.01, step=5e-4),
        (da.final("b.uy"), da.rms("ab.force")),
    ),
}


@cache
def result_of(name: str):
    return RESULTS[name][0]()


@cache
def certified(name: str):
    result = result_of(name)
    assert result.status.success
    return da.sensitivity(result, RESULTS[name][1], certificate=True)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.thorough] * (n == "load path")) for n in RESULTS],
)
def test_right_gradients_pass(name):
    gradient = certified(name)
    certificate = gradient.attrs["certificate"]
    assert certificate.passed, f"{certificate}\n{certificate.table()}"
    tolerance = 1e-5 if name == "sundials" else 1e-9
    assert float(certificate.data["disagreement"].max()) <= tolerance
    assert float(certificate.data["error"].max()) <= 10 * max(tolerance, 1e-7)
    slopes = certificate.data["taylor_slope"].values
    assert np.all(np.isnan(slopes) | (slopes > 1.9))
    assert np.nanmin(np.abs(slopes - 2.0)) < 0.1  # more where the curvature happens to vanish
    np.testing.assert_allclose(certificate.data["adjoint"], gradient, rtol=1e-6, atol=1e-300)


def test_every_engine_is_certified():
    analyses = [(r.model.kind, type(r.analysis)) for r in map(result_of, RESULTS)]
    for model, engines in ENGINES.items():
        for kind in engines:
            assert any(one == model and issubclass(cls, kind) for one, cls in analyses)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "side"),
    crossed(
        ["statics", "kinematics", "explicit", "implicit", "sundials"], ["adjoint", "direct", "both"]
    ),
)
def test_wrong_gradients_do_not(name, side, monkeypatch):
    """One derivative of three is off by a ten-thousandth.

    Of runs that are uneven by their tolerance, Taylor remainders that short are not told from it.
    """
    make, responses = RESULTS[name]
    result = make()
    engine = engine_for(result)
    true_adjoint, true_direct = engine.adjoint, engine.direct
    wrong = np.array([1.0 + 1e-4, 1.0, 1.0])
    if side != "direct":
        monkeypatch.setattr(engine, "adjoint", lambda self: _spoilt(true_adjoint(self), wrong))
    if side != "adjoint":
        monkeypatch.setattr(
            engine, "direct", lambda self, columns: _spoilt(true_direct(self, columns), wrong)
        )
    certificate = certify(result, responses, [0, 1, 2])
    assert not certificate.passed
    verdicts = certificate.data["verdict"].values
    assert (verdicts[:, 0] == "contradicted").any()
    assert not (verdicts[:, 1:] == "contradicted").any()
    if side != "direct" and name != "sundials":  # the Taylor test looks at the adjoint
        tests = certificate.data["taylor_slope"].values
        assert np.nanmin(tests) == pytest.approx(1.0, abs=0.1)
    assert "contradicted" in repr(certificate)


def _spoilt(gradient: np.ndarray, factors: np.ndarray) -> np.ndarray:
    spoilt = gradient.copy()
    spoilt[:, :3] *= factors
    return spoilt


def test_linear_responses_are_exact():
    """A displacement is linear in the load: nothing remains but round-off."""
    result = da.solve_statics(cable())
    gradient = da.sensitivity(result, da.final("b.uy"), ["load"], certificate=True)
    certificate = gradient.attrs["certificate"]
    assert certificate.passed
    assert certificate.data["taylor_verdict"].values.tolist() == ["exact"]
    assert "exact" in repr(certificate)


def test_what_nothing_depends_on():
    certificate = certified("explicit").attrs["certificate"]
    verdicts = certificate.data["verdict"].sel(parameter="idle")
    assert set(verdicts.values.tolist()) == {"no influence"}


def test_influences_too_small_to_show():
    """What changes a response in its last digits only is neither contradicted nor in doubt."""
    motion = dynamics()
    names = list(motion.model.parameters)
    tiny = da.final(1.0 + 1e-13 * motion.model[names[0]], name="tiny")
    certificate = da.sensitivity(motion, tiny, certificate=True).attrs["certificate"]
    assert certificate.passed


def test_table_and_repr():
    certificate = certified("statics").attrs["certificate"]
    table = certificate.table()
    assert len(table) == 9
    assert {"response", "parameter", "adjoint", "difference", "step", "verdict"} <= set(table)
    assert "passed" in repr(certificate)
    assert "slope 2.0" in repr(certificate)
    assert "<table" in certificate._repr_html_()
    assert (certificate.data["step"] > 0).all()


def test_beside_a_kink_shorter_steps_tell():
    """Of two peaks nearly as high the other one is the highest a little farther on."""
    motion = dynamics()
    names = list(motion.model.parameters)
    length = motion.model[names[0]]
    value = motion.model.values(motion.parameters)[0]
    other = value * (1 + 2e-5)
    from_kink = da.maximum(
        da.where(da.t < 0.2, length - value, 3.0 * (length - other)) + 1.0, name="peak"
    )
    zero = da.at(0.0, 0.1 * (length - value) + (da.t > 0.3), name="nothing yet")
    certificate = certify(motion, [from_kink, zero], [1])
    assert certificate.data["verdict"].values.ravel().tolist() == ["no influence"] * 2
    certificate = certify(motion, [from_kink], [0])
    assert certificate.data["verdict"].item() == "confirmed"


@pytest.mark.thorough
def test_integrals_over_moving_kinks_are_not_contradicted():
    """A tow rope grows taut and slack again; what it hands on is known by the elastic impact."""
    system = da.System("tow")
    speed = system.parameter("speed", 2.0, "m/s")
    rail = {"direction": (0.0, 1.0)}
    towed = system.add(planar.Particle("towed", mass=1.0, position=(0.0, 0.0)))
    start = {"position": (0.5, 0.0), "velocity": (speed, 0.0)}
    towing = system.add(planar.Particle("towing", mass=3.0, **start))
    for body in (towed, towing):
        system.add(planar.CoordinateDriver(f"on_{body.name}", body.center, 0.0, **rail))
    rope = (towed.center, towing.center)
    system.add(planar.Cable("rope", rope, length=1.0, stiffness=1000.0))
    motion = da.solve_dynamics(system.build(), 0.4, integrator=da.DormandPrince(1e-9, 1e-9))
    gradient = da.sensitivity(motion, da.integral("rope.force"), certificate=True)
    assert abs(gradient.item() - 1.5) < 1e-6  # 2 m1 m2/(m1 + m2)
    certificate = gradient.attrs["certificate"]
    assert certificate.data["verdict"].item() == "unconfirmed"
    assert certificate.data["taylor_verdict"].item() == "unconfirmed"
