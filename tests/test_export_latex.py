"""LaTeX equations: the printed sums have the values of the model's matrices."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from matplotlib.mathtext import MathTextParser
from registry import CASES, model_of

import dalembert as da
from dalembert import planar
from dalembert.io.exports.latex.equations import CHOICES, entry_lines, latex_equations
from dalembert.io.exports.latex.notation import Notation


def check(model: da.Model, coordinates: str) -> None:
    """Values of the sums equal those of the equations; every line can be typeset."""
    printed = latex_equations(model, coordinates)
    e = CHOICES[coordinates]().view(model).equations
    columns = [e.mass, e.force - e.bias, e.constraints, e.jacobian]
    inputs = [e.t, e.y, e.v, e.p]
    function = ca.Function("f", inputs, [ca.densify(ca.vec(c)) for c in columns])
    rng = np.random.default_rng(2)
    start = [0.3, rng.normal(size=e.coordinate_count), rng.normal(size=e.speed_count)]
    point = [*start, model.nominal]
    values = dict(zip(printed.symbols, np.concatenate([np.ravel(x) for x in point]), strict=True))
    for expected, array in zip(function(*point), printed.arrays.values(), strict=True):
        actual = np.array([entry.value(values) for entry in array.entries])
        expected = expected.full().ravel()
        scale = np.abs(expected).max(initial=1.0)
        np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * scale)
    parser, notation = MathTextParser("path"), Notation(printed.symbols)
    for letter, array in printed.arrays.items():
        for line in entry_lines(letter, array, notation):
            parser.parse(f"${line[2:-2].strip()}$")


@pytest.mark.product
@pytest.mark.parametrize("coordinates", CHOICES)
@pytest.mark.parametrize("name", CASES)
def test_equations_have_the_values_of_the_model_or_are_too_large(name, coordinates):
    model, message = model_of(name), ""
    try:
        latex_equations(model, coordinates)
    except da.UnsupportedError as error:
        message = str(error)
    if not message:
        check(model, coordinates)
    else:
        assert "too large for LaTeX" in message or "no tree of joints" in message


def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0, -9.81))
    length, mass = system.parameter("l", 0.5, "m"), system.parameter("m_rod", 2.0, "kg")
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=-1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    return system.build()


def test_a_pendulum_has_its_moment_of_inertia(tmp_path):
    text = da.export(pendulum(), tmp_path / "pendulum.tex").files[0].read_text()
    assert r"M_{1,1} = \frac{1}{3} \, l^{2} \, m_{\mathrm{rod}}" in text
    assert text.startswith(r"\documentclass") and r"\varphi_{O}" in text


def test_large_models_are_refused_with_a_remedy(tmp_path):
    system = da.System("chain", gravity=(0, -9.81))
    point = system.ground.center
    for k in range(8):
        bar = system.add(planar.Bar(f"b{k}", length=0.5, mass=1.0))
        system.add(planar.Revolute(f"J{k}", point, bar.start))
        point = bar.end
    with pytest.raises(da.UnsupportedError, match=r"too large for LaTeX.*coordinates='absolute'"):
        da.export(system.build(), tmp_path / "x.tex")
    assert not list(tmp_path.iterdir())
