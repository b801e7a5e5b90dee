"""Gradients of linearised eigenvalues: direct = adjoint = differences, and closed forms."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from registry import PLANAR, model_of
from test_derivatives import difference, relative_parameters

import dalembert as da
from dalembert import planar
from dalembert.responses.base import Response, evaluate

G = 9.81


class Builder:
    """A system in which every number is a parameter."""

    def __init__(self, name: str, gravity: bool = True):
        self.system = da.System(name, gravity=(0.0, -G) if gravity else None)
        self.ground = self.system.ground

    def number(self, name: str, value: float):
        return self.system.parameter(name, value, bounds=(value / 4, value * 4))

    def add(self, element):
        return self.system.add(element)


def pendulum(damping: float = 0.0) -> da.Model:
    """A particle on a massless link, ``s = −c/2m ± √(c²/4m² − g/l)`` about its rest."""
    b = Builder("pendulum")
    length, mass = b.number("l", 1.3), b.number("m", 0.7)
    bob = b.add(planar.Particle("bob", mass=mass, position=(0.1, -1.3)))
    b.add(planar.RigidLink("link", b.ground.center, bob.center, length=length))
    if damping:
        c = b.number("c", damping)
        b.add(planar.Force("drag", bob.center, (-c * bob.center.velocity.x, 0.0)))
    return b.system.build()


def oscillator(c: float = 0.6, m: float = 2.0, k: float = 50.0) -> da.Model:
    """``m ẍ + c ẋ + k x = 0`` along a line."""
    b = Builder("oscillator", gravity=False)
    mass = b.add(planar.Particle("mass", mass=b.number("m", m), position=(1.0, 0.0)))
    b.add(planar.UserConstraint("rail", mass.y))
    arguments = {"stiffness": b.number("k", k), "damping": b.number("c", c)}
    b.add(planar.Spring("spring", b.ground.center, mass.center, free_length=1.0, **arguments))
    return b.system.build()


def hung_four_bar() -> da.Model:
    """Three bars hung between two pins, held by an inclined spring with a damper."""
    b = Builder("hung four-bar")
    sizes = {"a": (0.5, -1.2), "b": (1.1, -0.1), "c": (0.6, 1.3)}
    bars = [
        b.add(
            planar.Bar(n, length=b.number(f"l{n}", l), mass=b.number(f"m{n}", 2 * l), angle=angle)
        )
        for n, (l, angle) in sizes.items()
    ]
    ends = [b.ground.center, bars[0].end, bars[1].end, bars[2].end]
    starts = [bars[0].start, bars[1].start, bars[2].start, b.ground.point(b.number("d", 1.2), 0.1)]
    for name, i, j in zip("PQRS", ends, starts, strict=True):
        b.add(planar.Revolute(name, i, j))
    arguments = {"stiffness": b.number("k", 80.0), "damping": b.number("dk", 2.0)}
    top = b.ground.point(b.number("x", 0.2), 0.7)
    b.add(planar.Spring("spring", top, bars[1].center, free_length=b.number("f", 0.9), **arguments))
    return b.system.build()


def masses(damping: float = 0.8) -> da.Model:
    """Two masses in the plane on three springs, gravity and a damper: four modes."""
    b = Builder("masses")
    places = [(0.8, -0.3), (1.7, -0.4)]
    points = [b.ground.center]
    for i, place in enumerate(places):
        body = b.add(planar.Particle(f"p{i}", mass=b.number(f"m{i}", 1.0 + i), position=place))
        points.append(body.center)
    points.append(b.ground.point(b.number("w", 2.5), 0.0))
    for i in range(3):
        arguments = {
            "stiffness": b.number(f"k{i}", 60.0 + 15 * i),
            "damping": b.number(f"c{i}", damping),
        }
        free = b.number(f"f{i}", 0.6)
        b.add(planar.Spring(f"s{i}", points[i], points[i + 1], free_length=free, **arguments))
    return b.system.build()


RESTING = {
    "pendulum": pendulum,
    "damped pendulum": functools.partial(pendulum, 0.5),
    "oscillator": oscillator,
    "overdamped": functools.partial(oscillator, 30.0),
    "hung four-bar": hung_four_bar,
    "masses": masses,
    "masses, heavily damped": functools.partial(masses, 40.0),
}


@functools.cache
def modes_about(kind: str, name: str):
    if kind == "rest":
        return da.linearize(RESTING[name]())
    return da.linearize(model_of(name), equilibrium=False)


PLACES = [("rest", n) for n in RESTING] + [("assembled", n) for n in (*PLANAR, "spatial revolute")]


def distinct(modes) -> list[int]:
    """Numbers of the modes whose eigenvalue is far from all others and from zero."""
    everything = modes.record.eigenvalues
    far = 1e-3 * np.abs(everything).max(initial=0.0)
    return [
        int(k)
        for k, s in zip(modes.numbers, modes.eigenvalues, strict=True)
        if np.sort(np.append(np.abs(everything - s), np.inf))[1] > far and abs(s) > far
    ]


def measured(modes) -> list[Response]:
    measures = ("eigenvalue_real", "eigenvalue_imag", "frequency", "damping_ratio")
    return [da.at(float(k), m) for k in distinct(modes) for m in measures]


@pytest.mark.few(3)
@pytest.mark.parametrize(("kind", "name"), PLACES)
def test_direct_adjoint_and_differences_agree(kind, name):
    """Direct = adjoint to 1e-9, both = differences of repeated linearisations to 1e-6."""
    modes = modes_about(kind, name)
    responses = measured(modes)
    if not responses:  # everything moves freely: all eigenvalues coincide
        with pytest.raises(da.SingularityError, match="coincide"):
            da.sensitivity(modes, da.at(1.0, "eigenvalue_real"))
        return
    adjoint = da.sensitivity(modes, responses, method="adjoint").values
    direct = da.sensitivity(modes, responses, method="direct").values
    dp = relative_parameters(modes.parameters, np.random.default_rng(3))

    def values(p):
        repeated = modes.analysis.replay(modes, p)
        return np.array([evaluate(repeated, r) for r in responses])

    expected = difference(values, modes.parameters, dp, h=3e-3)
    # the four measures of a mode share the scale of its eigenvalue's derivative
    size = np.abs(adjoint).reshape(-1, 4 * adjoint.shape[1]).max(axis=1)
    scale = np.repeat(np.maximum(size, 1e-9), 4)
    assert np.all(np.abs(direct - adjoint) <= 1e-9 * scale[:, None])
    change = adjoint @ dp
    assert np.all(np.abs(change - expected) <= 1e-6 * scale * np.abs(dp).sum())


def test_simple_pendulum():
    """f = √(g/l)/2π: ∂f/∂l = −f/2l, and the mass does not matter."""
    modes = modes_about("rest", "pendulum")
    gradient = da.sensitivity(modes, da.at(1.0, "frequency"), method="adjoint")
    f = np.sqrt(G / 1.3) / (2 * np.pi)
    assert modes.frequencies == pytest.approx([f], rel=1e-10)
    assert gradient.sel(parameter="l").item() == pytest.approx(-f / 2.6, rel=1e-10)
    assert abs(gradient.sel(parameter="m").item()) < 1e-12


@pytest.mark.parametrize("method", ["direct", "adjoint"])
def test_damped_oscillator(method):
    """s = −c/2m ± i √(k/m − c²/4m²): f = √(k/m)/2π, ζ = c/2√(km) and their derivatives."""
    modes = modes_about("rest", "oscillator")
    m, k, c = 2.0, 50.0, 0.6
    f, zeta, beat = np.sqrt(k / m) / (2 * np.pi), c / 2 / np.sqrt(k * m), np.sqrt(25 - 0.0225)
    expected = {
        "frequency": {"m": -f / 2 / m, "k": f / 2 / k, "c": 0.0},
        "damping_ratio": {"m": -zeta / 2 / m, "k": -zeta / 2 / k, "c": zeta / c},
        "eigenvalue_real": {"m": c / 2 / m**2, "k": 0.0, "c": -1 / 2 / m},
        "eigenvalue_imag": {
            "m": (-k / m**2 + c**2 / 2 / m**3) / 2 / beat,
            "k": 1 / m / 2 / beat,
            "c": -c / 2 / m**2 / 2 / beat,
        },
        "m*eigenvalue_imag": {},
    }
    derivative = expected["eigenvalue_imag"]
    expected["m*eigenvalue_imag"] = {n: m * d for n, d in derivative.items()}
    expected["m*eigenvalue_imag"]["m"] += beat
    for measure, derivatives in expected.items():
        gradient = da.sensitivity(modes, da.at(1.0, measure), method=method)
        for name, value in derivatives.items():
            assert gradient.sel(parameter=name).item() == pytest.approx(value, rel=1e-9, abs=1e-12)


def twins() -> da.Model:
    """Two pendulums of the same length and mass: frequencies that coincide."""
    b = Builder("twins")
    for i in (1, 2):
        bob = b.add(planar.Particle(f"bob{i}", mass=1.0, position=(3.0 * i, -1.0)))
        pivot = b.ground.point(3.0 * i, 0.0)
        b.add(planar.RigidLink(f"link{i}", pivot, bob.center, length=b.number(f"l{i}", 1.0)))
    return b.system.build()


def test_modes_that_coincide():
    """One of two equal frequencies has no gradient; their mean has, half from each pendulum."""
    modes = da.linearize(twins())
    assert modes.frequencies == pytest.approx(np.full(2, np.sqrt(G) / (2 * np.pi)), rel=1e-10)
    with pytest.raises(da.SingularityError, match="modes 1 and 2 coincide"):
        da.sensitivity(modes, da.at(1.0, "frequency"))
    slope = -np.sqrt(G) / (4 * np.pi)
    for response in (da.mean("frequency"), da.maximum("frequency", smooth="0.1 Hz")):
        for method in ("direct", "adjoint", "finite-difference"):
            gradient = da.sensitivity(modes, response, method=method).values
            assert gradient == pytest.approx(np.full((1, 2), slope / 2), rel=1e-6)


def test_critical_damping():
    """At c = 2√(km) both eigenvalues are −c/2m without two shapes: only their sum is smooth."""
    modes = da.linearize(oscillator(c=20.0))
    gradient = da.sensitivity(modes, da.mean("eigenvalue_real"), method="adjoint")
    assert gradient.sel(parameter="c").item() == pytest.approx(-1 / 4, rel=1e-6)
    assert gradient.sel(parameter="m").item() == pytest.approx(20 / 8, rel=1e-6)
    for measure in ("frequency", "eigenvalue_imag", "damping_ratio"):
        with pytest.raises(da.SingularityError, match="coincide"):
            da.sensitivity(modes, da.at(1.0, measure))


def test_real_eigenvalues_stay_real():
    """Of an overdamped mode the imaginary part is zero, and so is its gradient, without noise."""
    modes = da.linearize(oscillator(c=30.0))
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(modes, da.at(1, "eigenvalue_imag"), method=method)
        assert not gradient.values.any()


def test_modes_follow_the_parameters_by_shape():
    """Past a crossing of two frequencies a replay keeps each mode, though their order changes."""
    model = twins()
    modes = da.linearize(model, parameters={"l1": 1.0, "l2": 0.99})
    after = modes.analysis.replay(modes, model.values({"l1": 1.0, "l2": 1.01}))
    expected = np.sqrt(G / np.array([1.0, 1.01])) / (2 * np.pi)
    assert after.frequencies == pytest.approx(expected, rel=1e-9)
    again = da.linearize(model, parameters={"l1": 1.0, "l2": 1.01})
    assert again.frequencies == pytest.approx(np.sort(expected), rel=1e-9)


def test_invalid_arguments_of_modes_are_refused():
    """Unknown numbers and measures, states whose gradient nobody follows, floating equilibria."""
    model = RESTING["masses"]()
    modes = da.linearize(model)
    with pytest.raises(da.AnalysisError, match=r"no mode 9 \(known: 1, 2, 3, 4\)"):
        da.evaluate(modes, da.at(9.0, "frequency"))
    with pytest.raises(da.ExpressionError, match="frequency"):
        modes.values("frequncy")
    with pytest.raises(da.AnalysisError, match="a mode has no"):
        modes.values(model["p0.x"])
    motion = da.solve_dynamics(model, 0.2, step=0.01)
    moving = da.linearize(model, about=motion)
    with pytest.raises(da.UnsupportedError, match="about the end of a motion"):
        da.sensitivity(moving, da.at(1.0, "frequency"))
    difference = da.sensitivity(moving, da.at(1.0, "frequency"), ["k0"], "finite-difference")
    assert np.isfinite(difference.values).all()


def test_about_a_given_equilibrium():
    """Modes about an equilibrium that was solved for are those of a search from scratch."""
    model = RESTING["hung four-bar"]()
    about = da.linearize(model, about=da.solve_equilibrium(model))
    modes = modes_about("rest", "hung four-bar")
    response = da.at(1.0, "damping_ratio")
    assert about.eigenvalues == pytest.approx(modes.eigenvalues, rel=1e-9)
    gradients = [da.sensitivity(m, response, method="adjoint").values for m in (about, modes)]
    np.testing.assert_allclose(*gradients, rtol=1e-7)


def test_optimization_to_a_frequency():
    """A design problem reads modes like any result: the length of a seconds pendulum."""
    gap = da.at(1.0, "100*(frequency - 0.5)**2", name="gap")
    analysis = da.Modal()
    best = da.optimize(pendulum(), gap, vary=["l"], analysis=analysis, tolerance=1e-12)
    assert best.x["l"] == pytest.approx(G / np.pi**2, rel=1e-4)


def test_slow_modes_beside_fast_ones_have_gradients():
    """Of two oscillators, ten million times as fast as each other, each follows its own spring."""
    system = da.System("slow and fast")
    slow, fast = system.parameter("slow", 100.0, "N/m"), system.parameter("fast", 1e9, "N/m")
    for name, mass, k in (("a", 1.0, slow), ("b", 1e-7, fast)):
        body = system.add(planar.Body(name, mass=mass, inertia=mass, position=(1.0, 0.0)))
        ground = system.ground.center
        system.add(planar.Prismatic(f"rail_{name}", ground, body.center))
        system.add(planar.Spring(f"s_{name}", ground, body.center, stiffness=k, free_length=1.0))
    modes = da.linearize(system.build())
    gradient = da.sensitivity(modes, [da.at(1, "frequency", name="1"), da.at(2, "frequency", "2")])
    expected = [[modes.frequencies[0] / 200.0, 0.0], [0.0, modes.frequencies[1] / 2e9]]
    np.testing.assert_allclose(gradient, expected, rtol=1e-9, atol=1e-12)
