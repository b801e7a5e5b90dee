"""Numbers with units: what a text says is what the model gets, and what does not fit is refused."""

import math
import subprocess
import sys

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.design.identification.data_table import read_table
from dalembert.elements.base import Element
from dalembert.elements.registry import SPACES
from dalembert.io.analyses import make_analysis
from dalembert.io.model_file import load_model_file
from dalembert.results.labelled import DATA_ONLY
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.units.amounts import Amount
from dalembert.units.grammar import amount_of
from dalembert.units.unit import unit

KNOWN = {  # text -> value in SI units, unit
    "45 mm": (0.045, "m"),
    "45mm": (0.045, "m"),
    "2*45 mm": (0.09, "m"),
    "1.5e3 mm": (1.5, "m"),
    "90 deg": (math.pi / 2, "rad"),
    "45°": (math.pi / 4, "rad"),
    "60 rpm": (2 * math.pi, "rad/s"),
    "1 turn": (2 * math.pi, "rad"),
    "3 kN/mm": (3e6, "N/m"),
    "5 N m": (5.0, "N m"),
    "5 N*m": (5.0, "N m"),
    "10 N/m": (10.0, "N/m"),
    "2.5 g/cm^3": (2500.0, "kg/m^3"),
    "9.81 m/s²": (9.81, "m/s^2"),
    "210 GPa": (210e9, "Pa"),
    "1 in": (0.0254, "m"),  # exact by definition
    "1 lbf": (4.4482216152605, "N"),  # exact by definition
    "-3 mm + 1 cm": (0.007, "m"),
    "(45 mm)**2": (0.045**2, "m^2"),
    "1/(20 ms)": (50.0, "1/s"),
    "90 deg - pi/2": (0.0, "rad"),
    "50 %": (0.5, "1"),
    "1.4 t": (1400.0, "kg"),
}


@pytest.mark.parametrize("text", KNOWN)
def test_a_number_with_its_unit(text):
    value, si = KNOWN[text]
    computed = amount_of(text)
    assert isinstance(computed, Amount)
    assert computed.value == pytest.approx(value, rel=1e-15, abs=1e-16)
    assert computed.si == si


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("3 mmm", "unknown unit 'mmm' .did you mean 'mm'"),
        ("20 degC", "has an offset"),
        ("1 m + 1", "1 m and 1 cannot be added"),
        ("1 m + 1 s", "1 m and 1 s cannot be added"),
        ("sin(3 mm)", "sin takes a plain number or an angle"),
        ("1*2 t", "syntax error at 't'"),  # no tonnes in a formula: t is time
        ("2 e", "syntax error at 'e'"),
        ("2*", "syntax error: the formula ends with '[*]'; complete it"),
        ("45 mm + ", "the formula ends with '[+]'"),
        ("45 mm + * 2 mm", "syntax error at '[*] 2 mm'"),
        ("2*(1 m", "syntax error at '.1 m': '.' was never closed"),
        ("1,5", "write decimals with a point"),
        ("1 m < 2 m", "no such operation"),
        ("1e400 m", "not finite"),
        ("1 m/(0 s)", "division by zero"),
        ("1 km^99999", "powers are up to"),
        ("(2 km)**99999", "not finite"),
        ("(-2 km)**0.5", "root of a negative"),
        ("5 " + "a " * 900, "is no unit"),
        ("mm", "unknown name 'mm'"),
    ],
)
def test_texts_that_are_no_numbers(text, message):
    with pytest.raises(da.ExpressionError, match=message):
        amount_of(text)


def test_hertz_counts_cycles_and_torques_may_leave_angles_out():
    assert not unit("Hz").fits("rad/s")
    assert not unit("deg").fits("") and not unit("rad/s").fits("1/s")
    assert unit("N m").fits("N m/rad") and unit("1/s").fits("rad/s")
    assert unit("kN mm/deg").fits("N/m | N m/rad") and not unit("kN").fits("N/m | N m/rad")


CLASSES = {
    f"{space.name}.{name}": cls
    for space in SPACES.values()
    for section in space.sections.values()
    for name, cls in section.items()
    if issubclass(cls, Element)
}


@pytest.mark.parametrize("name", CLASSES)
def test_every_quantity_has_a_unit_that_is_one(name):
    for field in CLASSES[name].quantity_fields():
        for one in field.metadata["unit"].split("|"):
            own = one.replace("^n", "^2")  # an exponent of the element
            assert unit(own).factor == 1.0, f"{name}.{field.name}"


def bar(**arguments):
    return planar.Bar("bar", **{"length": 1.0, "mass": 1.0, **arguments})


def test_texts_in_python():
    element = bar(length="200 mm", mass="500 g", angle="90 deg", angular_velocity="60 rpm")
    assert float(element.length) == 0.2 and float(element.mass) == 0.5
    end = element.point("50 mm", "-1 cm")
    assert [float(c) for c in end.local] == [0.05, -0.01]
    top = spatial.Body("top", mass=1.0, inertia=(1, 1, 1), position=("1 ft", 0.0, "2 mm"))
    assert [float(c) for c in top.guesses()[0][:3]] == pytest.approx([0.3048, 0.0, 0.002])
    turned = da.rotation.axis_angle((1, 0, 0), "90 deg")
    assert turned is not None
    system = da.System("x", gravity=(0.0, "-981 cm/s^2"))
    system.add(planar.Particle("stone", mass=1.0))
    assert float(system.build().parts.gravity[1]) == pytest.approx(-9.81, rel=1e-15)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"length": "3 kg"}, "bar.length: 3 kg does not fit, expected m"),
        ({"angle": "3 mm"}, "bar.angle: 0.003 m does not fit, expected rad"),
        ({"mass": "1 N"}, "bar.mass: 1 N does not fit, expected kg"),
        ({"angular_velocity": "5 Hz"}, "bar.angular_velocity: .* expected rad/s"),
        ({"length": "l1"}, "expected a number or a formula, got 'l1'"),
        ({"length": "0.2 s + 1 s/m*t*0.1 m/s"}, r"bar.length: 0.2 s .* \[s\] does not fit"),
        ({"length": "3 mmm"}, "bar.length: .* unknown unit 'mmm'"),
    ],
)
def test_units_that_do_not_fit_are_refused_by_name(arguments, message):
    with pytest.raises(da.ExpressionError, match=message):
        bar(**arguments)


def test_the_unit_of_a_parameter_is_meant():
    system = da.System("x")
    l = system.parameter("l", 45, unit="mm", bounds=(30, "6 cm"))
    assert (l.value, l.unit, l.declared_unit) == (0.045, "m", "mm")
    assert l.bounds == pytest.approx((0.03, 0.06), rel=1e-15)
    assert l.in_declared_unit(0.05) == pytest.approx(50)
    speed = system.parameter("speed", "60 rpm")
    assert speed.value == pytest.approx(2 * math.pi) and speed.unit == "rad/s"
    with pytest.raises(da.ModelError, match=r"bar.mass: l .m. does not fit, expected kg"):
        bar(mass=l)
    with pytest.raises(da.ModelError, match="unknown unit 'widget'"):
        system.parameter("w", 1.0, unit="widget")
    with pytest.raises(da.ModelError, match="does not fit, expected mm"):
        system.parameter("v", "3 kg", unit="mm")


def test_new_values_may_be_texts():
    system = da.System("x", gravity=(0.0, -9.81))
    l = system.parameter("l", 0.5, unit="m")
    element = system.add(planar.Bar("bob", length=l, mass=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), element.start))
    model = system.build()
    texts = da.solve_dynamics(model, 0.1, step=0.01, parameters={"l": "400 mm"})
    numbers = da.solve_dynamics(model, 0.1, step=0.01, parameters={"l": 0.4})
    assert (texts["bob.angle"].values == numbers["bob.angle"].values).all()


def pendulum():
    system = da.System("x", gravity=(0.0, -9.81))
    l = system.parameter("l", "400 mm")
    system.parameter("turns", 3.0)
    element = system.add(planar.Bar("bob", length=l, mass=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), element.start))
    return system.build()


def test_times_may_be_texts_and_formulas():
    model = pendulum()
    for duration in ("300 ms", 0.3, "0.75*l/turns*3*(1 s)/(1 s)", 0.75 * model["l"]):
        motion = da.solve_dynamics(model, duration, step="10 ms", outputs=["0 s", "0.1 s", 0.3])
        assert motion.time == pytest.approx([0.0, 0.1, 0.3])
    longer = da.solve_dynamics(model, "l/2", step="l/20", parameters={"l": "600 mm"})
    assert longer.time[-1] == pytest.approx(0.3) and longer.time.size == 11


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"duration": "3 mm"}, "duration: '3 mm' does not fit, expected s"),
        ({"duration": "l"}, "duration: 'l' does not fit, expected s"),
        ({"duration": "2*bob.angle"}, "duration is '2.bob.angle', which has"),
        (
            {"duration": "ll"},
            "duration is 'll', which is no time; give .*formula of parameters .nearest .* l.$",
        ),
        (
            {"duration": 1.0, "step": "x"},
            "step is 'x', which is no time; give a number in seconds, a text with a unit",
        ),
        ({"duration": 1.0, "step": "2/ll"}, "step is '2/ll', which is no time: 'll' is no param"),
        ({"duration": 1.0, "outputs": "many"}, "outputs is 'many', which is .* a number of out"),
        (
            {"duration": 1.0, "stp": 0.1},
            "solve_dynamics: unknown option 'stp' .did you mean 'step'",
        ),
        (
            {"duration": "turns", "parameters": {"turns": [1.0, 2.0]}},
            "differs from design to design",
        ),
    ],
)
def test_times_that_are_none(options, message):
    with pytest.raises(da.AnalysisError, match=message):
        da.solve_dynamics(pendulum(), **options)


MECHANISM = """
format = 1
gravity = ["0 m/s^2", "-981 cm/s^2"]

[parameters]
crank = { value = 45, unit = "mm", bounds = [30, "6 cm"] }
speed = "120 rpm"

[ground.points]
pivot = ["0 in", 0]

[bodies.a]
type = "Bar"
length = "2*crank + 10 mm"
mass = "500 g"
angle = "90 deg"

[joints.O]
type = "Revolute"
connect = ["ground.pivot", { body = "a", at = ["-50 mm", 0] }]

[drivers.m]
type = "RotationalDriver"
connect = ["ground", "a"]
law = "90 deg + speed*t"

[analysis]
type = "Kinematics"
duration = "2*pi/speed"
step = "5 ms"
"""


def written(tmp_path, text):
    path = tmp_path / "crank.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_units_in_a_file(tmp_path):
    file = load_model_file(written(tmp_path, MECHANISM))
    model = file.model()
    assert model.parameters["crank"].value == 0.045
    assert model.parameters["crank"].bounds == pytest.approx((0.03, 0.06), rel=1e-15)
    assert model.parameters["speed"].unit == "rad/s"
    motion = make_analysis(file, model).run(model)
    assert motion.time[-1] == pytest.approx(0.5)
    assert motion.values("a.end.y").max() == pytest.approx(0.1)
    changed = file.with_parameters({"crank": 50, "speed": "60 rpm"}).model()
    assert changed.parameters["crank"].value == 0.05  # in the unit that the file gives it
    assert changed.parameters["speed"].value == pytest.approx(2 * math.pi)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('mass = "500 g"', 'mass = "500 mm"', r"bodies.a.mass: 0.5 m does not fit, expected kg"),
        ('mass = "500 g"', 'mass = "crank"', r"bodies.a.mass: crank .m. does not fit, expected kg"),
        ('"90 deg + speed*t"', '"90 mm"', r"drivers.m.law: 0.09 m does not fit, expected rad"),
        ('duration = "2*pi/speed"', 'duration = "5 kg"', r"analysis.duration: .*expected s"),
        ('unit = "mm"', 'unit = "mmm"', r"parameters.crank.*unknown unit 'mmm'"),
    ],
)
def test_a_file_is_told_what_does_not_fit(tmp_path, old, new, message):
    assert old in MECHANISM
    text = MECHANISM.replace(old, new)
    file = load_model_file(written(tmp_path, text))
    with pytest.raises(da.DalembertError, match=message):
        make_analysis(file, file.model())


def test_a_name_that_is_a_unit_too_is_asked_about():
    def lookup(name):
        return {"m": da.System("x").parameter("m", 2.0)}.get(name)

    assert float(parse_formula("10 N/m", lookup)) == 10.0  # alone, it can only be a unit
    with pytest.raises(da.ExpressionError, match="'m' is a unit and a name of the model"):
        parse_formula("1 + 10 N/m", lookup)


STRUCTURE = """
format = 1
kind = "structure"

[nodes]
a = [0, 0]
b = ["500 mm", 0]

[elements.bar]
type = "Truss"
connect = ["a", "b"]
area = "4 cm^2"
modulus = "210 GPa"

[[supports]]
nodes = "a"

[[supports]]
nodes = "b"
uy = "0 mm"

[[loads]]
nodes = "b"
fx = "84 kN"
"""


def test_units_in_a_structure(tmp_path):
    model = load_model_file(written(tmp_path, STRUCTURE)).model()
    stretch = 84e3 * 0.5 / (4e-4 * 210e9)  # F l / (E A)
    assert da.solve_statics(model).values("b.ux")[0] == pytest.approx(stretch, rel=1e-12)
    wrong = STRUCTURE.replace('"84 kN"', '"84 kN m"')
    with pytest.raises(da.ModelError, match=r"loads\[0\].*84000 N m does not fit, expected N"):
        load_model_file(written(tmp_path, wrong)).build()


def test_tables_are_headed_by_measures_in_the_units_wanted(tmp_path):
    motion = da.solve_dynamics(pendulum(), 0.1, step=0.01)
    table = motion.to_dataframe("bob.angle", "bob.end.position")
    assert list(table.columns) == ["bob.angle", "bob.end.position.x", "bob.end.position.y"]
    assert table.attrs["units"]["bob.angle"] == "rad"
    everything = motion.to_dataframe()
    named = set(motion.model.measure_names) | set(DATA_ONLY)
    assert {name.removesuffix(".x").removesuffix(".y") for name in everything.columns} <= named | {
        name.removesuffix(".x").removesuffix(".y") for name in named
    }
    path = motion.to_csv(tmp_path / "run.csv", units=["mm", "deg", "ms"])
    heading, *_, last = path.read_text(encoding="utf-8").splitlines()
    computed = dict(zip(heading.split(","), map(float, last.split(",")), strict=True))
    assert computed["time [ms]"] == pytest.approx(100.0)
    assert computed["bob.angle [deg]"] == pytest.approx(
        math.degrees(motion.values("bob.angle")[-1])
    )
    assert computed["bob.end.x [mm]"] == pytest.approx(1e3 * motion.values("bob.end.x")[-1])
    assert "bob.vx [m/s]" in computed  # units without one of velocities
    with pytest.raises(da.AnalysisError, match="units: unknown unit 'mmm'"):
        motion.to_csv(path, units=["mmm"])


def test_measurements_with_units_are_read_in_si(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [ms],bob.angle [deg]\n0,0\n10,90\n", encoding="utf-8")
    read = read_table(path)
    assert read["time"] == pytest.approx([0.0, 0.01])
    assert read["bob.angle"] == pytest.approx([0.0, math.pi / 2])
    columns = {"time [ms]": [0, 10], "bob.angle [deg]": [0.0, 90.0]}  # a mapping is read alike
    for name, values in read_table(columns).items():
        assert values == pytest.approx(read[name])


def test_the_page_shows_the_units_asked_for():
    motion = da.solve_dynamics(pendulum(), 0.1, step=0.01)
    series = {s["name"]: s for s in motion.page(units=["deg"])["series"]}
    assert series["bob.angle"]["unit"] == "deg"
    degrees = math.degrees(motion.values("bob.angle")[-1])
    assert series["bob.angle"]["values"][-1] == pytest.approx(degrees)
    assert series["bob.x"]["unit"] == "m"


def test_members_of_structures_are_in_data_and_tables(tmp_path):
    result = da.solve_statics(load_model_file(written(tmp_path, STRUCTURE)).model())
    table = result.to_dataframe()
    assert table.loc["bar.force", "value"] == pytest.approx(84e3)
    assert table.loc["bar.stress", "value"] == pytest.approx(84e3 / 4e-4)
    assert table.loc["b.ux", "value"] == result.values("b.ux")[0]
    assert table.loc["a.fx", "value"] == pytest.approx(-84e3)
    for name in table.index:
        assert table.loc[name, "unit"] == result.model[name].unit.removesuffix("1")
    force = result.data["element_force"].sel(element_force_of="bar")
    assert float(force[0]) == pytest.approx(84e3) and force.attrs["units"] == "N"
    text = result.to_csv(tmp_path / "r.csv", units=["MPa", "kN"]).read_text(encoding="utf-8")
    assert "bar.stress,MPa,210" in text and "bar.force,kN,84" in text


def test_a_derived_parameter_says_an_si_unit():
    system = da.System("x")
    bore = system.parameter("bore", "120 mm")
    area = system.derived("area", math.pi * bore**2 / 4, "m^2")
    assert area.unit == "m^2"
    with pytest.raises(da.ModelError, match=r"a formula gives m\^2, not mm\^2"):
        system.derived("other", math.pi * bore**2 / 4, "mm^2")


def test_a_stop_of_an_angle_measures_a_moment():
    system = da.System("flap")
    flap = system.add(planar.Bar("flap", length=1.0, mass=1.0))
    system.add(planar.Revolute("O", system.ground.center, flap.start))
    system.add(planar.Stop("stop", flap.angle, lower=-0.1, stiffness="10 N m/rad"))
    system.add(planar.Stop("end", flap.y, lower=-9.0, stiffness="10 N/m"))
    model = system.build()
    names = ("stop.coordinate", "stop.force", "end.coordinate", "end.force")
    assert [model[name].unit for name in names] == ["rad", "N m", "m", "N"]


@pytest.mark.parametrize(
    ("stiffness", "exponent", "value"),
    [("1 N/mm", 1, 1e3), ("1 N/mm^1.5", 1.5, 1e4 * math.sqrt(10)), ("2 N/m^2", 2.0, 2.0)],
)
def test_the_unit_of_a_contact_stiffness_follows_its_exponent(stiffness, exponent, value):
    """``1 N/mm`` as the stiffness of Hertz's law was ``1000 N/m^1.5``, without a message."""
    law = planar.contact.Hertz(stiffness=stiffness, exponent=exponent)
    assert float(law.stiffness) == pytest.approx(value, rel=1e-14)
    for other in {"1 N/mm", "1 N/mm^1.5", "2 N/m^2", "5 m"} - {stiffness}:
        with pytest.raises(da.ModelError, match=r"Hertz.stiffness: .* does not fit, expected N/m"):
            planar.contact.Hertz(stiffness=other, exponent=exponent)
    system = da.System("x")
    k, n = system.parameter("k", 3.0, "N/m"), system.parameter("n", 1.5)
    with pytest.raises(da.ModelError, match=r"k .N/m. does not fit, expected N/m\^1.5"):
        planar.contact.Hertz(stiffness=k)
    planar.contact.Hertz(stiffness=k, exponent=n)  # of any dimension


def test_the_unit_of_the_stiffness_of_a_stop_follows_its_exponent():
    system = da.System("buffer")
    lift = system.add(planar.Particle("lift", mass=1.0))
    hertz = planar.Stop("stop", lift.y, lower=0.0, stiffness="1 N/mm^1.5", exponent=1.5)
    assert float(hertz.stiffness) == pytest.approx(1e4 * math.sqrt(10), rel=1e-14)
    with pytest.raises(da.ModelError, match=r"stop.stiffness: .* does not fit, expected N/m\^1.5"):
        planar.Stop("stop", lift.y, lower=0.0, stiffness="1 N/mm", exponent=1.5)
    with pytest.raises(da.ModelError, match=r"stop.stiffness: .* does not fit, expected N/m \| N"):
        planar.Stop("stop", lift.y, lower=0.0, stiffness="1 N/mm^1.5")


def test_pint_is_imported_where_it_is_needed_only():
    program = (
        "import sys, dalembert as da\n"
        "s = da.System('x'); s.parameter('k', 3.0, 'N/m'); s.parameter('l', '2 m')\n"
        "assert 'pint' not in sys.modules\n"
        "s.parameter('b', '2 mm'); assert 'pint' in sys.modules\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("unit_text", ["rpm", "deg/s", "m/s", "kN/mm", "N m/rad", "g", "kg/m^3"])
@pytest.mark.parametrize("factor", ["*t", "/t", " * t", "*pi", "*e", "*t**2"])
def test_a_factor_after_a_unit_is_no_unit(unit_text: str, factor: str) -> None:
    """``45 rpm*t`` is a speed times the time, not revolutions per minute times tonnes."""
    text = f"3 {unit_text}{factor}"
    computed, wanted = (
        parse_formula(one, {"t": da.t}.get) for one in (text, f"(3 {unit_text}){factor}")
    )

    def value(formula) -> float:
        if isinstance(formula, Amount):
            return formula.value
        return float(ca.Function("f", [da.t.sx], [formula.sx])(0.7))

    assert value(computed) == pytest.approx(value(wanted), rel=1e-14)


LAW_FILE = """
format = 1
[bodies.b]
type = "Bar"
length = 1
[joints.O]
type = "Revolute"
connect = ["ground", "b.start"]
[drivers.m]
type = "RotationalDriver"
connect = ["ground", "b"]
law = "LAW"
"""


@pytest.mark.parametrize(
    "law",
    [
        *("0.4 rad + 45 rpm*t", "2*3", "where(t < 0.5, 10 deg, 10 deg)", "sin(t)", "t"),
        *("45 rpm*t", "t*45 rpm"),
        *("0.1 m + 45 m/s*t", "3 deg + 1 kg*t", "l1 + t", "sin(t", "2 deg*b.angle"),
    ],
)
def test_a_text_means_the_same_in_files_and_in_python(law: str, tmp_path) -> None:
    """Functions of time by text; what is refused in one is refused in the other."""

    def from_file() -> da.System:
        path = tmp_path / "model.toml"
        path.write_text(LAW_FILE.replace("LAW", law))
        return da.load_model(path)

    def in_python() -> da.System:
        system = da.System("model")
        b = system.add(planar.Bar("b", length=1))
        system.add(planar.Revolute("O", system.ground.center, b.start))
        system.add(planar.RotationalDriver("m", system.ground, b, law))
        return system

    results = []
    for make in (from_file, in_python):
        try:
            results.append(da.solve_kinematics(make().build(), 1.0, outputs=7)["b.angle"].values)
        except da.ModelError:
            results.append(None)
    assert type(results[0]) is type(results[1])
    assert results[0] is None or np.array_equal(*results)
    refused = ("0.1 m + 45 m/s*t", "3 deg + 1 kg*t", "l1 + t", "sin(t", "2 deg*b.angle")
    assert (results[0] is None) == (law in refused)


@pytest.mark.parametrize(
    ("strategy", "options", "expected"),
    [
        (da.Nonsmooth, {"duration": 1.0, "step": "5 mm"}, "s"),
        (da.Nonsmooth, {"duration": 1.0, "sleep_speed": "3 s"}, "m/s"),
        (da.Dynamics, {"duration": "1 m"}, "s"),
        (da.MoreauJean, {"theta": "0.5 m"}, "a plain number"),
        (da.Baumgarte, {"alpha": "5 s"}, "1/s"),
    ],
)
def test_options_refuse_units_of_other_kinds(strategy, options, expected):
    name = list(options)[-1]
    with pytest.raises(da.ExpressionError, match=rf"{name} = .* does not fit, expected {expected}"):
        strategy(**options)


def test_options_convert_units_of_their_kind():
    analysis = da.Nonsmooth(
        duration="2 min", step="5 ms", sleep_after="0.1 s", sleep_speed="2 mm/s"
    )
    assert (analysis.duration, analysis.step, analysis.sleep_speed) == (120.0, 0.005, 0.002)
