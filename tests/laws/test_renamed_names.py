"""Former names: none of them is public, and the error about each states the present one."""

from __future__ import annotations

import pytest

import dalembert as da
from dalembert import planar
from dalembert.elements.registry import PLANAR
from dalembert.formulations.registry import FORMULATIONS
from dalembert.integrators.registry import INTEGRATORS
from dalembert.io import load
from dalembert.io.strategies import RESPONSES
from dalembert.text.wording import RENAMED

KEYWORDS = {
    "apart": lambda: da.Multistart(apart=1e-2),
    "given": lambda: da.Case(None, da.Statics(), given={}),
    "least_crank": lambda: da.dead_centre_four_bar(0.7, least_crank=0.2),
    "least_radius": lambda: da.FlatFaceCam.smallest(da.Harmonic(0.01, 1.0), least_radius=0.003),
    "rescued": lambda: da.SLSQP(rescued=False),
}
"""Former keyword → a call with it."""
RESULTS = {"allot": da.ToleranceResult, "allotted": da.ToleranceResult}
"""Former method or attribute → class of the result."""
BODY = "format = 1\n[bodies.a]\nmass = 1.0\ninertia = 0.1\n"
SECTIONS = {
    **{
        name: f'[{section}.new]\ntype = "%s"\n'
        for section, r in PLANAR.sections.items()
        for name in r
    },
    **dict.fromkeys(
        FORMULATIONS, '[analysis]\ntype = "Dynamics"\nduration = 1\nformulation = "%s"\n'
    ),
    **dict.fromkeys(
        INTEGRATORS, '[analysis]\ntype = "Dynamics"\nduration = 1\nintegrator = "%s"\n'
    ),
    **dict.fromkeys(("Dynamics", "Equilibrium", "Modal"), '[analysis]\ntype = "%s"\n'),
    **dict.fromkeys(RESPONSES, '[responses]\nnew = { type = "%s", measure = "a.x" }\n'),
}
"""Name of a type → section of a file that gives it."""


def _module(new: str) -> object:
    """The module in which the successor of a name is public."""
    return planar if new in planar.__all__ else da


@pytest.mark.parametrize("old", sorted(RENAMED.keys() - KEYWORDS.keys() - RESULTS.keys()))
def test_a_former_name_is_an_error_that_states_the_present_one(old):
    new = RENAMED[old]
    module = _module(new)
    assert old not in dir(module)
    assert new.partition(".")[0] in dir(module)
    with pytest.raises(AttributeError, match=f"'{old}' \\(renamed: '{new}'\\)"):
        getattr(module, old)


@pytest.mark.parametrize("old", RESULTS)
def test_a_former_method_is_an_error_that_states_the_present_one(old):
    result = object.__new__(RESULTS[old])
    with pytest.raises(AttributeError, match=f"'{old}' \\(renamed: '{RENAMED[old]}'\\)"):
        getattr(result, old)


@pytest.mark.parametrize("old", KEYWORDS)
def test_a_former_keyword_is_an_error_that_states_the_present_one(old):
    with pytest.raises(da.ModelError, match=f"'{old}' \\(renamed: '{RENAMED[old]}'\\)"):
        KEYWORDS[old]()


@pytest.mark.parametrize("old", [old for old, new in RENAMED.items() if new in SECTIONS])
def test_a_former_type_in_a_file_is_an_error_that_states_the_present_one(old, tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(BODY + SECTIONS[RENAMED[old]] % old, encoding="utf-8")
    with pytest.raises(da.ModelError, match=f"'{old}' \\(renamed: '{RENAMED[old]}'\\)"):
        load(path)


def test_a_former_key_of_a_file_is_an_error_that_states_the_present_one(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text(f"{BODY}[cases.post]\ngiven = {{}}\n", encoding="utf-8")
    with pytest.raises(da.ModelError, match=r"given: unknown key \(renamed: 'inputs'\)"):
        load(path)


def test_no_former_name_is_in_use_elsewhere():
    assert not RENAMED.keys() & {*RENAMED.values()}
    assert not RENAMED.keys() & {*da.__all__, *planar.__all__, *SECTIONS}
