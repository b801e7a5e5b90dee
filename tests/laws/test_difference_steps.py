"""Steps of finite differences: any size of parameter, within bounds and limits, of their order."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.sensitivity.checks.finite_difference import Replays
from dalembert.sensitivity.checks.stencils import SCHEMES, best_step, parameter_scale

STENCILS = [
    pytest.param(s, id=f"{n}-{s.side}") for n, stencils in SCHEMES.items() for s in stencils
]


def stretched(bounds: tuple | None = None):
    """A bar of 1 m, with bounds of its area, under a load: ux = load / (E A)."""
    structure = da.Structure("bar")
    area = structure.parameter("area", 1e-6, "m^2", bounds=bounds)
    modulus = structure.parameter("modulus", 2e11, "Pa")
    load = structure.parameter("load", 0.0, "N")
    a, b = structure.node("a", 0.0, 0.0), structure.node("b", 1.0, 0.0)
    structure.add(structures.Truss("bar", a, b, area=area, modulus=modulus))
    structure.support(a)
    structure.support(b, uy=0.0)
    structure.load(b, fx=500.0 + load)
    return da.solve_statics(structure.build())


@pytest.mark.parametrize("stencil", STENCILS)
def test_stencils_are_exact_for_polynomials_of_their_order(stencil):
    offsets, weights = np.array(stencil.offsets), np.array(stencil.weights)
    for power in range(stencil.order + 1):
        assert weights @ offsets**power == pytest.approx(float(power == 1), abs=1e-13)
    assert abs(weights @ offsets ** (stencil.order + 1)) > 1e-3
    assert np.abs(offsets).max() == 1.0


@pytest.mark.parametrize("scheme", SCHEMES)
def test_default_steps_suit_parameters_of_any_size(scheme):
    """An area in m^2, a modulus in Pa and a force of zero beside each other."""
    result = stretched()
    gradient = da.sensitivity(result, da.final("b.ux"), method=da.FiniteDifference(scheme))
    flexibility = 1.0 / (1e-6 * 2e11)
    exact = {"area": -500 * flexibility / 1e-6, "modulus": -500 * flexibility / 2e11}
    tolerance = 30 * best_step(scheme) ** SCHEMES[scheme][0].order + 1e-10
    for name, value in exact.items():
        assert gradient.sel(parameter=name).item() == pytest.approx(value, rel=tolerance)
    load = gradient.sel(parameter="load").item()  # zero has no size: the step is a share of 1 N
    assert load == pytest.approx(flexibility, rel=1e-5)
    assert gradient.attrs["notes"] == []


@pytest.mark.parametrize(
    ("value", "unit", "bounds", "scale"),
    [
        (1e-6, "m^2", None, 1e-6),
        (-3e9, "N", (-1e10, 1e10), 3e9),
        (0.0, "N", None, 1.0),
        (0.0, "m", (-0.1, 0.3), 0.2),
        (0.0, "m", (None, 0.3), 0.3),
        (0.0, "m", (0.0, None), 1.0),
        (1e-16, "rad", None, 1.0),
        (7.0, "rad", None, 7.0),
    ],
)
def test_sizes_of_parameters(value, unit, bounds, scale):
    assert parameter_scale(da.Parameter("p", value, unit, bounds), value) == scale


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_bounds_are_never_left(scheme, side, monkeypatch):
    bounds = (1e-6, None) if side == "lower" else (None, 1e-6)
    result = stretched(bounds)
    seen = []
    true = Replays.__call__
    monkeypatch.setattr(Replays, "__call__", lambda self, p: seen.append(p[0]) or true(self, p))
    method = da.FiniteDifference(scheme, step=1e-3)
    gradient = da.sensitivity(result, da.final("b.ux"), ["area"], method)
    assert min(seen) >= 1e-6 if side == "lower" else max(seen) <= 1e-6
    assert gradient.item() == pytest.approx(
        -2500.0, rel=5 * 1e-3 ** SCHEMES[scheme][0].order + 1e-9
    )
    away = {"forward": "upper", "backward": "lower"}.get(scheme, side) == side
    notes = [note for note in gradient.attrs["notes"] if note.startswith("differences of area")]
    assert bool(notes) is away
    if away:
        assert f"{side} bound is 1e-06" in notes[0]
        assert ("upwards" if side == "lower" else "downwards") in notes[0]


def test_one_sided_schemes_keep_their_order():
    """Errors at a bound fall with the order that was asked for."""
    result = stretched((1e-6, None))
    study = da.step_study(result, da.final("b.ux"), "area", (1e-1, 10**-1.5), tuple(SCHEMES))
    fall = np.log10(study.data["error"][:, 0] / study.data["error"][:, 1]) / 0.5
    orders = [SCHEMES[s][0].order for s in study.data["scheme"].values]
    np.testing.assert_allclose(fall, orders, atol=0.35)
    assert len(study.data.attrs["notes"]) == 3  # all but forward differences


def test_limits_of_the_model_are_never_left():
    """Steps that would make an area or a mass negative look to the other side."""
    system = da.System("thrown")
    mass = system.parameter("mass", 2.0, "kg")
    system.add(planar.Particle("ball", mass=mass, velocity=(1.0, 0.0)))
    thrown = da.solve_dynamics(system.build(), 1.0, step=0.1)
    for result, entity in ((stretched(), "bar.area"), (thrown, "ball.mass")):
        method = da.FiniteDifference("central", 2.0)
        quotient = method.quotients(result, [0])[0]
        assert quotient.stencil.side == "upwards"
        assert quotient.stencil.order == 2
        assert f"{entity}: is -" in quotient.note
        assert da.FiniteDifference("central", 0.5).notes(result, [0]) == []


def test_steps_by_name():
    result = stretched()
    method = da.FiniteDifference("forward", {"area": 1e-2})
    quotients = method.quotients(result, [0, 1])
    assert quotients[0].step == pytest.approx(1e-8)
    assert quotients[1].step == pytest.approx(2e11 * best_step("forward"))
    derivative = da.sensitivity(result, da.final("b.ux"), ["area"], method).item()
    assert derivative == pytest.approx(-2500.0 / 1.01, rel=1e-9)  # -u/(A (1 + h))


@pytest.mark.parametrize(
    ("make", "kind", "message"),
    [
        (lambda r: da.FiniteDifference("sideways"), da.UnsupportedError, "choose one of forward"),
        (lambda r: da.FiniteDifference(step=0.0), da.UnsupportedError, "must be a positive number"),
        (lambda r: da.FiniteDifference(step=float("nan")), da.UnsupportedError, "step is nan"),
        (lambda r: da.FiniteDifference(step={"area": -1}), da.UnsupportedError, "step of area"),
        (
            lambda r: da.FiniteDifference(step={"aera": 1e-3}).quotients(r, [0]),
            da.AnalysisError,
            "a step for unknown parameter 'aera'.*known: area, modulus, load",
        ),
        (
            lambda r: da.FiniteDifference(step=1e-17).quotients(r, [0]),
            da.AnalysisError,
            "step of 1e-17 does not change area = 1e-06",
        ),
        (
            lambda r: da.FiniteDifference(step=0.5).quotients(r, [0]),
            da.AnalysisError,
            "fit on neither side of area = 1e-06: its lower bound is 9e-07; give a shorter",
        ),
        (
            lambda r: da.step_study(r, da.final("b.ux"), "area", [-1.0]),
            da.UnsupportedError,
            "step is -1.0",
        ),
        (
            lambda r: da.step_study(r, da.final("b.ux"), "aera"),
            da.AnalysisError,
            "unknown parameter 'aera'",
        ),
    ],
)
def test_unsuitable_steps_are_refused_by_name(make, kind, message):
    result = stretched((9e-7, 1.1e-6))
    with pytest.raises(kind, match=message):
        make(result)


def test_a_study_tells_where_runs_fail():
    """Half of the steps would leave the bounds on both sides: their errors are not numbers."""
    result = stretched((9e-7, 1.1e-6))
    study = da.step_study(result, da.final("b.ux"), "area", (1.0, 0.5, 1e-2, 1e-3), ["central"])
    assert np.isnan(study.data["value"].values).tolist() == [[True, True, False, False]]
    assert study.data["error"].attrs["units"] == "m/m^2"
    assert len(study.data.attrs["notes"]) == 2
    assert study.best()["central"] == 1e-3
    assert "best relative steps: central 1e-03" in repr(study)


def test_study_draws(tmp_path):
    import matplotlib as mpl

    mpl.use("Agg")
    study = da.step_study(stretched(), da.final("b.ux"), "area", 10.0 ** -np.arange(1, 8))
    ax = study.plot()
    assert ax.get_xscale() == ax.get_yscale() == "log"
    assert [t.get_text() for t in ax.get_legend().get_texts()] == [
        "forward, order 1",
        "backward, order 1",
        "central, order 2",
        "richardson, order 4",
    ]
    assert all(np.isfinite(line.get_ydata()).all() for line in ax.lines)
    assert study.plot(ax) is ax


def test_a_value_that_is_none_beside_the_design_is_told():
    """The run succeeds there, and is not said to fail: the response is a root of less than zero."""
    system = da.System("stone")
    speed = system.parameter("speed", 1.0, "m/s")
    stone = system.add(planar.Particle("stone", mass=1.0, velocity=(speed, 0)))
    motion = da.solve_dynamics(system.build(), 1.0, step=0.5)
    root = da.final(da.sqrt(1.0 - stone.velocity[0]), name="root")
    with pytest.raises(da.AnalysisError, match=r"speed = .*no finite value of root") as message:
        da.sensitivity(motion, root, method="finite-difference")
    assert "succeed" not in str(message.value)
