"""Named inputs and outputs, from Python and from files."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.errors import ExpressionError, ModelError

FILE = """
format = 1
[parameters]
amplitude = "10 mm"
[tables.bumps]
x = [0, 1, 2, 3]
y = [0, 1, 0, 1]
[derived]
twice = "2*amplitude"
[inputs]
push = {value = 3, unit = "N", bounds = [-5, 5], description = "force of the hand"}
road = "twice*sin(4*t)"
track = {value = "amplitude*interp(t, bumps)", unit = "m"}
[outputs]
height = "box.y - road"
energy_in_cart = {formula = "kinetic_energy", unit = "J", description = "of the box"}
[bodies.box]
type = "Particle"
mass = 2.0
[forces.hand]
type = "Force"
connect = ["box.center"]
vector = ["push", "1000*(road + track - box.y)"]
"""


def loaded(folder, text: str = FILE) -> da.System:
    path = folder / "cart.toml"
    path.write_text(text, encoding="utf-8")
    return da.load_model(path)


def cart() -> tuple[da.System, da.Expression]:
    system = da.System("cart")
    box = system.add(planar.Particle("box", mass=2.0))
    push = system.input("push", 3.0, unit="N", bounds=(-5, 5))
    system.add(planar.Force("hand", box.center, (push, 0)))
    return system, box


def test_an_input_is_a_parameter():
    system, box = cart()
    system.output("place", box.x)
    model = system.build()
    assert list(model.inputs) == ["push"] and model.inputs["push"].bounds == (-5, 5)
    motion = da.solve_dynamics(model, 2.0, parameters={"push": 4.0})
    assert motion["place"][-1].item() == pytest.approx(4.0, rel=1e-9)
    assert model.outputs["place"].unit == "m" and "place" in model
    motions = da.solve_dynamics(model, 2.0, parameters={"push": np.array([1.0, 2.0])})
    assert motions["place"].values[:, -1] == pytest.approx([1.0, 2.0], rel=1e-9)


def test_the_value_of_an_input_with_a_formula_is_its_deviation():
    system = da.System("cart")
    box = system.add(planar.Particle("box", mass=2.0))
    push = system.input("push", 6 * da.t, unit="N")
    system.add(planar.Force("hand", box.center, (push, 0)))
    model = system.build()
    exact = {None: 6 / 2 / 6, 2.0: 6 / 2 / 6 + 2 / 2 / 2}  # ∫∫ F/m
    for deviation, place in exact.items():
        chosen = {} if deviation is None else {"push": deviation}
        motion = da.solve_dynamics(model, 1.0, parameters=chosen)
        assert motion["box.x"][-1].item() == pytest.approx(place, rel=1e-9)
        assert motion["push"][-1].item() == pytest.approx(6 + chosen.get("push", 0))
    gradient = da.sensitivity(motion, da.Final("box.x"))
    assert gradient.sel(parameter="push").item() == pytest.approx(1 / 4)


def test_inputs_and_outputs_of_files(tmp_path):
    model = loaded(tmp_path).build()
    assert list(model.inputs) == ["push", "road", "track"]
    assert list(model.outputs) == ["height", "energy_in_cart"]
    motion = da.solve_dynamics(model, 1.0, step=1e-3)
    t, y = motion.time, motion["box.y"].values
    assert motion["road"].values == pytest.approx(0.02 * np.sin(4 * t), abs=1e-15)
    assert motion["height"].values == pytest.approx(y - 0.02 * np.sin(4 * t), abs=1e-15)
    assert motion["track"][-1].item() == pytest.approx(0.01, rel=1e-12)
    assert np.array_equal(motion["energy_in_cart"], motion["kinetic_energy"])


def test_a_structure_has_inputs_and_outputs():
    frame = da.Structure("bar")
    a, b = frame.node("a", 0.0), frame.node("b", 1.0)
    frame.add(structures.Truss("bar", a, b, area=1e-4, modulus=2e11))
    frame.support(a)
    frame.load(b, fx=frame.input("pull", 2e3, unit="N"))
    frame.output("stretch", "1000*b.ux", description="in mm")
    model = frame.build()
    result = da.solve_statics(model, parameters={"pull": 4e3})
    assert result["stretch"] == pytest.approx(1e3 * 4e3 / (1e-4 * 2e11))


def test_wrong_inputs_are_refused():
    system, box = cart()
    with pytest.raises(ModelError, match=r"depends on 'box\.x'"):
        system.input("back", -box.x)
    with pytest.raises(ModelError, match="already used"):
        system.input("push")
    with pytest.raises(ModelError, match="outside its bounds"):
        system.input("pull", 7.0, bounds=(0, 5))
    with pytest.raises(ModelError, match="already used"):
        system.output("push", box.x)
    with pytest.raises(ModelError, match="reserved"):
        system.input("t")
    system.output("place", "bax.x")
    with pytest.raises(ExpressionError, match=r"output place: .*bax"):
        system.build()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"twice*sin(4*t)"', '"box.y*t"', r"inputs.road.*box\.y"),
        ("mass = 2.0", 'mass = "road"', "bodies.box.*road"),
        ('"box.y - road"', '"bax.y - road"', "height.*bax"),
        ('unit = "J"', 'unit = "m"', "energy_in_cart"),
        ("value = 3", "value = nan", "inputs.push"),
        ("[outputs]", "[outputs]\npush = 'box.x'", "push"),
    ],
)
def test_wrong_entries_of_files_are_named(tmp_path, old, new, message):
    with pytest.raises((ModelError, ExpressionError), match=message):
        loaded(tmp_path, FILE.replace(old, new)).build()
