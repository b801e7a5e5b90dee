"""LaTeX equations: the printed sums have the values of the model's matrices."""

from __future__ import annotations

import math
import re
import shutil
import subprocess
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from matplotlib.mathtext import MathTextParser
from registry import CASES, model_of

import dalembert as da
from dalembert import planar
from dalembert.io.exports.latex.equations import CHOICES, latex_equations
from dalembert.io.exports.latex.notation import Notation

EXAMPLES = Path(__file__).parents[1] / "examples"


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
    for array in printed.arrays.values():
        for entry in array.entries:
            parser.parse(f"${notation.sum(entry)}$")


@pytest.mark.few(10)
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


class Reader:
    """Value of a printed formula: the grammar of sums, products, fractions, powers and functions.

    Parameters
    ----------
    values : notation of a symbol → its value
    """

    NAMES = {"ln": "log", "arcsin": "asin", "arccos": "acos", "arctan": "atan"}

    def __init__(self, text: str, values: dict[str, float]):
        symbols = sorted(map(re.escape, values), key=len, reverse=True)
        number, space = r"\d+\.?\d*", r"\\[, ]|\s|\{\}|&|\\\\"
        parts = [*symbols, number, r"\\left.", r"\\right.", r"\\[A-Za-z]+", r"."]
        tokens = re.findall("|".join([f"(?:{space})", *parts]), text)
        self.tokens = [x for x in tokens if not re.fullmatch(space, x)] + ["end"]
        self.values = values

    def take(self, *expected: str) -> str:
        token = self.tokens.pop(0)
        assert not expected or token in expected, (token, expected, self.tokens)
        return token

    def whole(self) -> float:
        value = self.sum()
        self.take("end")
        return value

    def sum(self) -> float:
        sign = -1.0 if self.tokens[0] == "-" else 1.0
        if self.tokens[0] == "-":
            self.take()
        total = sign * self.product()
        while self.tokens[0] in "+-":
            sign = -1.0 if self.take() == "-" else 1.0
            total += sign * self.product()
        return total

    def product(self) -> float:
        value = self.power()
        while self.tokens[0] not in (*"+-})]|,", "end", "\\right)", "\\right|", "<", "=", "\\leq"):
            if self.tokens[0] == "\\cdot":
                self.take()
            value *= self.power()
        return value

    def power(self) -> float:
        value = self.atom()
        return value ** self.exponent()

    def exponent(self) -> float:
        if self.tokens[0] != "^":
            return 1.0
        self.take()
        return self.braced()

    def braced(self) -> float:
        self.take("{")
        value = self.sum()
        self.take("}")
        return value

    def atom(self) -> float:
        token = self.take()
        if token in self.values:
            return self.values[token]
        if re.fullmatch(r"[\d.]+", token):
            return float(token)
        if token == "\\frac":
            return self.braced() / self.braced()
        if token == "\\sqrt":
            return math.sqrt(self.braced())
        if token in ("\\left(", "\\left|"):
            value = self.sum()
            return value if self.take("\\right)", "\\right|") == "\\right)" else abs(value)
        power = self.exponent()
        self.take("\\left(")
        value = getattr(math, self.NAMES.get(token[1:], token[1:]))(self.sum())
        self.take("\\right)")
        return value**power


def printed_equations(text: str) -> list[tuple[str, str]]:
    """Left and right sides of the displayed equations."""
    text = text[text.index(r"\paragraph") :]
    found = re.findall(r"\\\[ (.*?) \\\]|\\begin\{align\*\}\n(.*?)\n\\end", text, re.DOTALL)
    return [tuple((short or long).split("=", 1)) for short, long in found]


@pytest.mark.parametrize("coordinates", CHOICES)
@pytest.mark.parametrize("name", ["four_bar", "sliding_pendulum", "slider_crank", "cart_a"])
def test_the_printed_text_has_the_values_of_the_model(name, coordinates, tmp_path):
    """The equations are read from the document and evaluated; signs, brackets and breaks count."""
    model = da.load_model(EXAMPLES / f"{name}.toml").build()
    text = da.export(model, tmp_path / "x.tex", coordinates=coordinates).files[0].read_text()
    symbols = latex_equations(model, coordinates).symbols
    view = CHOICES[coordinates]().view(model)
    e = view.equations
    rng = np.random.default_rng(7)
    point = [0.3, rng.normal(size=e.coordinate_count), rng.normal(size=e.speed_count)]
    point.append(model.nominal)
    numbers = np.concatenate([np.ravel(x) for x in point])
    values = dict(zip(symbols.values(), numbers, strict=True))
    arrays = {"M": e.mass, "h": e.force - e.bias, r"\Phi": e.constraints, "C": e.jacobian}
    inputs = [e.t, e.y, e.v, e.p]
    columns = [ca.densify(c) for c in arrays.values()]
    expected = dict(zip(arrays, ca.Function("f", inputs, columns)(*point), strict=True))
    printed = printed_equations(text)
    for left, right in printed:
        letter, place = left.strip().split("_")
        row, *column = (int(k) - 1 for k in place.strip("{} ").split(","))
        matrix = expected[letter].full()
        value = matrix[row, column[0] if column else 0]
        scale = np.abs(matrix).max()
        assert Reader(right, values).whole() == pytest.approx(value, abs=1e-11 * scale, rel=1e-11)
    upper = np.count_nonzero(np.triu(expected["M"].full()))
    others = [expected[letter].full() for letter in ("h", r"\Phi")]
    jacobian = np.count_nonzero(expected["C"].full())
    assert len(printed) >= upper + jacobian + sum(map(np.count_nonzero, others))


def awkward(name: str, parameter: str, unit: str, bar_name: str, value: float = 0.5) -> da.Model:
    system = da.System(name, gravity=(0, -9.81))
    torque = system.parameter(parameter, value, unit)
    bar = system.add(planar.Bar(bar_name, length=0.5, mass=2.0, angle=-1.0))
    system.add(planar.Revolute("O_1", system.ground.center, bar.start))
    if unit == "N m":
        system.add(planar.Torque("T", bar, torque))
    return system.build()


AWKWARD = [
    ("a_b & 100% #1 $x^2 {~} \\foo", "k", "N m", "b"),
    ("Größe Ω µ °", "Ω", "N m", "Länge"),
    ("x", "länge", "1/s^2", "stab_2"),
    ("x", "µ", "kg m^2/s", "m", -1e-7),
    ("тест", "масса", "N m", "тело"),
]


@pytest.mark.parametrize("texts", AWKWARD)
def test_any_name_and_unit_is_typeset(texts, tmp_path):
    """Only characters of LaTeX's own alphabet are outside of commands; pdflatex runs if present."""
    model = awkward(*texts)
    for coordinates in CHOICES:
        file = da.export(model, tmp_path / "x.tex", coordinates=coordinates).files[0]
        text = file.read_text("utf-8")
        body = text[text.index(r"\begin{document}") :]
        outside = re.sub(r"\$[^$]*\$|\\\[.*?\\\]|\\.", "", body.replace(r"\$", ""), flags=re.DOTALL)
        outside = re.sub(r"align\*\}.*?align\*\}", "", outside, flags=re.DOTALL)
        assert not set("#$%&_^~") & set(outside)
        for character in {c for c in body if not c.isascii() and c not in "äöüß"}:
            assert rf"\DeclareUnicodeCharacter{{{ord(character):04X}}}" in text
        if compiler := shutil.which("pdflatex"):
            command = [compiler, "-interaction=nonstopmode", "-halt-on-error", "x.tex"]
            process = subprocess.run(command, cwd=tmp_path, capture_output=True)
            assert process.returncode == 0, process.stdout[-2000:]
            assert b"Missing character" not in process.stdout


def test_equal_notations_are_told_apart(tmp_path):
    """Parameters l1 and l_1, and those called like a coordinate or an array, differ in print."""
    system = da.System("names", gravity=(0, -9.81))
    lengths = [system.parameter(n, 0.5, "m") for n in ("l1", "l_1", "M", "x_b")]
    bar = system.add(planar.Bar("b", length=lengths[0] + lengths[1], mass=lengths[2] / lengths[3]))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    symbols = latex_equations(system.build(), "absolute").symbols
    assert len(set(symbols.values())) == len(symbols)
    assert symbols["p:l1"] == r"\mathrm{l1}" and symbols["p:l_1"] == r"\mathrm{l\_1}"
    assert symbols["q:b.x"] == "x_{b}" and symbols["p:x_b"] == r"\mathrm{x\_b}"


def test_operations_without_a_notation_are_named(tmp_path):
    model = da.load_model(EXAMPLES / "cam_follower.toml").build()
    with pytest.raises(
        da.UnsupportedError, match=r"cannot be written in LaTeX: they contain an in"
    ):
        da.export(model, tmp_path / "x.tex")
    assert not list(tmp_path.iterdir())


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
