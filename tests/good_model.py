"""A good model file, and what tests do to it."""

from __future__ import annotations

from pathlib import Path

from dalembert.errors import DalembertError
from dalembert.io import load_model_file

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


def load_or_refuse(path: Path) -> None:
    try:
        load_model_file(path).model()
    except DalembertError as error:
        message = str(error)
    else:
        return
    assert str(path) in message


def added(head: str, **keys: str) -> str:
    """The good file with a table more, and what else the table says."""
    rows = "\n".join(f"{key} = {value}" for key, value in keys.items() if value)
    return edited("[analysis]", f"{head}\n{rows}\n[analysis]")
