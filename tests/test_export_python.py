"""Python scripts of model files: they build the model of the file and state its analysis."""

from __future__ import annotations

import ast
import json
import runpy
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from flexible_bodies import write_beam
from structure_file import HEAD as STRUCTURE, MESH
from test_model_files import (
    CONTACT_TABLES,
    CURVE_TABLES,
    ELEMENTS,
    FRICTION_TABLES,
    HEAD,
    LAW_TABLES,
    SHAPE_TABLES,
)
from test_spatial_files import ELEMENTS as SPATIAL_ELEMENTS, HEAD as SPATIAL_HEAD, OBJ

import dalembert as da
from dalembert.cli.app import main
from dalembert.io.analyses import make_analysis
from dalembert.io.exports.python.code import WIDTH, quoted
from dalembert.io.model_file import load_model_file
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.parts import element_measures

FOLDER = Path(__file__).parents[1] / "examples"
EXAMPLES = sorted(FOLDER.glob("*.toml"))


def script_of(path: Path) -> dict[str, Any]:
    """Names that the script of a file defines; it is written beside the file."""
    written = da.export(path, path.with_suffix(".py"))
    return runpy.run_path(str(written.files[0]))


def values(model: da.Model, seed: int) -> np.ndarray:
    """Equations and measures of a mechanism at a random state and other parameters."""
    e = model.equations
    names = model.parts.measure_names()
    columns = [model.parts.lookup(name).sx for name in names]
    columns += [e.inertia.matrix if hasattr(e.inertia, "matrix") else e.mass, e.force - e.bias]
    columns += [e.constraints, e.nonholonomic, e.potential]
    stacked = ca.vertcat(*(ca.vec(ca.densify(ca.SX(column))) for column in columns))
    rng = np.random.default_rng(seed)
    symbols = ca.symvar(stacked)
    point = {s.name(): rng.normal() for s in sorted(symbols, key=lambda s: s.name())}
    nominal = {p.sx.name(): p.value for p in model.parameters.values()}
    function = ca.Function("values", symbols, [stacked])
    state = [nominal.get(s.name(), point[s.name()]) for s in symbols]
    return function(*state).full().ravel()


def check(path: Path) -> dict[str, Any]:
    """The script of a file builds the same model."""
    script = script_of(path)
    file = load_model_file(path)
    system, written = file.build(), script["build"]()
    script |= {"file": file, "systems": (system, written)}
    assert list(system.elements) == list(written.elements)
    for name, parameter in system.parameters.items():
        other = written.parameters[name]
        for key in ("value", "bounds", "unit", "declared_unit", "description"):
            assert getattr(parameter, key) == getattr(other, key), (name, key)
    derived = {n: (d.unit, str(d.sx)) for n, d in system.derived_parameters.items()}
    assert derived == {n: (d.unit, str(d.sx)) for n, d in written.derived_parameters.items()}
    assert system.outputs.keys() == written.outputs.keys()
    return script


@pytest.mark.few(5)
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_scripts_of_examples_build_their_models(
    path: Path, tmp_path: Path, monkeypatch: Any
) -> None:
    for name in (path.name, "soil.csv", "crates.csv"):
        if (FOLDER / name).exists():
            shutil.copy(FOLDER / name, tmp_path)
    script = check(tmp_path / path.name)
    file, model = script["file"], script["build"]().build()
    expected = file.model()
    if isinstance(model, StructuralModel):
        one, two = script["analyse"](model), make_analysis(file, expected).run(expected)
        np.testing.assert_array_equal(one.displacements, two.displacements)
        return
    np.testing.assert_allclose(values(model, 1), values(expected, 1), rtol=1e-12, atol=1e-12)
    start, other = model.start, expected.start
    np.testing.assert_allclose(start.y, other.y, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(start.v, other.v, rtol=1e-12, atol=1e-12)
    analysis = make_analysis(file, expected)
    for cls in type(analysis).__mro__:
        if "run" in vars(cls):
            monkeypatch.setattr(cls, "run", lambda self, model, *_, **__: self)
    assert settings(script["analyse"](model), model) == settings(analysis, expected)


def settings(analysis: Any, model: Any) -> str:
    """Options of an analysis; events by their names."""
    analysis = analysis.for_model(model)
    events = sorted(getattr(analysis, "events", None) or {})
    return repr(replace(analysis, **({"events": {}} if events else {}))) + repr(events)


def structure_texts() -> Iterator[str]:
    """Structures with every kind of finite element, mesh, load and support."""
    yield STRUCTURE
    yield (
        STRUCTURE.replace("density", "expansion = 1e-5\ndensity")
        + """[[line_loads]]
elements = ["left"]
qy = "-k"
case = "wind"
[[temperatures]]
elements = "left"
temperature = 20
[[supports]]
nodes = "b"
rz = 0
[initial]
"b.vy" = "k"
[analysis]
type = "Dynamics"
duration = "k/20"
damping = { mass = "k", stiffness = 1e-4 }
"""
    )
    yield f"""{MESH}
[[tractions]]
elements = "plate"
nodes = "plate"
where = {{ x = 2 }}
tx = "2*thickness"
[[loads]]
nodes = "plate"
nearest = [1, 1]
fy = -3
"""


def mechanism_texts() -> Iterator[tuple[str, str]]:
    """Name and text of mechanisms with every registered element, law, curve, shape and block."""
    for head, elements in ((HEAD, ELEMENTS), (SPATIAL_HEAD, SPATIAL_ELEMENTS)):
        for section, entries in elements.items():
            for name, keys in entries.items():
                yield name, f'{head}[{section}.new]\ntype = "{name}"\n{keys}\n'
    driver = '[drivers.new]\ntype = "RotationalDriver"\nconnect = ["ground", "a"]\n'
    for name, keys in LAW_TABLES.items():
        yield name, f'{HEAD}{driver}law = {{ type = "{name}", {keys} }}\n'
    joint = '[joints.new]\ntype = "PointOnCurve"\nconnect = ["a", "b"]\n'
    for name, keys in CURVE_TABLES.items():
        yield name, f'{HEAD}{joint}curve = {{ type = "{name}", {keys} }}\n'
    beam = f"[beams.strip]\n{ELEMENTS['beams']['Beam']}\n"
    for shape, keys in SHAPE_TABLES.items():
        other = 'shape_j = { type = "Circle", point = "b", radius = 0.1 }'
        for law, law_keys in CONTACT_TABLES.items() if shape == "Circle" else [HERTZ]:
            for friction, more in FRICTION_TABLES.items() if law == "Flores" else [COULOMB]:
                parts = [f'shape_i = {{ type = "{shape}", {keys} }}', other]
                parts += [f'law = {{ type = "{law}", {law_keys} }}']
                parts += [f'friction = {{ type = "{friction}", {more} }}']
                text = f'{HEAD}{beam}[forces.new]\ntype = "Contact"\n' + "\n".join(parts)
                yield f"{shape}, {law}, {friction}", f"{text}\n"
    yield "several", SEVERAL


HERTZ = ("Hertz", 'stiffness = "k"')
COULOMB = ("Coulomb", "dynamic = 0.3")
SEVERAL = """\
format = 1
[parameters]
k = { value = 2, unit = "N/mm", bounds = [1, "4 N/mm"], description = "a \\"spring\\"" }
a = 3.0
[derived]
twice = { formula = "2*half", unit = "" }
half = "a/2"
[tables.gas]
x = [0, "1 mm", 2]
y = [0, "a", 1]
kind = "linear"
outside = "clamp"
[inputs]
push = { value = "a*sin(t)", unit = "N" }
[outputs]
height = "a.y + max(a.x, 0)"
[histories]
turn = { knots = { start = 0, end = 1, count = 4 }, unit = "N" }
[bodies.a]
mass = "2*45 g"
inertia = "(10 mm)**2*a"
position = ["-3 mm", "pi/2"]
[bodies.lambda]
type = "Particle"
mass = 1
[blocks.pid]
type = "PID"
proportional = 3
measured = "a.y"
setpoint = 1
[forces]
one = { type = "Force", connect = ["a"], vector = ["turn - push", "interp(abs(a.x), gas)*k"] }
[forces.two]
type = "Actuator"
connect = ["a", "lambda"]
force = "where(a.vx < 10 mm/s, pid.output*e, min(a.x, 131/350))"
[initial]
"a.vx" = "twice"
"""


@pytest.mark.thorough
def test_scripts_of_every_registered_element(tmp_path: Path) -> None:
    write_beam(tmp_path, 2)
    (tmp_path / "wedge.obj").write_text(OBJ)
    wrong = []
    for k, (name, text) in enumerate(mechanism_texts()):
        path = tmp_path / f"model{k}.toml"
        path.write_text(text, encoding="utf-8")
        if "FlexibleBody" in text and "dimension = 3" in text:
            write_beam(tmp_path, 3)
        try:
            script = check(path)
        except (AssertionError, Exception) as error:
            wrong.append((name, repr(error)[:300]))
            continue
        parts, other = script["systems"]
        owner = "one" if name == "several" else "strip" if "," in name else "new"
        measures = [element_measures(system.elements[owner], system) for system in (parts, other)]
        one, two = ({n: str(sx) for n, (sx, _) in each.items()} for each in measures)
        if one != two:
            wrong.append((name, owner))
    assert wrong == []


def test_scripts_of_structures(tmp_path: Path) -> None:
    for k, text in enumerate(structure_texts()):
        path = tmp_path / f"structure{k}.toml"
        path.write_text(text)
        script = check(path)
        a, b = (da.solve_statics(system.build()) for system in script["systems"])
        np.testing.assert_array_equal(a.displacements, b.displacements)


HOSTILE = '"""\n__import__("os")._exit(3)\n"""\\\n"; import os #'


def test_names_and_texts_cannot_run(tmp_path: Path) -> None:
    document = {
        "format": 1,
        "name": HOSTILE,
        "description": HOSTILE,
        "parameters": {"import": {"value": 1.0, "description": HOSTILE}, "da": 2.0, "é": 3.0},
        "bodies": {
            "system": {"mass": "da", "inertia": "2*da", "points": {"class": [0, "é"]}},
            "a_b": {"type": "Particle", "mass": 1.0},
        },
        "joints": {"print": {"type": "Revolute", "connect": ["system.class", "a_b"]}},
        "forces": {"if": {"type": "Force", "connect": ["a_b"], "vector": [0, "system.x"]}},
    }
    path = tmp_path / "hostile.json"
    path.write_text(json.dumps(document))
    script = check(path)
    assert script["build"]().name == HOSTILE
    for text in (HOSTILE, "\ud800", "\\", "a\rb"):
        assert ast.literal_eval(quoted(text)) == text


def test_the_script_runs_and_is_well_set(tmp_path: Path, capsys: Any) -> None:
    shutil.copy(FOLDER / "four_bar.toml", tmp_path)
    path = tmp_path / "four_bar.toml"
    assert main(["export", str(path), "--to", "python", "--output", str(tmp_path / "out")]) == 0
    assert "design tasks and reports stay" in capsys.readouterr().out
    text = (tmp_path / "out" / "four_bar.py").read_text()
    assert (
        'crank = system.add(\n        planar.Bar("crank", mass=rho * l1, angle=math.pi / 2' in text
    )
    assert 'system.add(planar.Revolute("A", crank.end, coupler.start))' in text
    assert max(map(len, text.splitlines())) <= WIDTH + 10
    names = runpy.run_path(str(tmp_path / "out" / "four_bar.py"))
    motion = names["analyse"](names["build"]().build())
    file = load_model_file(path)
    model = file.model()
    expected = make_analysis(file, model).run(model)
    for measure in ("crank.angle", "coupler.P.x", "A.force_norm"):
        np.testing.assert_allclose(motion[measure], expected[measure], rtol=1e-12, atol=1e-12)


def test_other_sources_are_refused(tmp_path: Path) -> None:
    with pytest.raises(da.UnsupportedError, match="contain a model file, not a mechanism"):
        da.export(da.load_model(FOLDER / "four_bar.toml").build(), tmp_path / "x.py")
    with pytest.raises(da.FileError, match="no such file"):
        da.export(tmp_path / "none.toml", tmp_path / "x.py")
