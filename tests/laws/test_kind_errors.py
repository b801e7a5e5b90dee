"""Slips in Python are told as kindly as those in files."""

import ast
import dataclasses
import inspect
import math
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.analysis import keywords
from dalembert.elements.registry import SPACES
from dalembert.errors import KeywordError


def pendulum(angle=None):
    system = da.System("x", gravity=(0.0, -9.81))
    length = system.parameter("length", 0.5, bounds=(0.1, 1.0))
    bob = system.add(planar.Bar("bob", length=length, mass=1.0, angle=angle))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bob.start))
    return system, bob, system.build()


CLASSES = {
    f"{space.name}.{name}": cls
    for space in SPACES.values()
    for section in space.sections.values()
    for name, cls in section.items()
} | {name: getattr(da, name) for name in ("Dynamics", "Radau", "Projection", "Maximum")}


def required(thing) -> list[str]:
    """Arguments that must be given."""
    taken = inspect.signature(thing).parameters.values()
    return [p.name for p in taken if p.default is p.empty and p.kind is not p.VAR_KEYWORD]


def other(cls: type, needed: list[str]) -> str:
    """An argument beside those."""
    return next((n for n in inspect.signature(cls).parameters if n not in needed), needed[0])


@pytest.mark.parametrize("name", CLASSES)
def test_a_misspelt_keyword_of_a_class_is_told_with_the_nearest(name):
    cls = CLASSES[name]
    fields = [f.name for f in dataclasses.fields(cls) if f.init]
    slip = fields[-1] + "x"
    with pytest.raises(KeywordError, match=rf"unknown keyword '{slip}' \(did you mean '"):
        cls(**{slip: 1.0})
    shown = inspect.signature(cls).parameters  # what editors and help() show
    assert set(shown) == set(fields)


@pytest.mark.parametrize(
    "verb",
    [
        *(da.optimize, da.pareto, da.identify, da.sensitivity, da.sweep, da.compare),
        *(da.reliability, da.tolerance, da.synthesize, da.invert),
    ],
)
def test_a_misspelt_keyword_of_a_verb_is_told_with_the_nearest(verb):
    slip = list(inspect.signature(verb).parameters)[-1] + "x"
    with pytest.raises(KeywordError, match=rf"{verb.__name__}: unknown keyword '{slip}'"):
        verb(**{slip: 1.0})


@pytest.mark.parametrize("name", [name for name in CLASSES if required(CLASSES[name])])
def test_a_missing_argument_of_a_class_is_told_with_all_that_is_needed(name):
    cls = CLASSES[name]
    needed = required(cls)
    with pytest.raises(KeywordError, match=rf"{cls.__name__}: missing .*{needed[-1]}; needed: "):
        cls(**{name: 1.0 for name in [*needed[:-1], other(cls, needed)] if name != needed[-1]})


def test_a_missing_argument_is_told_before_others_are_looked_at():
    with pytest.raises(KeywordError, match="Bar: missing length; needed: name, length"):
        planar.Bar("bob", mass=-1.0)
    with pytest.raises(KeywordError, match="Revolute: missing point_j; needed: name, point_i, p"):
        planar.Revolute("O", 3)
    with pytest.raises(KeywordError, match="Harmonic: missing frequency; needed: amplitude, freq"):
        da.Harmonic(1.0)
    with pytest.raises(KeywordError, match="Parameter: missing value; needed: name, value"):
        da.Parameter("a")
    with pytest.raises(KeywordError, match=r"System: unknown keyword 'gravty' .did you mean 'grav"):
        da.System("a", gravty=(0, -9.81))
    with pytest.raises(KeywordError, match="tube: missing wall; needed: diameter, wall"):
        da.structures.tube(0.1)


@pytest.mark.parametrize(
    "verb",
    [
        *(da.solve_dynamics, da.solve_kinematics, da.solve_inverse_dynamics, da.solve_nonsmooth),
        *(da.solve_equilibrium, da.solve_assembly, da.linearize, da.solve_statics, da.evaluate),
        *(da.solve_modes, da.solve_buckling, da.solve_load_path, da.solve_transient, da.final),
        *(da.compare, da.identify, da.sensitivity, da.sweep, da.tolerance, da.synthesize, da.at),
    ],
)
def test_a_missing_argument_of_a_verb_is_told(verb):
    needed = required(verb)
    with pytest.raises(KeywordError, match=f"^{verb.__name__}: missing {', '.join(needed)}; "):
        verb()


@pytest.mark.parametrize("bare", [True, False])
def test_a_response_without_bounds_is_no_limit(bare):
    _, _, model = pendulum()
    response = da.final("bob.angle")
    limits = response if bare else [response]
    with pytest.raises(da.AnalysisError, match=r"got final\(bob.angle\); give its bounds"):
        da.optimize(model, minimize=response, subject_to=limits, analysis=da.Dynamics(duration=0.1))


@pytest.mark.parametrize(
    ("slip", "error", "message"),
    [
        (lambda b, m: b.ends, AttributeError, "no point or measure 'ends' .did you mean 'end'"),
        (
            lambda b, m: b.add_point("tip", (0.1, 0.0)).body.tip,
            AttributeError,
            r"bob has a point 'tip': write point\('tip'\)",
        ),
        (lambda b, m: b.points["tip"], da.UnknownNameError, "unknown point 'tip'; known: start"),
        (lambda b, m: b.point("strat"), da.ModelError, "unknown point .* mean 'start'"),
        (lambda b, m: m["bob.angl"], da.UnknownNameError, "nearest: bob.angle"),
        (lambda b, m: m.values({"lenght": 1.0}), da.ModelError, "did you mean 'length'"),
        (lambda b, m: planar.Bar("c", length="l1", mass=1.0), da.ModelError, "without quotes"),
        (
            lambda b, m: math.sin(m["length"]),
            da.ExpressionError,
            "functions of formulas are da.sin",
        ),
        (lambda b, m: np.isfinite(m["length"]), da.ExpressionError, "np.isfinite does not accept"),
    ],
)
def test_slips(slip, error, message):
    _, bob, model = pendulum()
    with pytest.raises(error, match=message):
        slip(bob, model)


def test_numpy_knows_formulas():
    x = da.System("x").parameter("x", 0.3)
    at = {"sin": np.sin, "sqrt": np.sqrt, "hypot": lambda v: np.hypot(v, 2.0)}
    for name, function in at.items():
        value = ca.Function("f", [x.sx], [function(x).sx])(0.3)
        assert float(value) == pytest.approx(float(function(0.3)), rel=1e-15), name
    for product in (np.float64(2.0) * x, x * np.float64(2.0)):
        assert isinstance(product, da.Expression)
    assert len(np.array([1.0, 2.0]) * x) == 2


ANALYSES = {
    keywords.DynamicsKeywords: [da.Dynamics],
    keywords.OverTimeKeywords: [da.Kinematics],
    keywords.NonsmoothKeywords: [da.Nonsmooth],
    keywords.EquilibriumKeywords: [da.Equilibrium],
    keywords.StaticsKeywords: [da.Statics, da.Equilibrium],
    keywords.ModalKeywords: [da.Modal],
    keywords.BucklingKeywords: [da.Buckling],
    keywords.ArcLengthKeywords: [da.ArcLength],
}
SPOKEN = {"duration", "count", "case", "coordinates", "about"}
"""Arguments that verbs name themselves."""


@pytest.mark.parametrize("kind", ANALYSES, ids=lambda kind: kind.__name__)
def test_typed_keywords_are_the_fields_of_the_analyses(kind):
    fields = {f.name for cls in ANALYSES[kind] for f in dataclasses.fields(cls)}
    written = set(kind.__annotations__)
    assert written <= fields
    assert fields - written <= SPOKEN


def test_no_verb_takes_untyped_options():
    for name in da.__all__:
        computed = getattr(da, name)
        if inspect.isfunction(computed) and name.startswith(("solve_", "linearize")):
            for one in inspect.signature(computed).parameters.values():
                if one.kind is one.VAR_KEYWORD and name not in (
                    "solve_dynamics",
                    "solve_equilibrium",
                ):
                    assert "Unpack" in str(one.annotation), name
    for path in (
        "analysis/dynamics/solve.py",
        "analysis/equilibrium/equilibrium.py",
    ):  # typed by their overloads
        tree = ast.parse((Path(da.__file__).parent / path).read_text(encoding="utf-8"))
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and any(
                isinstance(d, ast.Name) and d.id == "overload" for d in node.decorator_list
            ):
                assert node.args.kwarg is not None and node.args.kwarg.annotation is not None
                assert "Unpack" in ast.unparse(node.args.kwarg.annotation)


MANY_FORMS = {
    "arrays": lambda name: {name: [0.4, 0.5]},
    "a list": lambda name: [{name: 0.4}, {name: 0.5}],
    "a table": lambda name: np.array([[0.4], [0.5]]),
}


@pytest.mark.parametrize("form", MANY_FORMS)
@pytest.mark.parametrize("verb", [da.linearize, da.solve_modes, da.solve_assembly])
def test_functions_for_one_design_name_those_for_many(verb, form):
    message = r"parameters: got .*; give name → number for one design.*solve_dynamics.*sweep\("
    with pytest.raises(da.AnalysisError, match=message):
        verb(pendulum()[2], parameters=MANY_FORMS[form]("length"))


def test_analyses_without_batches_sweep():
    """The function that the message names works where a batch does not."""
    design = da.DesignTable.table({"length": [0.4, 0.5]})
    response = da.at(1, "frequency")
    study = da.sweep(pendulum(angle=-1.5)[2], design, analysis=da.Modal(), responses=response)
    frequencies = np.sqrt(1.5 * 9.81 / np.array([0.4, 0.5])) / (2 * np.pi)
    np.testing.assert_allclose(study.values[:, 0], frequencies)
    assert study.units[response.label] == "Hz"
