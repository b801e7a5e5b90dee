"""The registry of tests covers everything that can be built."""

from __future__ import annotations

import dataclasses
import inspect
import re
from pathlib import Path

import casadi as ca
import pytest
from registry import (
    CASES,
    FORMULATIONS,
    INTEGRATORS,
    LAWS,
    SOFT,
    STABILIZATIONS,
    definite,
    model_of,
)
from spatial_registry import SPATIAL_CASES, any_model_of
from thorough import covering

from dalembert.elements import planar, registry, spatial
from dalembert.formulations.automatic_formulation import AutomaticFormulation
from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.registry import INTEGRATORS as KNOWN

RIGID = {planar.UnilateralConstraint, spatial.UnilateralConstraint, planar.Collisions}
"""They have laws of their own, for they are no forces but change the motion at instants."""
COVERED = {kind for case in CASES.values() for kind in case.covers} | RIGID
NOT_ELEMENTS = {planar.Point}
OF_STRUCTURES = {planar.FlexibleBody}
"""It has laws of its own, as its numbers are those of a structure."""
DEFINITE = {f"{n}, chosen": definite(f, model_of("revolute")) for n, f in FORMULATIONS.items()}
"""What formulations become once they have chosen."""
AUTOMATIC = {"AutomaticFormulation": AutomaticFormulation()}
"""Stands for another and has laws of its own."""


def test_every_exported_element_has_a_case():
    exported = {getattr(planar, name) for name in planar.__all__} - NOT_ELEMENTS
    assert exported <= COVERED | OF_STRUCTURES


@pytest.mark.parametrize(
    "table", [*registry.PLANAR.sections.values(), registry.LAWS, registry.CURVES]
)
def test_every_row_of_the_package_registry_has_a_case(table):
    assert set(table.values()) <= COVERED | OF_STRUCTURES


OF_SPEEDS = {spatial.RollingDisc, spatial.KnifeEdge, spatial.UserConstraint}
"""They have laws of their own, as they have no equations of positions alone."""


@pytest.mark.parametrize("section", ["joints", "drivers"])
def test_every_joint_and_driver_in_space_has_a_case(section):
    assert set(registry.SPATIAL.sections[section].values()) <= COVERED | OF_SPEEDS


def test_every_law_drives_a_joint():
    assert {law.kind for law in LAWS.values()} <= COVERED


def _concrete(kind: type) -> set[type]:
    """Exported strategies below a base class; the bases themselves only say what they are."""
    below = {kind}.union(*(_concrete(k) for k in kind.__subclasses__()))
    chosen = {k for k in below if "__annotations__" in vars(k) or not k.__subclasses__()}
    ours = {k for k in chosen if k.__module__.startswith("dalembert.")}
    return {k for k in ours if not inspect.isabstract(k)}


@pytest.mark.parametrize(
    ("base", "table"),
    [
        (Formulation, FORMULATIONS | SOFT | DEFINITE | AUTOMATIC),
        (Stabilization, STABILIZATIONS),
        (Integrator, INTEGRATORS),
    ],
)
def test_every_strategy_is_listed(base, table):
    assert _concrete(base) <= {type(strategy) for strategy in table.values()}


@pytest.mark.few(24)
@pytest.mark.parametrize("name", [*CASES, *SPATIAL_CASES])
def test_every_number_given_is_a_parameter(name):
    """So that gradients tested over the registry reach every quantity of every element."""
    for element in any_model_of(name).parts.elements.values():
        for entity, formula, _ in element.checked_quantities():
            zero = formula.sx.is_constant() and not any(
                formula.sx[k].nonzeros()[0] for k in range(len(formula))
            )
            assert ca.symvar(formula.sx) or zero or _untouched(element, entity), entity


def _untouched(element, entity: str) -> bool:
    """The number is the default of its field."""
    defaults = {f.name: f.default for f in element.quantity_fields()}
    field = entity.rpartition(".")[2]
    return field in defaults and defaults[field] is not None


@pytest.mark.parametrize("name", KNOWN)
def test_options_are_described_once_and_everywhere(name):
    """Help shows every option of a method, those of its bases too, each a single time."""
    cls = KNOWN[name]
    for field in dataclasses.fields(cls):
        entry = rf"^(?:\w+, )*{field.name}(?:, \w+)* : "
        assert len(re.findall(entry, cls.__doc__, re.MULTILINE)) == 1, field.name


def test_covering_samples_have_every_value():
    cases = [{"row": row, "column": column} for row in "abcdefg" for column in range(4)]
    some = covering(cases)
    assert {cases[k]["row"] for k in some} == set("abcdefg")
    assert {cases[k]["column"] for k in some} == set(range(4))
    assert len(some) <= 9 and some == covering(cases)


def test_a_few_cases_depend_on_the_name_and_differ_in_all_parameters():
    cases = [{"row": row, "column": column} for row in "abcdefg" for column in range(4)]
    samples = [covering(cases, 3, name) for name in ("energy", "momentum", "reactions")]
    for some in samples:
        assert len(some) == 3
        assert len({cases[k]["row"] for k in some}) == 3
        assert len({cases[k]["column"] for k in some}) == 3
    assert len({frozenset(some) for some in samples}) > 1
    assert covering(cases, 3, "energy") == samples[0]


LISTED = {
    "elements": {*CASES, *SPATIAL_CASES},
    "formulations": {*FORMULATIONS, *SOFT},
    "stabilizations": {*STABILIZATIONS},
    "integrators": {*INTEGRATORS},
}


@pytest.mark.parametrize("table", LISTED)
def test_the_quick_suite_takes_each_entry_of_the_registry(table, request):
    """By several laws, of which each takes a few entries."""
    laws: dict[str, set[str]] = {}
    items = request.session.items
    if len({item.path.name for item in items if item.path.parent == Path(__file__).parent}) < 150:
        pytest.skip("a part of the laws is collected")
    for item in items:
        for value in item.callspec.params.values() if hasattr(item, "callspec") else ():
            if isinstance(value, str) and value in LISTED[table]:
                laws.setdefault(value, set()).add(item.nodeid.partition("[")[0])
    assert LISTED[table] - set(laws) == set()
