"""Dimensions of formulas: a sum of two kinds is refused, all else is what it scales like."""

import re

import pytest
from hypothesis import given, settings, strategies as st

import dalembert as da
from dalembert import planar
from dalembert.io.decisions.tasks import check_tasks
from dalembert.io.model_file import load_model_file
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.units.amounts import Amount
from dalembert.units.grammar import Grammar
from dalembert.units.unit import unit

UNITS = {"a": "m", "b": "m", "c": "s", "d": "kg", "f": "N", "n": "1", "s": "m/s"}
NAMES = {name: da.Parameter(name, 1.5, unit=text) for name, text in UNITS.items()}
AMOUNTS = {name: Amount(1.5, unit(text)) for name, text in UNITS.items()}


def joined(parts):
    pair = st.tuples(parts, st.sampled_from(["+", "-", "*", "/"]), parts)
    return st.one_of(
        pair.map(lambda p: f"({p[0]} {p[1]} {p[2]})"),
        parts.map(lambda p: f"({p})**2"),
        parts.map(lambda p: f"(-{p})"),
    )


@settings(max_examples=300, deadline=None)
@given(st.recursive(st.sampled_from(list(UNITS)), joined, max_leaves=8))
def test_a_formula_has_the_dimension_that_arithmetic_of_amounts_gives(text):
    try:
        amount = Grammar(text, AMOUNTS.get, list, {}).run()
    except da.ExpressionError as error:
        if "cannot be added" in error.message:  # amounts say so of differences as well
            with pytest.raises(da.ExpressionError, match=r"cannot be (added|subtracted)"):
                parse_formula(text, NAMES.get)
        return  # a division by zero
    computed, wanted = parse_formula(text, NAMES.get).unit, dict(amount.unit.dimension)
    if max(map(abs, wanted.values()), default=0) > 12:
        assert not computed  # beyond the powers of units
    else:
        assert dict(unit(computed or "1").dimension) == wanted


@settings(max_examples=200, deadline=None)
@given(
    st.recursive(st.sampled_from([*UNITS, "2", "0.5", "pi", "3 mm"]), joined, max_leaves=8),
    st.sampled_from("acdn"),
)
def test_plain_numbers_are_of_any_kind(text, other):
    """A plain number has the unit of what it is added to, but for an amount with a unit."""
    try:
        parse_formula(f"{text} + {other}", NAMES.get)
    except da.ExpressionError:
        return
    parse_formula(f"2*{text} + {other}", NAMES.get)
    if any(name in NAMES for name in re.findall(r"\w+", text)):
        parse_formula(f"{text} + 7", NAMES.get)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a + 3 deg", r"a \[m\] and 3 deg \[rad\] cannot be added; a factor"),
        ("2*45 mm - c", r"2\*45 mm \[m\] and c \[s\] cannot be subtracted"),
        ("a < c", "cannot be compared"),
        ("min(a, 2 kg)", "cannot be taken together"),
        ("where(a < 1, a, c)", "cannot be chosen between"),
        ("sqrt(a**2 + b**2) + c", r"sqrt\(a\*\*2 \+ b\*\*2\) \[m\] and c"),
        ("sin(a + c)", "cannot be added"),
        ("1 + (a + c)", "cannot be added"),
    ],
)
def test_mixtures_are_refused_by_name(text, message):
    with pytest.raises(da.ExpressionError, match=message):
        parse_formula(text, NAMES.get)


KNOWN = {
    "a + 0.1": "",
    "100*a + f": "",  # a plain number may be a stiffness
    "sin(a) + c": "",
    "a/c - s": "m/s",
    "d*s/c + f": "N",
    "hypot(a, b)": "m",
    "atan2(a, b)": "rad",
    "abs(-a)": "m",
    "sqrt(a*b)": "m",
    "a**(4/2)": "m^2",
    "a**n": "",
    "a/b + 3 deg": "",  # angles are numbers
}


@pytest.mark.parametrize("text", KNOWN)
def test_formulas_have_the_unit_that_is_known(text):
    assert parse_formula(text, NAMES.get).unit == KNOWN[text]


def crank():
    system = da.System("crank")
    length = system.parameter("l", 200, unit="mm", bounds=(100, 300))
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angular_velocity=1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    system.table("lift", [0, 1], [0, 1], kind="linear", units=("rad", "mm"))
    return system.build()


def test_measures_and_tables_have_dimensions():
    model = crank()
    assert model.expression("bar.end.x + bar.end.y").unit == "m"
    assert model.expression("interp(bar.angle, lift) + l").unit == "m"
    with pytest.raises(da.ExpressionError, match=r"kinetic_energy \[J\] and bar.x \[m\]"):
        model.expression("kinetic_energy + bar.x")
    with pytest.raises(da.ExpressionError, match="cannot be added"):
        model.expression("interp(bar.angle, lift) + bar.angle")


def test_numbers_of_decisions_have_units():
    model, run = crank(), da.Dynamics(0.1, step=0.05)
    end = da.final(model["bar.end.x"])
    assert da.Limit(end, upper="20 cm").upper == 0.2
    with pytest.raises(da.ModelError, match="3 kg does not fit, expected m"):
        da.Limit(end, upper="3 kg")
    result = da.tolerance(model, end, {"l": "0.1 mm"}, analysis=run, worst_case=False)
    assert result.tolerances == {"l": pytest.approx(1e-4)}
    with pytest.raises(da.ModelError, match="tolerance of l: 1 deg does not fit"):
        da.tolerance(model, end, {"l": "1 deg"}, analysis=run)
    for design in (
        da.DesignTable.grid({"l": ["10 cm", 0.2]}),
        da.DesignTable.table({"l": ["100 mm", "0.2 m"]}),
    ):
        assert design.values.ravel() == pytest.approx([0.1, 0.2])
    with pytest.raises(da.ModelError, match="10 s does not fit, expected m"):
        da.sweep(model, da.DesignTable.grid({"l": ["10 s"]}), analysis=run, responses=[end])
    with pytest.raises(da.AnalysisError, match=r"l: .* unknown name"):
        da.DesignTable.grid({"l": ["wide"]})
    assert da.Normal("12 mm", std="1e-1 mm").moments == pytest.approx((0.012, 1e-4))
    with pytest.raises(da.ModelError, match=r"l\.mean: 12 s does not fit, expected m"):
        da.Normal("12 s", std=1e-4).check_units("m", "l")


FILE = """
format = 1
[parameters]
l = { value = 200, unit = "mm", bounds = [100, 300] }
[bodies.bar]
type = "Bar"
length = "l"
mass = 1
[joints.O]
type = "Revolute"
connect = ["ground", "bar.start"]
[analysis]
type = "Dynamics"
duration = 0.1
step = 0.05
[responses]
reach = { type = "Final", measure = "bar.end.x" }
"""
TASKS = {
    "[sweep]\nvary = { l = ['1 cm', '%s'] }": ("60 mm", "90 deg", "sweep.vary.l"),
    "[tolerance]\nresponse = 'reach'\ntolerances = { l = '%s' }": (
        "0.1 mm",
        "0.1 s",
        "tolerance.tolerances.l",
    ),
    "[optimize]\nminimize = 'reach'\ncatalogues = [{ l = ['10 cm', '%s'] }]": (
        "12 cm",
        "12 kg",
        "optimize.catalogues",
    ),
    "[optimize]\nminimize = 'reach'\nsubject_to = [{ response = 'reach', upper = '%s' }]": (
        "12 cm",
        "12 N",
        "subject_to",
    ),
    "[reliability]\nlimits = [{ response = 'reach', upper = 1 }]\n[[random]]\nparameter = 'l'\n"
    "type = 'Normal'\nmean = '20 cm'\nstd = '%s'": ("1 mm", "1 s", "random"),
}


@pytest.mark.parametrize("text", TASKS)
def test_numbers_of_tasks_in_files_have_units(text, tmp_path):
    right, wrong, place = TASKS[text]
    path = tmp_path / "model.toml"
    for number, fits in ((right, True), (wrong, False)):
        path.write_text(FILE + text % number)
        file = load_model_file(path)
        if fits:
            check_tasks(file, file.model())
            continue
        with pytest.raises(da.ModelError, match=f"{place}.*{wrong} does not fit, expected m"):
            check_tasks(file, file.model())


def test_the_first_value_of_a_history_is_in_its_unit(tmp_path):
    path = tmp_path / "model.toml"
    for value in ("5", "'5 kN'", "'5000 N'"):
        history = f"[histories.push]\nknots = [0, 1, 2, 3]\nvalue = {value}\nunit = 'kN'\n"
        path.write_text(FILE + history)
        parameter = load_model_file(path).model().parameters["push_0"]
        assert (parameter.value, parameter.unit, parameter.declared_unit) == (5000.0, "N", "kN")
