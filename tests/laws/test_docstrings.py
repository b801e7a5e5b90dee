"""Every public name shows by an example what it is for, and the examples run as printed."""

import dataclasses
import doctest
import inspect
import re
from typing import Any

import pytest

import dalembert as da

MODULES = {
    "planar": da.planar,
    "planar.contact": da.planar.contact,
    "spatial": da.spatial,
    "spatial.contact": da.spatial.contact,
    "structures": da.structures,
    "laws": da.laws,
    "rotation": da.rotation,
    "da": da,
}
"""As examples call them."""


def speaks(thing: object) -> bool:
    """A class or a function, which has a docstring of its own."""
    return inspect.isclass(thing) or inspect.isfunction(thing)


def names() -> dict[str, Any]:
    """What is public, each thing under its first name."""
    results: dict[str, Any] = {}
    for spoken, module in MODULES.items():
        for name in module.__all__:
            thing = getattr(module, name)
            if speaks(thing) and not any(thing is other for other in results.values()):
                results[f"{spoken}.{name}"] = thing
    return results


NAMES = names()
NEEDS = {
    "da.CMAES": "cma",
    "da.CCSAQ": "nlopt",
    "da.gaussian_process": "sklearn",
    "da.morris_indices": "SALib",
    "da.openmdao_component": "openmdao",
    "da.openmdao_implicit_component": "openmdao",
    "da.pymoo_problem": "pymoo",
    "da.sobol_indices": "SALib",
    "spatial.Mesh": "trimesh",
    "spatial.contact.Corners": "trimesh",
}
"""Name → package that its example needs beside those that are always there."""


def test_whatever_else_is_public_has_no_docstring_of_its_own():
    """Modules, and constants that ``Expression`` and ``six_bar`` show."""
    other = {name for name in da.__all__ if not speaks(getattr(da, name))}
    modules = {name for name in other if inspect.ismodule(getattr(da, name))}
    assert other - modules == {"t", "INVERSIONS"}


@pytest.mark.parametrize("name", NAMES)
def test_a_public_name_shows_an_example(name):
    text = inspect.cleandoc(vars(NAMES[name]).get("__doc__") or NAMES[name].__doc__ or "")
    _, section, example = text.partition("\n\nExamples\n--------\n")
    assert section, "needs a section Examples"
    assert name.rpartition(".")[2] in example, "its example is about something else"
    examples = doctest.DocTestParser().get_examples(example)
    assert examples[-1].want, "its example shows nothing"
    assert len(example.splitlines()) <= 20, "its example is too long to be read at a glance"


MADE = {
    *(
        "da.ParetoResult",
        "da.IdentificationResult",
        "da.InversionResult",
        "da.TrajectoryResult",
        "da.OptimizationResult",
    ),
    *(
        "da.Outcome",
        "da.ReliabilityResult",
        "da.Surface",
        "da.SynthesisResult",
        "da.ToleranceResult",
    ),
}
"""Results, which verbs make: their attributes are told."""
ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*) : ", re.MULTILINE)


@pytest.mark.parametrize("name", [name for name in NAMES if name not in MADE])
def test_every_parameter_is_described(name):
    """In the docstring, in that of a base class, or by the field of an element itself."""
    thing = NAMES[name]
    documented = {"name"}
    for one in getattr(thing, "__mro__", (thing,)):
        text = inspect.cleandoc(one.__doc__ or "").partition("\n\nExamples\n")[0]
        documented |= {
            word.strip("*") for listed in ENTRY.findall(text) for word in listed.split(", ")
        }
    if dataclasses.is_dataclass(thing):
        documented |= {f.name for f in dataclasses.fields(thing) if f.metadata.get("description")}
    if not (inspect.isclass(thing) and issubclass(thing, Exception)):
        assert set(inspect.signature(thing).parameters) <= documented


@pytest.mark.few(40)
@pytest.mark.parametrize("name", NAMES)
def test_an_example_runs_as_printed(name):
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    text = inspect.getdoc(NAMES[name]) or ""
    example = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    messages: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(
        example, out=messages.append
    )
    assert not messages, "".join(messages)
