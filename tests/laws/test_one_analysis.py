"""One analysis answers a question for mechanisms and for structures, in the same words."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import re

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.io.strategies import ANALYSES, STRUCTURAL_ANALYSES

FORCE = 1.7


def mechanism():
    """A mass of 1.3 kg on a spring of 9 N/m."""
    system = da.System("mass on a spring")
    k = system.parameter("k", 9.0)
    mass = system.add(planar.Particle("mass", mass=1.3, position=(1.0, 0.0)))
    rail = system.add(planar.PinInSlot("rail", system.ground.center, mass.center))
    assert rail
    wall = system.ground.point(-4, 0)
    system.add(planar.Spring("spring", wall, mass.center, stiffness=k, free_length=5))
    system.add(planar.Force("force", mass.center, (FORCE, 0.0)))
    return system.build()


def structure():
    """The same as a structure."""
    s = da.Structure("mass on a spring")
    k = s.parameter("k", 9.0)
    a, b = s.node("a", 0.0), s.node("b", 1.0)
    s.add(structures.AxialSpring("spring", a, b, stiffness=k))
    s.add(structures.PointMass("mass", b, mass=1.3))
    s.support(a)
    s.load(b, fx=FORCE)
    return s.build()


TWINS = {"mechanism": (mechanism, "mass.x - 1"), "structure": (structure, "b.ux")}


@pytest.mark.parametrize("kind", TWINS)
@pytest.mark.parametrize("solve", [da.solve_equilibrium, da.solve_statics])
def test_equilibria(kind, solve):
    make, measure = TWINS[kind]
    linear_by_default = kind == "structure" and solve is da.solve_statics
    rest = solve(make(), **({"nonlinear": True} if linear_by_default else {}))
    assert type(rest.analysis) is da.Equilibrium
    assert np.ravel(rest[measure])[-1] == pytest.approx(FORCE / 9, rel=1e-9)
    slope = da.sensitivity(rest, da.final(measure)).item()
    assert slope == pytest.approx(-FORCE / 81, rel=1e-9)
    assert rest.status.outcome is da.Outcome.COMPLETED
    assert re.fullmatch(r"residual \S+ N after \d+ iterations?, stable", rest.status.message)
    assert {"iterations", "stable", "residual [N or N m]"} <= set(rest.statistics)
    assert rest.statistics["stable"] is True
    assert not list(rest.warnings)


def leaning(kind):
    """A bar on its head, held by a torsion spring that is too weak; and one that is not."""
    if kind == "mechanism":
        system = da.System("bar on its head")
        stiffness = system.parameter("stiffness", 0.5)
        bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=np.pi / 2))
        system.add(planar.Revolute("O", system.ground.center, bar.start))
        arguments = {"stiffness": stiffness, "free_angle": np.pi / 2}
        system.add(planar.TorsionSpring("spring", system.ground, bar, **arguments))
        system.add(planar.Force("push", bar.end, (0.0, -1.0)))
        return system.build()
    s = da.Structure("bar on its head")
    stiffness = s.parameter("stiffness", 0.5)
    foot, head = s.node("foot", 0, 0), s.node("head", 0, 1)
    s.add(structures.Truss("bar", foot, head, area=1e-2, modulus=1e9))
    s.add(structures.GroundSpring("spring", head, stiffness_x=stiffness))
    s.support(foot)
    s.load(head, fy=-1.0)
    return s.build()


@pytest.mark.parametrize("kind", TWINS)
def test_stability_of_equilibria(kind):
    model = leaning(kind)
    for stiffness, stable in ((0.5, False), (1.5, True)):
        rest = da.solve_equilibrium(model, parameters={"stiffness": stiffness})
        assert rest.status.success
        assert rest.statistics["stable"] is stable
        assert rest.status.message.endswith("stable" if stable else "not a stable position")
        warned = [text for text in rest.warnings if "the equilibrium is not stable" in text]
        assert len(warned) == (not stable)
        assert all("1 negative eigenvalue," in text for text in warned)


@pytest.mark.parametrize(
    ("kind", "analysis", "option"),
    [
        ("mechanism", da.Equilibrium(steps=3), "steps"),
        ("structure", da.Equilibrium(time=1), "time"),
    ],
)
def test_options_of_the_other_kind_are_refused(kind, analysis, option):
    model, other = TWINS[kind][0](), next(name for name in TWINS if name != kind)
    text = rf"{option}=.*: {option} is an option for {other}s, and 'mass on .*' is a {kind}"
    with pytest.raises(da.UnsupportedError, match=text):
        analysis.run(model)
    with pytest.raises(da.UnsupportedError, match=text):
        analysis.checks(model)[option]()
    many = {"k": np.array([9.0, 10.0])}
    with pytest.raises(da.UnsupportedError, match=text):
        da.solve_equilibrium(model, parameters=many, **{option: getattr(analysis, option)})


@pytest.mark.parametrize(
    ("kind", "registry"), [("mechanism", ANALYSES), ("structure", STRUCTURAL_ANALYSES)]
)
def test_files_name_the_analyses_of_their_kind(kind, registry):
    """Names without imports, in agreement with what the classes state."""
    classes = {**ANALYSES, **STRUCTURAL_ANALYSES}
    assert {*registry} == {name for name, cls in classes.items() if kind in cls.kinds}


OF_ONE_KIND = [
    (cls, option)
    for cls in ANALYSES.values()
    if dataclasses.is_dataclass(cls)
    for option in dataclasses.fields(cls)
    if "model" in option.metadata
]


@pytest.mark.few(11)
@pytest.mark.parametrize(
    ("cls", "option"), OF_ONE_KIND, ids=[f"{c.__name__}.{o.name}" for c, o in OF_ONE_KIND]
)
def test_options_of_the_other_kind_are_refused_with_their_defaults(cls, option):
    """Stated by a keyword, by a copy of the analysis and through a process; not when left out."""
    own = option.metadata["model"]
    other = next(name for name in TWINS if name != own)
    analysis = cls(**{option.name: option.default})
    text = rf"{option.name}=.*: {option.name} is an option for {own}s"
    for stated in (analysis, copy.deepcopy(analysis), pickle.loads(pickle.dumps(analysis))):
        with pytest.raises(da.UnsupportedError, match=text):
            stated.for_model(TWINS[other][0]())
    assert analysis == cls()
    cls().for_model(TWINS[other][0]())
    analysis.for_model(TWINS[own][0]())


@pytest.mark.parametrize("kind", TWINS)
def test_modes(kind):
    model = TWINS[kind][0]()
    omega = np.sqrt(9 / 1.3)
    for modes in (da.linearize(model), da.solve_modes(model, 1), da.Modal(count=1).run(model)):
        assert type(modes.analysis) is da.Modal
        assert modes.frequencies * 2 * np.pi == pytest.approx([omega], rel=1e-9)
        assert modes.damping_ratios == pytest.approx([0.0], abs=1e-12)
        assert modes.stable
        assert modes.status.message == "modes: 1 mode(s)"
    names = ("frequency", "angular_frequency", "damping_ratio", "eigenvalue_real")
    values = [modes[name].item() for name in (*names, "eigenvalue_imag")]
    assert values == pytest.approx([omega / 2 / np.pi, omega, 0, 0, omega], rel=1e-9, abs=1e-12)
    (row,) = modes.summary()["states"]
    assert row["mode"] == f"mode 1: {omega / 2 / np.pi:.5g} Hz"
    slope = da.sensitivity(modes, da.at(1, "angular_frequency")).item()
    assert slope == pytest.approx(omega / 18, rel=1e-9)
    assert list(modes.to_dataframe()["frequency"]) == pytest.approx([omega / 2 / np.pi])


@pytest.mark.parametrize("kind", TWINS)
def test_modes_about_an_equilibrium(kind):
    """A bar on its head grows away from it unless the spring is stiff enough."""
    make = massive(kind)
    for stiffness, stable in ((0.5, False), (1.5, True)):
        rest = da.solve_equilibrium(make, parameters={"stiffness": stiffness})
        modes = da.linearize(make, about=rest)
        assert modes.stable is stable
        lowest = int(np.argmax(modes["eigenvalue_real"].values)) if not stable else 0
        growth = np.sqrt(max(0.0, 1.0 - stiffness))
        assert modes["eigenvalue_real"][lowest].item() == pytest.approx(growth, abs=1e-5)
        with pytest.raises(da.AnalysisError, match="stiffness cannot be given with about="):
            da.linearize(make, about=rest, parameters={"stiffness": 1.0})
        again = modes.analysis.replay(modes, np.array([stiffness + 1.0]))
        assert again.stable
        assert again.values("angular_frequency")[0] == pytest.approx(stiffness**0.5, rel=1e-5)


def massive(kind):
    """The bar on its head, light, with a mass of 1 kg on top."""
    if kind == "mechanism":
        system = da.System("bar on its head")
        stiffness = system.parameter("stiffness", 0.5)
        bar = system.add(planar.Bar("bar", length=1.0, mass=1e-9, angle=np.pi / 2))
        head = system.add(planar.Particle("head", mass=1.0, position=(0.0, 1.0)))
        system.add(planar.Revolute("O", system.ground.center, bar.start))
        system.add(planar.Revolute("H", bar.end, head.center))
        arguments = {"stiffness": stiffness, "free_angle": np.pi / 2}
        system.add(planar.TorsionSpring("spring", system.ground, bar, **arguments))
        system.add(planar.Force("push", bar.end, (0.0, -1.0)))
        return system.build()
    s = da.Structure("bar on its head")
    stiffness = s.parameter("stiffness", 0.5)
    foot, head = s.node("foot", 0, 0), s.node("head", 0, 1)
    s.add(structures.Truss("bar", foot, head, area=1e-2, modulus=1e9))
    s.add(structures.GroundSpring("spring", head, stiffness_x=stiffness))
    s.add(structures.PointMass("mass", head, mass=1.0))
    s.support(foot)
    s.load(head, fy=-1.0)
    return s.build()


RUN = {"duration": 1.0, "step": 0.01, "integrator": da.Newmark()}


@pytest.mark.parametrize("kind", TWINS)
@pytest.mark.parametrize("solve", [da.solve_dynamics, da.solve_transient])
def test_motions(kind, solve):
    make, measure = TWINS[kind]
    model, omega = make(), np.sqrt(9 / 1.3)
    motion = solve(model, **RUN)
    assert type(motion.analysis) is da.Dynamics
    assert motion.status.message == "reached t = 1 s"
    assert motion.time.size == 101
    expected = FORCE / 9 * (1 - np.cos(omega * motion.time))
    np.testing.assert_allclose(motion[measure], expected, atol=1e-4)
    assert motion.at([0.505])[measure].item() == pytest.approx(
        FORCE / 9 * (1 - np.cos(omega * 0.505)), abs=1e-4
    )
    slope = da.sensitivity(motion, da.final(measure)).item()
    again = motion.analysis.replay(motion, motion.parameters + 1e-5)
    change = np.ravel(again[measure])[-1] - np.ravel(motion[measure])[-1]
    assert slope == pytest.approx(change / 1e-5, rel=1e-4)
    later = solve(model, t_span=(2.0, 3.0), step=0.01, integrator=da.Newmark())
    np.testing.assert_allclose(later[measure], motion[measure], atol=1e-12)
    assert later.time[0] == 2.0


@pytest.mark.parametrize("kind", TWINS)
def test_default_integrators(kind):
    model = TWINS[kind][0]()
    defaults = {"mechanism": (da.AutomaticIntegrator, da.RK4), "structure": (da.Newmark,) * 2}
    for options, expected in zip(({}, {"step": 0.1}), defaults[kind], strict=True):
        for motion in (
            da.solve_dynamics(model, 0.5, **options),
            da.Dynamics(0.5, **options).run(model),
        ):
            assert type(motion.analysis.integrator) is expected


def test_loads_begin_at_the_start_of_the_run():
    """A structure that starts in equilibrium under the loads of that time stays there."""
    s = da.Structure("held")
    a, b = s.node("a", 0.0), s.node("b", 1.0)
    s.add(structures.Truss("bar", a, b, area=1.0, modulus=100.0, density=1.0))
    s.support(a)
    s.load(b, fx=2.0 - da.t)
    for nonlinear in (False, True):
        options = {"step": 1e-4, "start": "statics", "nonlinear": nonlinear}
        motion = da.solve_dynamics(s.build(), t_span=(1.0, 1.001), **options)
        rest = da.solve_statics(s.build(), nonlinear=nonlinear)
        assert float(motion["b.ux"][0]) == pytest.approx(rest["b.ux"] / 2, rel=0.02)
        assert float(motion["b.ax"][0]) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("kind", TWINS)
def test_pictures(kind):
    """``plot`` shows measures over time, ``draw`` the model."""
    make, measure = TWINS[kind]
    motion = da.solve_dynamics(make(), **RUN)
    ax = motion.plot(measure)
    (line,) = ax.lines
    np.testing.assert_array_equal(line.get_ydata(), motion[measure])
    assert ax.get_xlabel() == "time [s]"
    assert ax.get_ylabel().startswith(measure)
    assert motion.draw() is not None


@pytest.mark.parametrize("kind", TWINS)
def test_names_that_a_result_does_not_have_come_with_a_remedy(kind):
    """Names of other results and misspelt ones; copies and pickles of results are unaffected."""
    model = TWINS[kind][0]()
    batch = da.solve_equilibrium(model, parameters={"k": np.array([8.0, 9.0])})
    for name in ("report", "plot", "animate", "continued", "page"):
        with pytest.raises(AttributeError, match=rf"has no '{name}'; batch\[k\] returns"):
            getattr(batch, name)
    with pytest.raises(AttributeError, match=r"no .succeded. .did you mean .succeeded."):
        _ = batch.succeded
    modes = da.solve_modes(model, 1)
    for name in ("continued", "animate"):
        with pytest.raises(AttributeError, match=f"has no '{name}'; "):
            getattr(modes, name)
    with pytest.raises(AttributeError, match=r"no .frequencys. .did you mean .frequencies."):
        _ = modes.frequencys
    np.testing.assert_array_equal(copy.copy(modes).frequencies, modes.frequencies)
    if kind == "structure":
        motion = da.solve_transient(model, 0.1, step=0.01)
        with pytest.raises(
            AttributeError, match=r"has no 'continued'; a run of dynamics of a mech"
        ):
            _ = motion.continued
