"""Modes of vibration and buckling of every kind of element: laws and exact gradients."""

from __future__ import annotations

import numpy as np
import pytest
from structure_models import COMPRESSED, MASSIVE, floating, model_of
from thorough import crossed

import dalembert as da
from dalembert import structures


def check_gradients(result, responses) -> None:
    """direct = adjoint, entry by entry; both = differences along a direction."""
    adjoint, direct = (
        da.sensitivity(result, responses, method=m).values for m in ("adjoint", "direct")
    )
    p = result.parameters
    size = np.where(p == 0, 1, np.abs(p))
    scale = (np.abs(direct) * size).max(axis=1, keepdims=True)
    assert (scale > 0).all()
    assert (np.abs(adjoint - direct) * size / scale).max() < 1e-9
    direction = np.random.default_rng(0).uniform(-1, 1, p.size) * size

    def values(step: float) -> np.ndarray:
        moved = result.analysis.replay(result, p + step * direction)
        return np.array([da.evaluate(moved, response) for response in responses])

    h = 2e-4
    slope = (values(-h) - 8 * values(-h / 2) + 8 * values(h / 2) - values(h)) / (6 * h)
    assert (np.abs(slope - direct @ direction) / scale.ravel()).max() < 1e-6


def responses_of(model, main: str) -> list[da.Response]:
    """The eigenvalue, entries of shapes, a quantity of an element, formulas, and several modes."""
    places = [model.degrees.place(int(k)) for k in model.assembly.free]
    moved = ".".join(next(place for place in reversed(places) if place[1].startswith("u")))
    element = next(iter(model.structure.elements))
    quantity = next(iter(model.blocks[0].kind.measures))
    product = f"{main}*{moved}**2"
    return [
        da.at(1, main, name="first"),
        da.at(2, main, name="second") if len(model.assembly.free) > 1 else da.final(main),
        da.at(1, moved, name="shape"),
        da.at(1, f"{element}.{quantity}", name="quantity"),
        da.mean(product, name="formula"),
    ]


@pytest.mark.few(11)
@pytest.mark.parametrize("lumped", [False, True])
@pytest.mark.parametrize("name", MASSIVE)
def test_shapes_are_orthogonal(name, lumped):
    model = model_of(name)
    modes = da.solve_modes(model, 40, lumped=lumped)
    mass = model.linearized.assembly.mass(model.nominal, lumped)
    stiffness = model.linearized.assembly.stiffness(np.zeros(len(model.degrees)), model.nominal)
    np.testing.assert_allclose(
        modes.shapes.T @ mass @ modes.shapes, np.eye(modes.numbers.size), atol=1e-9
    )
    np.testing.assert_allclose(
        modes.shapes.T @ stiffness @ modes.shapes,
        np.diag(modes.eigenvalues),
        atol=1e-9 * modes.eigenvalues.max(),
    )
    assert modes.status.success
    assert modes.status.residual < 1e-9
    peaks = np.abs(modes.shapes).argmax(axis=0)
    assert (modes.shapes[peaks, np.arange(peaks.size)] > 0).all()


@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "lumped"), crossed(MASSIVE, [False, True]))
def test_gradients_of_vibration(name, lumped):
    model = model_of(name)
    modes = da.solve_modes(model, 2, lumped=lumped)
    more = [da.at(1, "effective_mass.ux", name="effective mass")]
    check_gradients(modes, responses_of(model, "frequency") + more)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "nonlinear"), crossed([n for n in MASSIVE if n in COMPRESSED], [False, True])
)
def test_gradients_of_vibration_about_a_loaded_state(name, nonlinear):
    model = model_of(name)
    loaded = da.solve_statics(model, nonlinear=nonlinear)
    modes = da.solve_modes(model, 2, about=loaded)
    check_gradients(modes, responses_of(model, "frequency"))


@pytest.mark.few(1)
@pytest.mark.parametrize("name", COMPRESSED)
def test_gradients_of_buckling(name):
    model = model_of(name)
    modes = da.solve_buckling(model, 2, "push", negative=True)
    assert modes.status.residual < 1e-9
    responses = responses_of(model, "load_factor")
    check_gradients(modes, responses if modes.numbers.size > 1 else [responses[0], responses[2]])


@pytest.mark.few(2)
@pytest.mark.parametrize("name", [n for n in MASSIVE if n in COMPRESSED])
def test_frequency_vanishes_at_the_load_factor(name):
    """Vibration about ``λ u₀`` stops where the structure buckles."""
    model = model_of(name)
    factor = da.solve_buckling(model, 1, "push", negative=True).load_factors[0]
    forces = {q: v.value * factor for q, v in model.parameters.items() if q.startswith("F")}
    loaded = da.solve_statics(model, parameters=forces)
    largest = da.solve_modes(model, 40).eigenvalues.max()
    modes = da.solve_modes(model, 40, about=loaded, shift=-0.01 * largest)
    assert np.abs(modes.eigenvalues).min() < 1e-9 * largest


@pytest.mark.few(1)
@pytest.mark.parametrize("count", [4, 70])
def test_floating_structures_have_rigid_modes(count):
    """Three of them, of the whole mass; the others keep their place."""
    model = floating(count).build()
    with pytest.raises(da.SingularityError, match="negative shift"):
        da.solve_modes(model)
    modes = da.solve_modes(model, 6, shift=-0.1)
    np.testing.assert_array_equal(modes.eigenvalues[:3], 0.0)
    assert (modes.eigenvalues[3:] > 0).all()
    mass = modes["effective_mass.ux"].values
    assert mass.sum() == pytest.approx(3.0, rel=1e-8)
    assert mass[3:].max() < 1e-9
    with pytest.raises(da.SingularityError, match="use eigenvalue"):
        da.sensitivity(modes, da.at(1, "frequency"))
    check_gradients(modes, [da.at(4, "frequency", name="f"), da.at(4, "n1.uy", name="u")])


def test_displacements_without_mass_follow_the_others():
    """Lumped mass without rotary inertia: as many modes as translations, those of the condensed
    stiffness."""
    structure = floating()
    structure.support(structure.nodes["n0"])
    model = structure.build()
    modes = da.solve_modes(model, 40, lumped=True)
    assembly = model.linearized.assembly
    mass = assembly.mass(model.nominal, True).toarray()[np.ix_(assembly.free, assembly.free)]
    assert modes.status.success
    some = mass.diagonal() > 0
    stiffness = assembly.stiffness(np.zeros(assembly.size), model.nominal)
    stiffness = stiffness.toarray()[np.ix_(assembly.free, assembly.free)]
    k, c, r = stiffness[np.ix_(some, some)], stiffness[np.ix_(some, ~some)], stiffness[~some]
    if (~some).any():
        k = k - c @ np.linalg.solve(r[:, ~some], c.T)
    scale = 1 / np.sqrt(mass.diagonal()[some])
    expected = np.linalg.eigvalsh(scale[:, None] * k * scale)
    np.testing.assert_allclose(modes.eigenvalues, expected, rtol=1e-8)


@pytest.mark.few(1)
@pytest.mark.parametrize("vibrating", [True, False])
def test_many_displacements_by_iteration(vibrating, monkeypatch):
    """The iteration finds what the whole decomposition finds."""
    structure = floating(70)
    structure.support(structure.nodes["n0"])
    structure.load(structure.nodes["n70"], fx=-1.0)
    model = structure.build()

    def solved():
        return da.solve_modes(model, 5) if vibrating else da.solve_buckling(model, 5)

    computed = solved()
    monkeypatch.setattr("dalembert.model.assembled.evaluation.eigenpairs.DENSE", 1000)
    whole = solved()
    np.testing.assert_allclose(computed.eigenvalues, whole.eigenvalues, rtol=1e-8)
    gap = np.abs(computed.shapes - whole.shapes).max()
    assert gap < 1e-5 * np.abs(whole.shapes).max()


def test_constant_loads_take_their_share():
    """One load in two parts: ``λ = (λ₀ − a)/b`` where ``a`` of it is constant."""
    structure = floating()
    structure.support(structure.nodes["n0"])
    tip = structure.nodes["n4"]
    dead, live = (structure.parameter(n, v) for n, v in (("dead", -0.004), ("live", -0.01)))
    structure.load(tip, case="dead", fx=dead)
    structure.load(tip, case="live", fx=live)
    model = structure.build()
    alone = da.solve_buckling(model, 1, "live").load_factors[0]
    modes = da.solve_buckling(model, 1, "live", constant="dead")
    assert modes.load_factors[0] == pytest.approx(alone - 0.4, rel=1e-9)
    check_gradients(modes, [da.at(1, "load_factor", name="f"), da.at(1, "n2.uy", name="u")])
    with pytest.raises(da.SingularityError, match="'dead' alone"):
        da.solve_buckling(model, 1, "live", constant="dead", parameters={"dead": -1.0})


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda m: da.solve_modes(m, 0), "must be positive"),
        (lambda m: da.solve_modes(m, nonsense=1), "solve_modes: .*nonsense"),
        (lambda m: da.solve_buckling(m, 1, "wind"), "no load case 'wind'"),
        (lambda m: da.solve_modes(m)["n1.fx"], "a mode has no n1.fx"),
        (lambda m: da.solve_modes(m)["n1.uq"], "n1.uq"),
        (lambda m: da.solve_modes(m).at(np.array([9.0])), "there is no mode 9"),
        (lambda m: da.solve_modes(m, about=da.solve_statics(m)), "select one with"),
    ],
)
def test_wrong_questions_are_refused(ask, message):
    structure = da.Structure("bar")
    a, b = structure.node("n0", 0, 0), structure.node("n1", 1, 0)
    structure.add(
        structures.Frame("e", a, b, area=1.0, second_moment=1.0, modulus=1.0, density=1.0)
    )
    structure.support(a)
    structure.load(b, case="push", fx=-1.0)
    structure.load(b, case="pull", fx=1.0)
    with pytest.raises(da.errors.DalembertError, match=message):
        ask(structure.build())


def test_where_nothing_buckles():
    """Bars along one line have no other way to go."""
    with pytest.raises(da.AnalysisError, match="does not make the structure buckle"):
        da.solve_buckling(model_of("Truss 1-D"), 1, "push", negative=True)


def test_nothing_that_moves_has_mass():
    structure = da.Structure("spring")
    a, b = structure.node("a", 0), structure.node("b", 1)
    structure.add(structures.AxialSpring("s", a, b, stiffness=1.0))
    structure.support(a)
    with pytest.raises(da.AnalysisError, match="give elements a density"):
        da.solve_modes(structure.build())


@pytest.mark.thorough
def test_differences_of_the_whole_analysis():
    """The front door repeats it at other values, loads and all."""
    model = model_of("Frame 2-D")
    loaded = da.solve_statics(model, nonlinear=True)
    for modes in (da.solve_modes(model, 2, about=loaded), da.solve_buckling(model, 2, "push")):
        response = da.at(1, modes.main)
        exact, differences = (
            da.sensitivity(modes, response, method=m).values
            for m in ("direct", "finite-difference")
        )
        size = np.abs(modes.parameters)
        assert np.abs((differences - exact) * size).max() < 1e-7 * np.abs(exact * size).max()


def test_names_and_units():
    modes = da.solve_modes(model_of("Frame 2-D"), 3)
    data = modes.data
    assert data["frequency"].attrs["units"] == "Hz"
    assert list(data["mode"].values) == [1, 2, 3]
    np.testing.assert_allclose(
        data["shape"].sel(degree="n2.uy").values, modes["n2.uy"].values, rtol=1e-15
    )
    np.testing.assert_allclose(
        modes["angular_frequency*angular_frequency"].values, modes.eigenvalues, rtol=1e-14
    )
    assert "Hz" in repr(modes)
    assert "load_factor" in da.solve_buckling(model_of("Frame 2-D"), 2, "push").data


def test_sums_over_modes_and_cases_are_plain():
    """There is nothing between two modes."""
    modes = da.solve_modes(model_of("Truss 2-D"), 3)
    f = modes.frequencies
    computed = [da.evaluate(modes, make("frequency")) for make in (da.mean, da.integral, da.rms)]
    np.testing.assert_allclose(computed, [f.mean(), f.sum(), np.sqrt((f**2).mean())], rtol=1e-14)
    table = da.sensitivity(modes, [da.integral("frequency"), da.mean("frequency")])
    assert list(table["response_unit"].values) == ["Hz", "Hz"]
