"""Wrong model files by name: the text, and words that its one message must have."""

from __future__ import annotations

from good_model import GOOD, LAW, MASS, A, B, K, edited

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
    "name reserved": (
        edited("[joints.B]", "[joints.ground]"),
        ["joints.ground", "reserved", "the body at rest"],
    ),
    "parameter called as time": (edited("k = 2.0", "t = 2.0"), ["parameters.t", "the time"]),
    "parameter called as a measure": (
        edited("k = 2.0", "energy = 2.0"),
        ["parameters.energy", "a measure of the whole"],
    ),
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
