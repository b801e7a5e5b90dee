"""Everything that Python can run, a model file can run: exported classes have names in files."""

from __future__ import annotations

import inspect

import pytest

import dalembert as da
from dalembert import planar, spatial, structures
from dalembert.elements.base import Element
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.registry import ELEMENTS
from dalembert.elements.registry import (
    CONTACT_LAWS,
    CONTACT_PAIRS,
    FRICTIONS,
    PLANAR,
    SHAPES,
    SPATIAL,
)
from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.io.strategies import (
    ANALYSES,
    RESPONSES,
    STRATEGIES_OF,
    STRUCTURAL_ANALYSES,
    TRAJECTORY_METHODS,
)
from dalembert.responses.base import Response
from dalembert.results.analysis import Analysis


def exported(module, base: type) -> set[str]:
    """Public classes of a module that derive from a base, without the base itself."""
    classes = {n: getattr(module, n) for n in module.__all__ if inspect.isclass(getattr(module, n))}
    return {n for n, cls in classes.items() if issubclass(cls, base) and cls is not base}


def test_analyses():
    in_files = {*ANALYSES, *STRUCTURAL_ANALYSES, *TRAJECTORY_METHODS}
    assert exported(da, Analysis) <= in_files


@pytest.mark.parametrize("space", [PLANAR, SPATIAL], ids=lambda space: space.name)
def test_elements(space):
    module = {"planar": planar, "spatial": spatial}[space.name]
    in_files = {name for section in space.sections.values() for name in section}
    assert exported(module, Element) - in_files <= {"Ground"}  # every system has its ground


@pytest.mark.parametrize(("module", "dimension"), [(planar, 2), (spatial, 3)])
def test_parts_of_contacts(module, dimension):
    classes = {n for n in module.contact.__all__ if inspect.isclass(getattr(module.contact, n))}
    assert classes <= {*SHAPES[dimension], *CONTACT_LAWS, *FRICTIONS, *CONTACT_PAIRS}


@pytest.mark.parametrize("base", [Formulation, Stabilization, Integrator, ContactScheme])
def test_strategies(base):
    assert exported(da, base) <= set(STRATEGIES_OF[base])


def test_responses_and_finite_elements():
    assert exported(da, Response) <= set(RESPONSES)
    assert exported(structures, StructuralElement) <= set(ELEMENTS)
