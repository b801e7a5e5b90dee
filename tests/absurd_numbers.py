"""Puts absurd numbers everywhere; tells what ends neither well nor in a typed error.

A process of its own with little memory: ``python absurd_numbers.py PART FOLDER STRIDE``. Every case
stops the process with a traceback where it takes longer than ``PATIENCE``.
"""

from __future__ import annotations

import faulthandler
import math
import resource
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import dalembert as da
from dalembert import planar, structures
from dalembert.errors import DalembertError
from dalembert.io import strategies
from dalembert.io.fields import CountOrTimes, Interval, Names, fields_of

PATIENCE = 120.0
MEMORY = 6_000_000_000
NUMBERS: list[Any] = [0, -1, 0.5, math.nan, math.inf, 5e-324, 1e-8, 1e8, 1e12, 1e308, 10**8, 10**12]
NUMBERS += [10**400, -(10**400), True, "text", None, [], (1.0,), 1j]
FOLDER, STRIDE = Path("."), 1
"""Where files are written; one in so many numbers is tried."""
EXAMPLES = Path(__file__).parents[1] / "examples"

Case = tuple[str, Callable[[], Any]]


def pendulum() -> Any:
    system = da.System("pendulum", gravity=(0.0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=0.3))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), bar.start))
    return system.build()


def driven() -> Any:
    system = da.System("crank")
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0))
    system.add(planar.Revolute("pin", system.ground.point(0, 0), bar.start))
    system.add(planar.RotationalDriver("motor", system.ground, bar, 2.0 * da.t))
    return system.build()


def beam() -> Any:
    structure = da.Structure("beam")
    ends = [structure.node("a", 0.0, 0.0), structure.node("b", 1.0, 0.0)]
    structure.add(
        structures.Frame("f", *ends, modulus=1e9, area=1e-3, second_moment=1e-8, density=1e3)
    )
    structure.support(ends[0])
    structure.load(ends[1], fx=-1.0, fy=1e-3)
    return structure.build()


BASE: dict[str, dict[str, Any]] = {
    "Dynamics": {"duration": 0.2, "step": 0.01},
    "Kinematics": {"duration": 0.2, "step": 0.01},
    "InverseDynamics": {"duration": 0.2, "step": 0.01},
}


def some(fields: Iterable[Any]) -> Iterator[tuple[Any, Any]]:
    """Each field with numbers, in turn others of them where only some are wanted."""
    for k, field in enumerate(fields):
        for value in NUMBERS[k % STRIDE :: STRIDE]:
            yield field, value


def fields(cls: type) -> list[str]:
    """Options that hold numbers, flags, texts or lists of them."""
    plain = {float, int, CountOrTimes, Interval, bool, str, Names}
    return [f.name for f in fields_of(cls) if f.holds in plain and f.name != "name"]


def with_number(make: Callable[..., Any], fields: dict, name: str, value: Any) -> Callable[[], Any]:
    return lambda: make(**fields | {name: value})


def analyses() -> Iterator[Case]:
    models = {"Kinematics": driven(), "InverseDynamics": driven()}
    mechanism, structure = pendulum(), beam()
    for registry, usual in (
        (strategies.ANALYSES, mechanism),
        (strategies.STRUCTURAL_ANALYSES, structure),
    ):
        for kind, cls in registry.items():
            model, arguments = models.get(kind, usual), BASE.get(kind, {})
            for name, value in some(fields(cls)):
                here = {k: v for k, v in arguments.items() if (k, name) != ("duration", "t_span")}
                make = with_number(cls, here, name, value)
                yield f"{kind}({name}={value!r:.20})", lambda m=make, s=model: m().run(s)


def choices() -> Iterator[Case]:
    model = pendulum()
    for key, registry in strategies.STRATEGIES.items():
        for kind, cls in registry.items():
            for name, value in some(fields(cls)):
                make = with_number(cls, {}, name, value)

                def run(make=make, key=key, kind=kind) -> Any:
                    chosen = {key: make()} | ({"integrator": da.Radau()} if kind == "DAE" else {})
                    return da.solve_dynamics(model, 0.02, step=0.01, **chosen)

                yield f"{kind}({name}={value!r:.20})", run


def responses() -> Iterator[Case]:
    motion = da.solve_dynamics(pendulum(), 0.2, step=0.01)
    for kind, cls in strategies.RESPONSES.items():
        arguments = {"measure": "bar.angle"} | ({"event": "e"} if kind == "AtEvent" else {})
        for name, value in some(fields(cls)):
            make = with_number(cls, arguments, name, value)
            yield f"{kind}({name}={value!r:.20})", lambda m=make: da.evaluate(motion, m())


def meshes() -> Iterator[Case]:
    for value in NUMBERS:
        yield f"line_mesh({value!r:.20})", lambda n=value: structures.line_mesh((0.0,), (1.0,), n)
        for make, d in ((structures.rectangle_mesh, 2), (structures.box_mesh, 3)):
            size, counts = [1.0] * (d - 1) + [value], [1] * (d - 1) + [value]
            name = f"{make.__name__}({value!r:.20})"
            yield f"{name} cells", lambda m=make, d=d, n=counts: m([1.0] * d, n)
            yield f"{name} m", lambda m=make, d=d, s=size: m(s, [1] * d)


def tables() -> Iterator[Case]:
    """Every kind of number in the tables of the examples, each once."""
    import tomllib

    from dalembert.io.model_file import load_model_file

    places: dict[tuple, tuple[Path, tuple]] = {}
    for path in sorted(EXAMPLES.glob("*.toml")):
        if path.stat().st_size < 3000:
            for keys, kind in leaves(tomllib.loads(path.read_text(encoding="utf-8"))):
                places.setdefault(kind, (path, keys))
    for (path, keys), value in some(places.values()):
        if isinstance(value, (complex, tuple)) or value is None:
            continue

        def run(path=path, keys=keys, value=value) -> Any:
            file = FOLDER / "model.json"
            write(file, tomllib.loads(path.read_text(encoding="utf-8")), keys, value)
            return load_model_file(file).model()

        yield f"{path.name}: {'.'.join(map(str, keys))} = {value!r:.20}", run


def write(file: Path, data: Any, keys: tuple, value: Any) -> None:
    import json

    inner = data
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = value
    file.write_text(json.dumps(data), encoding="utf-8")


def leaves(data: Any, keys: tuple = (), kind: tuple = ()) -> Iterator[tuple[tuple, tuple]]:
    """Places of numbers and formulas, and what kind of place each is."""
    for key, child in data.items() if isinstance(data, dict) else enumerate(data):
        where = (*keys, key)
        named = len(keys) == 1 and isinstance(child, dict)
        place = (*kind, child.get("type", "") if named else "" if isinstance(key, int) else key)
        if isinstance(child, (dict, list)):
            yield from leaves(child, where, place)
        elif isinstance(child, (int, float)) or key in ("stiffness", "mass", "length"):
            yield where, place


PARTS = {f.__name__: f for f in (analyses, choices, responses, meshes, tables)}


def main() -> None:
    global FOLDER, STRIDE
    FOLDER, STRIDE = Path(sys.argv[2]), int(sys.argv[3])
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("error")
    for case, act in PARTS[sys.argv[1]]():
        faulthandler.dump_traceback_later(PATIENCE, exit=True)
        print(f"case {case}", flush=True)
        try:
            act()
        except DalembertError as error:
            if len(str(error)) > 1000:
                print(f"WRONG {case}: a message of {len(str(error))} characters")
        except BaseException as error:
            print(f"WRONG {case}: {type(error).__name__}: {error!s:.200}")
    faulthandler.cancel_dump_traceback_later()


if __name__ == "__main__":
    main()
