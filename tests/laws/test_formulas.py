"""Formulas in text mean what Python means by them."""

from __future__ import annotations

import contextlib
import math
import re

import casadi as ca
import pytest
from hypothesis import assume, given, settings, strategies as st

from dalembert.errors import ExpressionError, UnknownNameError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.symbolic.once import CACHE_SIZE, CacheOwner, once

X, Y = Expression(ca.SX.sym("x")), Expression(ca.SX.sym("y"))
NAMES = {"x": X, "y": Y, "body.x": Y}
MEANING = {
    **{
        n: getattr(math, n) for n in ("sin", "cos", "tanh", "exp", "atan", "atan2", "hypot", "sqrt")
    },
    "abs": abs,
    "min": min,
    "max": max,
    "floor": math.floor,
    "where": lambda c, a, b: a if c else b,
    "smooth_abs": lambda a, w: math.sqrt(a * a + w * w),
    "sign": lambda a: (a > 0) - (a < 0),
    "pi": math.pi,
    "e": math.e,
}

leaves = st.one_of(
    st.sampled_from(["x", "y", "pi", "e"]),
    st.floats(0.01, 9, allow_nan=False).map(lambda v: repr(round(v, 3))),
    st.integers(0, 9).map(str),
)


def _grow(inner):
    one = st.sampled_from(["sin", "cos", "tanh", "atan", "abs", "floor", "sign"])
    two = st.sampled_from(["min", "max", "hypot", "atan2", "smooth_abs"])
    return st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/"]), inner).map(" ".join),
        st.tuples(inner, st.sampled_from(["+", "-", "*"]), inner).map(lambda p: f"({' '.join(p)})"),
        inner.map(lambda a: f"-{a}"),
        st.tuples(inner, st.integers(0, 3)).map(lambda p: f"({p[0]}) ** {p[1]}"),
        st.tuples(one, inner).map(lambda p: f"{p[0]}({p[1]})"),
        st.tuples(two, inner, inner).map(lambda p: f"{p[0]}({p[1]}, {p[2]})"),
        st.tuples(st.sampled_from(["<", "<=", ">", ">="]), inner, inner, inner, inner).map(
            lambda p: f"where({p[1]} {p[0]} {p[2]}, {p[3]}, {p[4]})"
        ),
    )


formulas = st.recursive(leaves, _grow, max_leaves=12)
numbers = st.floats(-3, 3, allow_nan=False)


def value(formula: Expression, x: float, y: float) -> float:
    return float(ca.Function("f", [X.sx, Y.sx], [formula.sx])(x, y))


@settings(max_examples=300)
@given(text=formulas, x=numbers, y=numbers)
def test_any_formula_has_the_value_python_gives_it(text, x, y):
    try:
        expected = eval(text, {"__builtins__": {}}, {**MEANING, "x": x, "y": y})
        computed = value(parse_formula(text, NAMES.get), x, y)
    except (ZeroDivisionError, OverflowError, ExpressionError):
        assume(False)
    assume(math.isfinite(expected) and abs(expected) < 1e9)
    assert computed == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2 ** 3 ** 2", 512.0),
        ("-x ** 2", -0.25),
        ("2 * body.x", 4.0),
        ("x - y - 1", -2.5),
        ("8 / 4 / 2", 1.0),
        ("1e-3 * pi", 1e-3 * math.pi),
        ("where(x < y, 1, 2)", 1.0),
    ],
)
def test_precedence_and_names(text, expected):
    assert value(parse_formula(text, NAMES.get), 0.5, 2.0) == pytest.approx(expected)


@settings(max_examples=200)
@given(text=st.text(max_size=40))
def test_any_text_is_a_formula_or_a_clear_error(text):
    """Nothing but ``ExpressionError`` ever comes out."""
    with contextlib.suppress(ExpressionError):
        parse_formula(text, NAMES.get, lambda: list(NAMES))


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "x.__class__",
        "(lambda: 1)()",
        "[x]",
        "x if y else 1",
        "x == y",
        "x and y",
        "sin()",
        "sin(x, y)",
        "unknown",
        "9**9**9",
        "1/0",
        "(" * 60 + "x" + ")" * 60,
        "",
        "x; y",
        "'a'",
        "True",
        "nan",
        "x @ y",
        "x[0]",
        "sin(x=1)",
        "*x",
        "x := 1",
        "1e999",
    ],
)
def test_everything_else_is_refused(text):
    with pytest.raises(ExpressionError):
        parse_formula(text, NAMES.get)


def _measured_models():
    """A mechanism and a structure, each with a measure, a formula of it and a misspelt name."""
    import dalembert as da
    from dalembert import planar, structures

    system = da.System("pendulum", gravity=(0.0, -9.81))
    mass = system.parameter("m", 2.0)
    bob = system.add(planar.Bar("bob", length=1.0, mass=mass, angle=-0.5))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bob.start))
    structure = structures.Structure("rod")
    area = structure.parameter("A", 1e-4)
    nodes = structure.add_nodes("n", [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    bars = structures.Truss, nodes, [[0, 1], [1, 2]]
    structure.add_elements("rods", *bars, modulus=2e11, area=area)
    structure.support(nodes, uy=0)
    structure.support(nodes[0], ux=0)
    structure.load(nodes[2], fx=1000.0)
    return [
        (system.build(), "bob.x", "bob.x * m", "bob.xx"),
        (
            structure.build(),
            "rods[1].stress",
            "rods[1].stress * A - rods.stress.max(0.1)",
            "rods[1].stresss",
        ),
    ]


def test_sums_may_have_a_hundred_terms():
    """Each term stands one deeper in the tree than the next; what is nested stays bounded."""
    names = {f"x{k}": Expression(ca.SX.sym(f"x{k}")) for k in range(100)}
    formula = parse_formula("9 - " + " - ".join(names), names.get)
    at_ones = ca.Function("f", [k.sx for k in names.values()], [formula.sx])(*[1.0] * 100)
    assert float(at_ones) == -91
    with pytest.raises(ExpressionError, match="too large"):
        parse_formula("x" + " + x" * 130, NAMES.get)


@pytest.mark.parametrize("kind", [0, 1])
def test_a_name_comes_before_a_formula(kind):
    """Names with numbers in them are names, alone and in formulas; all readers agree."""
    model, name, formula, misspelt = _measured_models()[kind]
    assert model.expression(name) is model[name] and model.expression(name).name == name
    assert model.expression(formula).name == formula
    for text in (misspelt, f" {misspelt} "):
        with pytest.raises(KeyError, match=rf"^no measure '{re.escape(misspelt)}'; nearest: "):
            model.expression(text)
    with pytest.raises(
        UnknownNameError, match=rf"in formula .*unknown name '{re.escape(misspelt)}'"
    ):
        model.expression(f"2 * {misspelt}")
    with pytest.raises(ExpressionError, match="a name, a formula or an expression, got 3"):
        model.expression(3)


def test_measures_are_made_once():
    """Asking again compiles nothing, nor does a formula asked for twice."""
    import dalembert as da

    model, name, formula, _ = _measured_models()[0]
    motion = da.solve_dynamics(model, 0.1, step=0.01)
    motion.values(name), motion.values(formula)
    results = [model.function(model.expression(m)) for m in (name, formula)]
    motion.values(name), motion[formula]
    assert results == [model.function(model.expression(m)) for m in (name, formula)]
    one, two = motion.columns([name, formula])
    assert (one == motion.values(name)).all() and (two == motion.values(formula)).all()


def test_kept_results_are_bounded_and_go_with_their_owner():
    import weakref

    class Owner(CacheOwner):
        evaluations = 0

        @once
        def square(self, number):
            self.evaluations += 1
            return number**2

    owner = Owner()
    assert [owner.square(3), owner.square(3), owner.evaluations] == [9, 9, 1]
    for number in range(CACHE_SIZE + 10):
        owner.square(number)
    assert (
        owner.square(3) == 9 and owner.evaluations == CACHE_SIZE + 11
    )  # 3 was kept longer than the others
    assert sum(len(entries) for entries in owner.cache.values()) == CACHE_SIZE
    seen = weakref.ref(owner)
    del owner
    assert seen() is None
