"""Every wrong input is one clear message: file, place, value, cure; nothing is left behind."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from dalembert.cli import main
from dalembert.errors import DalembertError
from dalembert.io import load_model_file
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.functions import FORMULA_FUNCTIONS
from dalembert.symbolic.formulas.parser import parse_formula

GOOD = """\
format = 1
name = "pendulum pair"
gravity = [0.0, -9.81]
[parameters]
l1 = { value = 0.3, unit = "m", bounds = [0.2, 0.5] }
k = 2.0
[derived]
ratio = "l1/2"
[ground.points]
O2 = [1.0, 0.0]
[bodies.crank]
type = "Bar"
length = "l1"
mass = 1.5
[bodies.disc]
mass = 1.0
inertia = 0.1
points = { P = [0.1, 0.0] }
[joints.A]
type = "Revolute"
connect = ["ground", "crank.start"]
[joints.B]
type = "Revolute"
connect = ["crank.end", "disc"]
[drivers.motor]
type = "RotationalDriver"
connect = ["ground", "crank"]
law = "2*t"
[forces.spring]
type = "Spring"
connect = ["ground.O2", "disc.P"]
stiffness = "k"
[analysis]
type = "Dynamics"
duration = 0.1
step = 0.01
[responses.peak]
type = "Maximum"
measure = "A.force_norm"
"""


def edited(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new, 1)


A, B = 'connect = ["ground", "crank.start"]', 'connect = ["crank.end", "disc"]'
LAW, K, MASS = 'law = "2*t"', 'stiffness = "k"', "mass = 1.5"

# what is wrong: (text of the file, words the message must have)
BAD: dict[str, tuple[str, list[str]]] = {
    "syntax": (edited("format = 1", "format = = 1"), ["line 1", "column"]),
    "unquoted text": (edited("mass = 1.5", "mass = rho"), ["line 14", "column", "quotes"]),
    "key twice": (edited(MASS, "mass = 1.5\nmass = 2"), ["line 15", "once"]),
    "empty": ("", ["empty", "dalembert examples"]),
    "only comment": ("# nothing\n", ["format", "missing"]),
    "format missing": (edited("format = 1", ""), ["format", "missing", "add"]),
    "format of the future": (edited("format = 1", "format = 7"), ["format 7", "reads 1", "update"]),
    "format text": (edited("format = 1", 'format = "1"'), ["format", "'1'"]),
    "unknown section": (edited("[joints.A]", "[joint.A]"), ["joint", "did you mean 'joints'"]),
    "unknown key": (edited("mass = 1.5", "mas = 1.5"), ["bodies.crank.mas", "did you mean 'mass'"]),
    "unknown type": (
        edited('"Revolute"', '"Revolut"'),
        ["joints.A", "'Revolut'", "did you mean 'Revolute'"],
    ),
    "type missing": (
        edited('type = "Revolute"\n', ""),
        ["joints.A", "type is missing", "Revolute"],
    ),
    "type a number": (edited('type = "Revolute"', "type = 3"), ["joints.A", "3", "Revolute"]),
    "body a number": (
        edited("[bodies.disc]", "[bodies]\nx = 3\n[bodies.disc]"),
        ["bodies.x", "table", "3"],
    ),
    "mass a list": (
        edited(MASS, "mass = [1]"),
        ["bodies.crank.mass", "number or a formula", "[1]"],
    ),
    "mass true": (edited(MASS, "mass = true"), ["bodies.crank.mass", "true"]),
    "mass nan": (edited(MASS, "mass = nan"), ["bodies.crank.mass", "nan", "finite"]),
    "mass infinite": (edited(MASS, "mass = 1e999"), ["bodies.crank.mass", "inf", "finite"]),
    "huge integer": (edited(MASS, f"mass = 1{'0' * 400}"), ["bodies.crank.mass", "finite"]),
    "huger integer": (edited(MASS, f"mass = 1{'0' * 5000}"), ["cannot be read"]),
    "mass negative": (edited(MASS, "mass = -1.5"), ["bodies.crank.mass", "-1.5 kg", "negative"]),
    "mass negative by formula": (
        edited(MASS, 'mass = "-k"'),
        ["bodies.crank.mass", "-2", "negative"],
    ),
    "inertia negative": (
        edited("0.1\npoints", "-0.1\npoints"),
        ["bodies.disc.inertia", "-0.1", "negative"],
    ),
    "inertia missing": (
        edited("inertia = 0.1\n", ""),
        ["bodies.disc", "inertia is missing", "Particle"],
    ),
    "length missing": (edited('length = "l1"\n', ""), ["bodies.crank", "length: is missing"]),
    "length zero": (edited('"l1"', "0.0"), ["bodies.crank.length", "above 0"]),
    "length of what moves": (
        edited('length = "l1"', 'length = "disc.x"'),
        ["bodies.crank.length", "disc.x"],
    ),
    "unknown parameter": (
        edited('stiffness = "k"', 'stiffness = "kk"'),
        ["forces.spring.stiffness", "'kk'", "did you mean 'k'"],
    ),
    "parameter of time": (edited('"l1/2"', '"l1*t"'), ["derived.ratio", "'t'", "parameters"]),
    "law of what moves": (edited('"2*t"', '"2*crank.angle"'), ["drivers.motor.law", "crank.angle"]),
    "law without type": (
        edited(LAW, "law = { velocity = 1 }"),
        ["drivers.motor.law", "type is missing"],
    ),
    "law of wrong type": (
        edited(LAW, 'law = { type = "Polynom" }'),
        ["drivers.motor.law", "did you mean 'Polynomial'"],
    ),
    "law with wrong key": (
        edited(LAW, 'law = { type = "Polynomial", speed = 1 }'),
        ["drivers.motor.law.speed", "velocity"],
    ),
    "law file missing": (
        edited(LAW, 'law = { type = "Table", file = "no.csv" }'),
        ["drivers.motor.law.file", "no.csv", "no such file"],
    ),
    "law without rows": (
        edited(LAW, 'law = { type = "Table" }'),
        ["drivers.motor.law", "times", "file"],
    ),
    "law rows text": (
        edited(LAW, 'law = { type = "Table", times = ["a", 1, 2], values = [1, 2, 3] }'),
        ["drivers.motor.law", "'a'"],
    ),
    "law rows uneven": (
        edited(LAW, 'law = { type = "Table", times = [0, 1, 2], values = [1, 2] }'),
        ["drivers.motor.law", "3 times", "2 values"],
    ),
    "law rows nested": (
        edited(LAW, 'law = { type = "Table", times = [[0], [1, 2]], values = [1, 2, 3] }'),
        ["drivers.motor.law"],
    ),
    "unknown body": (
        edited('"disc"]', '"disk"]'),
        ["joints.B.connect[1]", "'disk'", "did you mean 'disc'"],
    ),
    "unknown point": (
        edited('"crank.end"', '"crank.ende"'),
        ["joints.B.connect[0]", "'crank.ende'", "did you mean 'crank.end'", "start"],
    ),
    "unknown ground point": (
        edited('"ground.O2"', '"ground.O3"'),
        ["forces.spring.connect[0]", "ground.O2"],
    ),
    "dangling joint": (
        edited(A, 'connect = ["ground"]'),
        ["joints.A.connect", "2 entries", "point_j", "got 1"],
    ),
    "connect missing": (edited(A, ""), ["joints.A.connect", "missing"]),
    "connect a text": (edited(A, 'connect = "ground"'), ["joints.A.connect", "list", "'ground'"]),
    "connect a number": (edited('"crank.start"]', "3]"), ["joints.A.connect[1]", "3"]),
    "inline point wrong": (
        edited('"crank.start"]', '{ body = "crank", at = [0] }]'),
        ["joints.A.connect[1].at", "2 entries", "got 1"],
    ),
    "point for a body": (
        edited('connect = ["ground", "crank"]\n', 'connect = ["ground", "crank.end"]\n'),
        ["drivers.motor.connect[1]", "expected a body", "'crank'"],
    ),
    "joint with itself": (edited(B, 'connect = ["disc", "disc"]'), ["joints.B", "disc", "itself"]),
    "name used twice": (
        edited("[joints.B]", "[joints.crank]"),
        ["joints.crank", "bodies.crank", "choose another"],
    ),
    "name of a parameter": (edited("[joints.B]", "[joints.l1]"), ["joints.l1", "parameters.l1"]),
    "name reserved": (edited("[joints.B]", "[joints.ground]"), ["joints.ground", "reserved"]),
    "name odd": (edited("[joints.B]", '[joints."a b"]'), ['joints."a b"', "letters"]),
    "parameter name odd": (edited("k = 2.0", '"k-1" = 2.0'), ["parameters.k-1", "identifier"]),
    "parameter text": (edited("k = 2.0", 'k = "stiff"'), ["parameters.k", "'stiff'", "number"]),
    "parameter out of bounds": (
        edited("value = 0.3", "value = 0.6"),
        ["parameters.l1", "0.6", "[0.2, 0.5]"],
    ),
    "bounds swapped": (edited("[0.2, 0.5]", "[0.5, 0.2]"), ["parameters.l1", "swap"]),
    "bounds nan": (edited("[0.2, 0.5]", "[nan, 0.2]"), ["parameters.l1.bounds[0]", "nan"]),
    "circle": (
        edited('ratio = "l1/2"', 'a = "b"\nb = "2*c"\nc = { formula = "a + l1" }'),
        ["derived", "circle", "a → ", "→ c"],
    ),
    "circle of forces": (
        edited(K, 'law = "spring.force"'),
        ["forces.spring", "circle", "spring → spring"],
    ),
    "formula with code": (
        edited(K, "stiffness = \"__import__('os')\""),
        ["forces.spring.stiffness", "unknown function"],
    ),
    "formula with attribute": (
        edited(K, 'stiffness = "().__class__"'),
        ["forces.spring.stiffness", "dotted name"],
    ),
    "formula too long": (
        edited(K, f'stiffness = "1{"+1" * 2000}"'),
        ["forces.spring.stiffness", "2000"],
    ),
    "formula too deep": (
        edited(K, f'stiffness = "{"(" * 90}1{")" * 90}"'),
        ["forces.spring.stiffness", "deep"],
    ),
    "formula power tower": (
        edited(K, 'stiffness = "9**9**9**9"'),
        ["forces.spring.stiffness", "finite"],
    ),
    "formula half": (edited(K, 'stiffness = "k*"'), ["forces.spring.stiffness", "syntax error"]),
    "formula empty": (edited(K, 'stiffness = " "'), ["forces.spring.stiffness", "empty"]),
    "formula of vector": (
        edited(K, 'stiffness = "crank.position"'),
        ["forces.spring.stiffness", "got 2"],
    ),
    "spring law": (
        edited(K, 'law = "k*extensio"'),
        ["forces.spring.law", "did you mean 'extension'"],
    ),
    "nested deep": (edited(MASS, f"mass = {'[' * 60}{']' * 60}"), ["nested"]),
    "nested deeper": (edited(MASS, f"mass = {'[' * 3000}{']' * 3000}"), ["nested"]),
    "key of many parts": ("a." * 5000 + "a = 1", ["line 1", "parts"]),
    "driver too many": (
        edited(
            "[forces.spring]",
            '[drivers.two]\ntype = "RotationalDriver"\n'
            'connect = ["ground", "crank"]\nlaw = "3*t"\n[forces.spring]',
        ),
        ["drivers.two", "over-driven", "remove"],
    ),
    "not to be assembled": (
        edited(
            "[drivers.motor]",
            '[joints.C]\ntype = "Revolute"\n'
            'connect = [{ body = "ground", at = [9.0, 0.0] }, "disc"]\n[drivers.motor]',
        ),
        ["cannot be assembled", "stays open", "apart", "0 m wanted", "lengths", "drawn in"],
    ),
    "no bodies": ("format = 1\n", ["has no bodies"]),
    "analysis missing": (
        edited('[analysis]\ntype = "Dynamics"\nduration = 0.1\nstep = 0.01\n', ""),
        ["analysis", "missing", "[analysis]"],
    ),
    "analysis unknown": (
        edited('"Dynamics"', '"Dynamic"'),
        ["analysis", "did you mean 'Dynamics'"],
    ),
    "duration missing": (edited("duration = 0.1\n", ""), ["analysis", "duration"]),
    "duration negative": (
        edited("duration = 0.1", "duration = -1"),
        ["analysis", "-1", "after the start"],
    ),
    "duration text": (
        edited("duration = 0.1", 'duration = "long"'),
        ["analysis.duration", "'long'"],
    ),
    "step zero": (edited("step = 0.01", "step = 0"), ["analysis", "step", "0", "positive"]),
    "outputs wrong": (edited("step = 0.01", "outputs = [0.0, 9.0]"), ["analysis", "output times"]),
    "formulation unknown": (
        edited("step = 0.01", 'formulation = "RangeSpac"'),
        ["analysis.formulation", "did you mean 'RangeSpace'"],
    ),
    "stabilization wrong": (
        edited("step = 0.01", 'stabilization = { type = "Baumgarte", alpha = -1 }'),
        ["analysis.stabilization", "positive"],
    ),
    "integrator key": (
        edited("step = 0.01", 'integrator = { type = "DormandPrince", tol = 1 }'),
        ["analysis.integrator.tol", "rtol"],
    ),
    "event unknown": (
        edited("step = 0.01", 'events = { flat = "crank.angel" }'),
        ["analysis.events.flat", "no measure 'crank.angel'; nearest: crank.angle"],
    ),
    "event direction": (
        edited("step = 0.01", 'events = { flat = { measure = "crank.angle", direction = 3 } }'),
        ["analysis.events.flat", "direction", "3"],
    ),
    "initial quoted": (
        edited("[analysis]", "[initial]\ncrank.angle = 1\n[analysis]"),
        ["initial.crank", "table"],
    ),
    "initial unknown": (
        edited("[analysis]", '[initial]\n"crank.angel" = 1\n[analysis]'),
        ['initial."crank.angel"', "did you mean 'crank.angle'"],
    ),
    "report plot": (
        GOOD + '[report]\nplots = [["crank.angel"]]\n',
        ["report.plots[0][0]", "crank.angle"],
    ),
    "report trace": (
        GOOD + '[report]\ntrace = ["disc.Q"]\n',
        ["report.trace[0]", "did you mean 'disc.P'"],
    ),
}


def added(head: str, **keys: str) -> str:
    """The good file with a table more, and what else the table says."""
    rows = "\n".join(f"{key} = {value}" for key, value in keys.items() if value)
    return edited("[analysis]", f"{head}\n{rows}\n[analysis]")


def beam(**keys: str) -> str:
    rigid = {"axial_rigidity": "1e4", "shear_rigidity": "1e4", "bending_rigidity": "1"}
    good = {"length": "0.5", "frame_i": '"ground.O2"', "mass_per_length": "0.1"}
    return added("[beams.leaf]", **(rigid | good | keys))


def contact(**keys: str) -> str:
    good = {
        "shape_i": '{ type = "Circle", point = "disc", radius = 0.1 }',
        "shape_j": '{ type = "HalfPlane", point = "ground.O2", normal = [0, 1] }',
        "law": '{ type = "Hertz", stiffness = 1e5 }',
    }
    return added('[forces.touch]\ntype = "Contact"', **(good | keys))


def floor(**keys: str) -> str:
    good = {"distance": '"disc.y + 9"', "restitution": "0.5"}
    return added('[forces.floor]\ntype = "UnilateralConstraint"', **(good | keys))


def flexible(**keys: str) -> str:
    good = {"type": '"FlexibleBody"', "structure": '"arm.toml"', "interface": '{ pin = "n0" }'}
    return added("[bodies.arm]", **(good | keys))


BAD |= {
    "beam without length": (beam(length=""), ["beams.leaf.length", "missing"]),
    "beam of no length": (beam(length="0"), ["beams.leaf.length", "0 m", "above 0"]),
    "beam of no elements": (beam(elements="0"), ["beams.leaf", "elements is 0", "from 1"]),
    "beam of too many elements": (
        beam(elements="1000000"),
        ["beams.leaf", "elements = 1000000", "memory", "fewer"],
    ),
    "beam of unknown order": (beam(order="7"), ["beams.leaf", "order is 7", "1, 2, 3 or 4"]),
    "beam to itself": (beam(frame_i='"leaf.end"'), ["beams.leaf.frame_i", "leaf", "before it"]),
    "beam clamped and placed": (beam(angle="1"), ["beams.leaf", "angle", "frame_i", "leave one"]),
    "beam of a taken name": (
        beam().replace("[beams.leaf]", "[beams.crank]"),
        ["beams.crank", "already used by bodies.crank"],
    ),
    "contact without law": (contact(law=""), ["forces.touch.law", "missing"]),
    "contact of an unknown law": (
        contact(law='{ type = "Herz", stiffness = 1 }'),
        ["forces.touch.law", "'Herz'", "did you mean 'Hertz'"],
    ),
    "contact that gives energy": (
        contact(law='{ type = "Restitution", e = 2 }'),
        ["forces.touch", "e is above 1: 2", "give 0 to 1"],
    ),
    "contact of unknown shapes": (
        contact(shape_i='{ type = "HalfPlane", point = "disc", normal = [0, 1] }'),
        ["forces.touch", "HalfPlane and HalfPlane", "Circle–Circle"],
    ),
    "contact of a dented polygon": (
        contact(
            shape_i='{ type = "Polygon", body = "disc", vertices = [[0,0],[2,0],[1,0.1],[0,2]] }'
        ),
        ["forces.touch", "convex", "anticlockwise"],
    ),
    "contact with itself": (
        contact(shape_j='{ type = "Circle", point = "disc.P", radius = 0.1 }'),
        ["forces.touch", "ties disc to itself"],
    ),
    "friction that grows": (
        contact(friction='{ type = "Coulomb", dynamic = 0.4, static = 0.2 }'),
        ["forces.touch", "0.2", "below dynamic=", "0.4"],
    ),
    "cable of one point": (
        added('[forces.rope]\ntype = "Cable"', points='["disc"]', length="1", stiffness="1"),
        ["forces.rope", "at least two, got 1"],
    ),
    "cable to where it is": (
        added(
            '[forces.rope]\ntype = "Cable"',
            points='["disc.P", "disc.P", "crank.end"]',
            length="1",
            stiffness="1",
        ),
        ["forces.rope", "points[0] and points[1]", "give it once"],
    ),
    "gap that nothing moves": (
        floor(distance="1.0"),
        ["forces.floor", "no position", "a body's y"],
    ),
    "slip of no speed": (floor(slip='"disc.x"'), ["forces.floor", "no speed", "a body's vx"]),
    "friction of no slip": (floor(friction="0.3"), ["forces.floor", "friction is 0.3", "slip="]),
    "gap of a speed": (floor(distance='"disc.vy"'), ["forces.floor", "disc.dy", "positions"]),
    "no structure": (
        flexible(structure='"wrong.toml"'),
        ["bodies.arm.structure", "wrong.toml is no structure", 'kind = "structure"'],
    ),
    "structure that is not there": (
        flexible(),
        ["bodies.arm.structure", "arm.toml", "no such file"],
    ),
    "no interface": (flexible(interface="{}"), ["bodies.arm.interface", "got none"]),
}


@pytest.mark.parametrize("case", BAD, ids=[name.replace(" ", "-") for name in BAD])
def test_one_message(case, tmp_path, capsys):
    text, words = BAD[case]
    source, out = tmp_path / "wrong.toml", tmp_path / "out"
    source.write_text(text, encoding="utf-8")
    code = main(["run", str(source), "--output", str(out)])
    told = capsys.readouterr()
    assert code == 2, told
    assert told.err.startswith("Error: ")
    assert told.err.count(str(source)) == 1, told.err
    for word in words:
        assert word in told.err, told.err
    assert len(told.err) < 900
    assert "Traceback" not in told.err
    assert not told.out
    assert sorted(p.name for p in tmp_path.iterdir() if p != out) == ["wrong.toml"]
    drawn = ["wrong.assembly.html"] if case == "not to be assembled" else []
    assert [p.name for p in out.iterdir()] == drawn if out.exists() else not drawn


# what is wrong with a strategy: (keys of [analysis], words the message must have)
CHOICES: dict[str, tuple[str, list[str]]] = {
    "basis unknown": (
        'formulation = { type = "NullSpace", basis = "foo" }',
        ["analysis.formulation", "'foo'", "gram-schmidt"],
    ),
    "basis a number": (
        'formulation = { type = "NullSpace", basis = 3 }',
        ["analysis.formulation.basis", "text in quotes", "3"],
    ),
    "index out of range": (
        'formulation = { type = "Dae", index = 4 }',
        ["analysis.formulation", "index=4", "3 (positions)"],
    ),
    "index not whole": (
        'formulation = { type = "Dae", index = 2.5 }',
        ["analysis.formulation.index", "whole number", "2.5"],
    ),
    "index 3 stabilised": (
        'formulation = { type = "Dae", stabilized = true }',
        ["analysis.formulation", "Dae(index=2, stabilized=True)"],
    ),
    "strategy without type": (
        'formulation = { basis = "qr" }',
        ["analysis.formulation", "type is missing", "NullSpace"],
    ),
    "strategy of another kind": (
        'formulation = "RK4"',
        ["analysis.formulation", "'RK4'", "known: RangeSpace"],
    ),
    "strategy a list": ('integrator = ["RK4"]', ["analysis.integrator", "name", "['RK4']"]),
    "partition unknown": (
        'formulation = { type = "VelocityPartitioning", independent = ["disc.angel"] }',
        ["analysis.formulation", "'disc.angel'", "disc.angle"],
    ),
    "partition too large": (
        'formulation = { type = "VelocityPartitioning", independent = ["disc.x", "disc.y"] }',
        ["analysis.formulation", "1 independent", "2 are named"],
    ),
    "partition a text": (
        'formulation = { type = "VelocityPartitioning", independent = "disc.x" }',
        ["analysis.formulation.independent", "list", "'disc.x'"],
    ),
    "penalty undamped": (
        'formulation = { type = "Penalty", eta = 1 }',
        ["analysis.formulation", "eta=1", "at least omega"],
    ),
    "iterations none": (
        'formulation = { type = "AugmentedLagrangian", iterations = 0 }',
        ["analysis.formulation", "iterations=0", "at least 1"],
    ),
    "coordinates unknown": (
        'coordinates = "JointCoordinate"',
        ["analysis.coordinates", "did you mean 'JointCoordinates'"],
    ),
    "cut unknown": (
        'coordinates = { type = "JointCoordinates", cut = ["nope"] }',
        ["analysis.coordinates", "'nope'", "A, B"],
    ),
    "angles unknown": (
        'coordinates = { type = "JointCoordinates", angles = "foo" }',
        ["analysis.coordinates", "'foo'", "'relative'"],
    ),
    "spectral radius": (
        'integrator = { type = "GeneralizedAlpha", rho_inf = 2 }',
        ["analysis.integrator", "rho_inf=2", "between 0 and 1"],
    ),
    "tolerance negative": (
        'integrator = { type = "Radau", rtol = -1e-3 }',
        ["analysis.integrator", "rtol=-0.001", "positive"],
    ),
    "tolerance a word": (
        'integrator = { type = "Bdf", rtol = "small" }',
        ["analysis.integrator.rtol", "'small'", "number"],
    ),
    "order out of range": (
        'integrator = { type = "Bdf", max_order = 9 }',
        ["analysis.integrator", "max_order=9", "1, 2, 3, 4 or 5"],
    ),
    "order of another name": (
        'integrator = { type = "Bdf", order = 3 }',
        ["analysis.integrator.order", "did you mean 'max_order'"],
    ),
    "projection never": (
        'stabilization = { type = "Projection", every = 0 }',
        ["analysis.stabilization", "every=0", "at least 1"],
    ),
    "Dae explicit": (
        'formulation = "Dae"',
        ["analysis.integrator: RK4", "explicit", "Radau()", "RangeSpace()"],
    ),
    "Dae with Baumgarte": (
        'formulation = "Dae"\nstabilization = "Baumgarte"\nintegrator = "Radau"',
        ["analysis.stabilization: Dae(index=3)", "Projection()"],
    ),
    "Dae with Baumgarte, explicit": (
        'formulation = "Dae"\nstabilization = "Baumgarte"',
        ["analysis.stabilization: Dae(index=3)", "Projection()"],
    ),
    "Dae with Ida": (
        'formulation = "Dae"\nintegrator = "Ida"',
        ["analysis.integrator: Ida", "index 3", "Dae(index=1)"],
    ),
    "Dae with Cvodes": (
        'formulation = "Dae"\nintegrator = "Cvodes"',
        ["analysis.integrator: Cvodes", "Radau()"],
    ),
    "iterated and implicit": (
        'formulation = "AugmentedLagrangian"\nintegrator = "Radau"',
        ["analysis.integrator: AugmentedLagrangian", "RK4()"],
    ),
    "partition with Baumgarte": (
        'formulation = "VelocityPartitioning"\nstabilization = "Baumgarte"',
        ["analysis.stabilization: VelocityPartitioning", "Projection()"],
    ),
    "energy with driver": (
        'stabilization = "EnergyProjection"',
        ["analysis.integrator: EnergyProjection", "driver", "Projection()"],
    ),
}


@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize("case", CHOICES, ids=[name.replace(" ", "-") for name in CHOICES])
def test_choices_that_cannot_work(case, command, tmp_path, capsys):
    """Both commands say the same, and neither leaves anything behind."""
    keys, words = CHOICES[case]
    source, out = tmp_path / "wrong.toml", tmp_path / "out"
    source.write_text(edited("step = 0.01", f"step = 0.01\n{keys}"), encoding="utf-8")
    assert main([command, str(source), *(["--output", str(out)] if command == "run" else [])]) == 2
    told = capsys.readouterr()
    assert told.err.startswith(f"Error: {source}: ")
    for word in words:
        assert word in told.err, told.err
    assert len(told.err.splitlines()) == 1
    assert not told.out
    assert not out.exists()


def test_null_space_by_svd_is_for_few_bodies(tmp_path, capsys):
    bars = "".join(
        f'[bodies.bar{k}]\ntype = "Bar"\nlength = 1.0\nmass = 1.0\nangle = 0.{k}\n'
        f'[joints.pin{k}]\ntype = "Revolute"\n'
        f'connect = ["{f"bar{k - 1}.end" if k else "ground"}", "bar{k}.start"]\n'
        for k in range(5)
    )
    source = tmp_path / "long.toml"
    choice = 'formulation = { type = "NullSpace", basis = "svd" }'
    source.write_text(
        f'format = 1\n{bars}[analysis]\ntype = "Dynamics"\nduration = 1.0\n{choice}\n',
        encoding="utf-8",
    )
    assert main(["check", str(source)]) == 2
    told = capsys.readouterr().err
    for word in (str(source), "analysis.formulation", "15 speeds", "up to 12", "basis='qr'"):
        assert word in told, told


def test_a_run_that_cannot_begin_is_told_with_its_place(tmp_path, capsys):
    """A level pendulum: its centre has no speed along x, which therefore gives no other speed."""
    source, out = tmp_path / "level.toml", tmp_path / "out"
    source.write_text(
        'format = 1\n[bodies.bar]\ntype = "Bar"\nlength = 1.0\nmass = 1.0\nangle = 0.0\n'
        '[joints.pin]\ntype = "Revolute"\nconnect = ["ground", "bar.start"]\n'
        '[analysis]\ntype = "Dynamics"\nduration = 1.0\n'
        'formulation = { type = "VelocityPartitioning", independent = ["bar.x"] }\n',
        encoding="utf-8",
    )
    assert main(["check", str(source)]) == 0  # another start would do
    capsys.readouterr()
    assert main(["run", str(source), "--output", str(out)]) == 1
    told = capsys.readouterr().err
    for word in (f"Error: {source}: analysis", "bar.x", "name other coordinates"):
        assert word in told, told
    assert not list(out.iterdir())


def test_response_with_unknown_measure(tmp_path, capsys):
    source = tmp_path / "wrong.toml"
    source.write_text(edited('"A.force_norm"', '"A.force_nrm"'), encoding="utf-8")
    assert main(["check", str(source)]) == 2
    told = capsys.readouterr().err
    assert "responses.peak.measure" in told
    assert "no measure 'A.force_nrm'; nearest: A.force_norm" in told


def test_several_slips_are_listed(tmp_path, capsys):
    source = tmp_path / "wrong.toml"
    source.write_text(edited(MASS, "mass = nan").replace(K, "stiffness = true"), encoding="utf-8")
    assert main(["check", str(source)]) == 2
    told = capsys.readouterr().err
    assert "bodies.crank.mass" in told
    assert "forces.spring.stiffness" in told


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"format": 1, "format": 1}', ["'format'", "twice"]),
        ('{"format": 1,}', ["JSON", "line 1", "column"]),
        ("[1, 2]", ["table", "list"]),
        ("[" * 100_000, ["JSON"]),
        ('{"format": 1, "bodies": {"b": {"mass": NaN, "inertia": 1}}}', ["bodies.b.mass", "nan"]),
        ('{"format": 1, "bodies": {"b": {"mass": null}}}', ["bodies.b.mass", "None"]),
    ],
)
def test_json(text, words, tmp_path, capsys):
    source = tmp_path / "wrong.json"
    source.write_text(text, encoding="utf-8")
    assert main(["check", str(source)]) == 2
    told = capsys.readouterr().err
    assert str(source) in told
    for word in words:
        assert word in told, told


def test_files_that_are_none(tmp_path, capsys):
    (tmp_path / "latin.toml").write_bytes("name = 'Öl'".encode("latin-1"))
    (tmp_path / "zero.toml").write_bytes(b"a = 1\x00")
    big = tmp_path / "big.toml"
    with big.open("wb") as stream:
        stream.truncate(30_000_000)
    for name, word in {
        "nothing.toml": "no such file",
        "": "folder",
        "latin.toml": "UTF-8",
        "big.toml": "bytes",
        "zero.toml": "TOML",
        "x" * 5000: "cannot be read",
        "a\0b": "null",
    }.items():
        assert main(["check", str(tmp_path / name)]) == 2
        told = capsys.readouterr().err
        assert word in told, told
        assert "Traceback" not in told


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_pipe_is_refused(tmp_path, capsys):
    os.mkfifo(tmp_path / "pipe.toml")
    assert main(["check", str(tmp_path / "pipe.toml")]) == 2
    assert "regular file" in capsys.readouterr().err


def test_output_that_cannot_be_written(tmp_path, capsys):
    source = tmp_path / "good.toml"
    source.write_text(GOOD, encoding="utf-8")
    assert main(["run", str(source), "--output", str(source / "inside")]) == 2
    told = capsys.readouterr().err
    assert str(source / "inside") in told
    assert "--output" in told


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("l1", ["--set", "l1=0.25"]),
        ("l9=1", ["l9", "did you mean 'l1'"]),
        ("l1=long", ["parameters.l1", "long"]),
        ("l1=nan", ["parameters.l1"]),
        ("l1=0.9", ["parameters.l1", "0.9", "bounds"]),
    ],
)
def test_settings(setting, words, tmp_path, capsys):
    source = tmp_path / "good.toml"
    source.write_text(GOOD, encoding="utf-8")
    assert main(["check", str(source), "--set", setting]) == 2
    told = capsys.readouterr().err
    for word in words:
        assert word in told, told


def test_errors_as_json(tmp_path, capsys):
    assert main(["check", str(tmp_path / "no.toml"), "--json"]) == 2
    told = json.loads(capsys.readouterr().out)
    assert not told["ok"]
    assert told["error"]["kind"] == "FileError"
    assert "no.toml" in told["error"]["message"]


@pytest.mark.parametrize(
    "arguments", [["chek"], ["check"], ["run", "a.toml", "--wat"], ["check", "--json"]]
)
def test_wrong_arguments(arguments, capsys):
    assert main(arguments) == 2
    told = capsys.readouterr()
    assert "Traceback" not in told.err + told.out
    assert "--help" in told.err + told.out


# random texts --------------------------------------------------------------------
WORDS = st.sampled_from(
    [
        "l1",
        "t",
        "x",
        "crank.angle",
        "1",
        "2.5",
        "1e300",
        "(",
        ")",
        "+",
        "-",
        "*",
        "/",
        "**",
        ",",
        "<",
        ">=",
        "==",
        "[",
        "]",
        "lambda",
        ":",
        "if",
        "else",
        "'a'",
        "_",
        ".",
        "0",
        " ",
        "pi",
        "e",
        "\\",
        "not",
        "and",
        *FORMULA_FUNCTIONS,
    ]
)


@settings(max_examples=300, deadline=None)
@given(st.one_of(st.text(max_size=60), st.lists(WORDS, max_size=25).map("".join)))
def test_any_formula_is_read_or_refused(text):
    def lookup(name):
        return Expression(2.0) if name in ("l1", "t", "crank.angle") else None

    try:
        made = parse_formula(text, lookup)
    except DalembertError:
        return
    assert isinstance(made, Expression)


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_damage_is_a_dalembert_error(tmp_path, data):
    lines = GOOD.splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        k = data.draw(st.integers(0, len(lines) - 1))
        kind = data.draw(st.sampled_from(["drop", "twice", "value", "swap"]))
        if kind == "drop":
            del lines[k]
        elif kind == "twice":
            lines.insert(data.draw(st.integers(0, len(lines))), lines[k])
        elif kind == "value" and "=" in lines[k]:
            value = data.draw(
                st.sampled_from(
                    [
                        "1",
                        "-1",
                        "0",
                        "nan",
                        "true",
                        '""',
                        '"x"',
                        '"crank.x"',
                        '"l1"',
                        "[]",
                        "{}",
                        "[1, 2]",
                        '["crank", "disc"]',
                        '"t"',
                        "1e300",
                        '"1/(l1-0.3)"',
                        '"ground"',
                    ]
                )
            )
            lines[k] = lines[k].partition("=")[0] + "= " + value
        else:
            j = data.draw(st.integers(0, len(lines) - 1))
            lines[k], lines[j] = lines[j], lines[k]
    path = tmp_path / "damaged.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    load_or_refuse(path)


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(content=st.one_of(st.binary(max_size=200), st.text(max_size=200).map(str.encode)))
@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_any_bytes_are_a_dalembert_error(tmp_path, suffix, content):
    path = tmp_path / f"noise{suffix}"
    path.write_bytes(content)
    load_or_refuse(path)


def load_or_refuse(path: Path) -> None:
    try:
        load_model_file(path).model()
    except DalembertError as error:
        told = str(error)
    else:
        return
    assert str(path) in told
