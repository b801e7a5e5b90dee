"""Formulas copied by CasADi are those that were written, for symbols and for numbers."""

import casadi as ca
import numpy as np
import pytest

from dalembert.elements.spatial import inertia_tensor
from dalembert.symbolic import rotation

TEMPLATES = [
    (rotation.matrix, (4,)),
    (rotation.product, (4, 4)),
    (rotation.rate, (4, 3)),
    (rotation.turned, (4, 3)),
    (rotation.turn, (4, 4)),
    (inertia_tensor._minors, (6,)),
]


@pytest.mark.parametrize(("template", "sizes"), TEMPLATES, ids=[f.__name__ for f, _ in TEMPLATES])
def test_a_template_is_its_formula(template, sizes):
    written = template.__wrapped__
    symbols = [ca.SX.sym(f"s{k}", n) for k, n in enumerate(sizes)]
    functions = [ca.Function("f", symbols, [ca.densify(f(*symbols))]) for f in (template, written)]
    numbers = [np.random.default_rng(k).uniform(0.5, 1.0, n) for k, n in enumerate(sizes)]
    assert np.array_equal(*(function(*numbers).full() for function in functions))
    assert functions[0].n_nodes() == functions[1].n_nodes()
    constants = [ca.SX(column.tolist()) for column in numbers]
    assert template(*constants).is_constant()
