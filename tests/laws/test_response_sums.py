"""Sums of responses, and widths of smooth extremes: gradients by all ways, units and names."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.io.decisions.tasks import make_gradient
from dalembert.io.model_file import load_model_file

STEP = 0.05


def thrown() -> da.Model:
    system = da.System("throw", gravity=(0, -10))
    speed = [system.parameter(n, v, "m/s", (1, 20)) for n, v in (("vx", 3.0), ("vy", 10.0))]
    system.add(planar.Particle("stone", mass=1.0, velocity=tuple(speed)))
    return system.build()


def spring() -> da.StructuralModel:
    structure = da.Structure("spring")
    end = structure.node("end", 0.0)
    structure.add(
        structures.GroundSpring("k", end, stiffness_x=structure.parameter("stiffness", 4.0))
    )
    for name, force in (("a", 1.0), ("b", 3.0)):
        structure.load(end, case=name, fx=force)
    return structure.build()


RESULTS = {
    "dynamics": (lambda: da.solve_dynamics(thrown(), 1.5, step=STEP), "stone.x", "stone.y"),
    "statics": (lambda: da.solve_statics(spring()), "end.ux", "end.fx*1 m/N"),
}


@pytest.mark.few(2)
@pytest.mark.parametrize("kind", RESULTS)
@pytest.mark.parametrize("method", ["direct", "adjoint", "finite-difference"])
def test_a_sum_has_the_value_and_gradient_of_its_terms(kind: str, method: str) -> None:
    solve, first, second = RESULTS[kind]
    result = solve()
    a, b = (
        (da.at(0, first) if kind == "statics" else da.final(first)),
        da.maximum(second, smooth=0.1),
    )
    several = [2 * a - b / 4 + 3, a, sum([a, b]), -(a - a - 0.5 * b), 1 - np.float64(2.0) * b]
    weights = np.array([[2, -0.25], [1, 0], [1, 1], [0, 0.5], [0, -2]])
    values = [da.evaluate(result, r) for r in (a, b)]
    offsets = [3, 0, 0, 0, 1]
    assert [da.evaluate(result, r) for r in several] == pytest.approx(weights @ values + offsets)
    terms = da.sensitivity(result, [a, b], method=method).values
    gradient = da.sensitivity(result, several, method=method)
    np.testing.assert_allclose(gradient.values, weights @ terms, rtol=1e-12, atol=1e-12)
    assert gradient.response_value.values == pytest.approx(weights @ values + offsets)
    assert set(gradient.response_unit.values) == {"m"}


def test_sums_in_batches_hessians_certificates_and_limits() -> None:
    """Everything that takes a response takes a sum: x - 2 y at the end is (vx - 2 vy) T + g T²."""
    model = thrown()
    net = (da.final("stone.x") - 2 * da.final("stone.y") + 1).named("net")
    exact = 3 * 1.5 - 2 * (10 * 1.5 - 5 * 1.5**2) + 1
    motion = da.solve_dynamics(model, 1.5, step=STEP)
    table = da.sensitivity(motion, net, certificate=True)
    assert table.attrs["certificate"].passed
    assert table.values == pytest.approx(np.array([[1.5, -3.0]]))
    assert da.hessian_product(motion, net, {"vx": 1.0}).values == pytest.approx([0, 0], abs=1e-12)
    many = da.solve_dynamics(model, 1.5, step=STEP, parameters={"vx": [3.0, 5.0]})
    assert da.evaluate(many, net).values == pytest.approx([exact, exact + 3.0])
    assert da.sensitivity(many, net).values == pytest.approx(np.array([[[1.5, -3.0]]] * 2))
    best = da.optimize(
        model,
        net,
        subject_to=[da.Limit(da.final("stone.x") - da.final("stone.y"), lower="-3 m")],
        analysis=da.Dynamics(duration=1.5, step=STEP),
    )  # (vx - vy) T >= -3 - g T²/2 keeps both from their bounds
    assert best.x["vy"] == pytest.approx(20.0) and best.fun == pytest.approx(
        1.5 * (best.x["vx"] - 40) + 22.5 + 1
    )
    assert 1.5 * (best.x["vx"] - 20) + 11.25 == pytest.approx(-3.0)


def test_sums_with_other_types_are_refused() -> None:
    motion = da.solve_dynamics(thrown(), 0.5, step=STEP)
    mixed = da.final("stone.x") + da.final("stone.vx")
    with pytest.raises(da.AnalysisError, match="terms in m and in m/s cannot be added"):
        da.evaluate(motion, mixed)
    da.evaluate(motion, da.final("stone.x") + 0.5 * da.final("stone.vx"))
    for wrong in (lambda r: r * r, lambda r: r * True, lambda r: r / r):
        with pytest.raises(da.AnalysisError, match=r"da\.combined"):
            wrong(da.final("stone.x"))
    with pytest.raises(TypeError):
        da.final("stone.x") + "stone.y"


def test_sums_in_files(tmp_path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(
        """
format = 1
gravity = [0, -10]
[parameters]
v = 10.0
[bodies.stone]
type = "Particle"
mass = 1
velocity = [3, "v"]
[responses]
width = { type = "Final", measure = "stone.x" }
height = { type = "Final", measure = "stone.y" }
[combined.net]
formula = "width - 2*height + 1"
[combined.bent]
formula = "width*height"
[analysis]
type = "Dynamics"
duration = 1.5
step = 0.05
[sensitivity]
responses = ["net"]
"""
    )
    file = load_model_file(path)
    model = file.model()
    responses, names = make_gradient(file, model)
    motion = da.solve_dynamics(model, 1.5, step=STEP)
    assert da.sensitivity(motion, list(responses.values()), wrt=names).item() == pytest.approx(-3.0)


@pytest.mark.parametrize("smooth", [0.02, 0.3, 1.0, "0.5 m", "20 mm"])
@pytest.mark.parametrize("kind", [da.Maximum, da.Minimum])
def test_smooth_extremes(smooth, kind) -> None:
    """Bounds by the width, derivatives against differences, and what units leave as it is."""
    rng = np.random.default_rng(1)
    response, times = kind("x", smooth=smooth), np.arange(30.0)
    samples, change = 100 + 3 * rng.normal(size=30), rng.normal(size=30)

    def slope(function):
        e = 1e-5
        return (8 * (function(e) - function(-e)) - (function(2 * e) - function(-2 * e))) / (12 * e)

    value = response.reduce(times, samples)
    width = float(response.smooth) * (1 if isinstance(smooth, str) else np.sqrt(12) * samples.std())
    missed = response.sign * ((response.sign * samples).max() * response.sign - value)
    assert 0 <= missed <= width * np.log(30)
    weights = response.weights(times, samples)
    rate = slope(lambda e: response.reduce(times, samples + e * change))
    assert weights @ change == pytest.approx(rate, rel=1e-6)
    second = slope(lambda e: response.weights(times, samples + e * change))
    computed = response.weights_change(times, samples, change)
    np.testing.assert_allclose(computed, second, atol=1e-6 * np.abs(second).max())
    if not isinstance(smooth, str):  # millimetres or metres, and where the origin is
        moved = response.reduce(times, 1e3 * samples + 7.0)
        assert moved == pytest.approx(1e3 * value + 7.0, rel=1e-12)


def test_widths_that_are_none() -> None:
    motion = da.solve_dynamics(thrown(), 0.5, step=STEP)
    with pytest.raises(
        da.AnalysisError, match=r"smooth is 50, but a number is a share.*'50 N' of a force"
    ):
        da.maximum("stone.y", smooth=50.0)
    with pytest.raises(da.ExpressionError, match="smooth: 5 N does not fit, expected m"):
        da.evaluate(motion, da.maximum("stone.y", smooth="5 N"))
    still = da.maximum("stone.vx", smooth=0.02)  # of samples that are all the same
    assert da.evaluate(motion, still) == pytest.approx(3.0)
    assert da.sensitivity(motion, still).values == pytest.approx(np.array([[1.0, 0.0]]))
