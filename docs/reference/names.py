"""Public names, and functions of formulas."""

from __future__ import annotations

import inspect

import dalembert
from dalembert.symbolic.formulas.parser import FUNCTIONS
from reference.markdown import table

NAMED = {
    "t": "time, in laws, forces and user constraints",
    "u": "parameter of a `FormulaCurve`",
    "laws": "motion laws for drivers",
    "planar": "planar bodies, joints, drivers and forces",
    "spatial": "spatial bodies, joints, drivers and forces",
    "rotation": "orientations: `axis_angle`, `euler`, `bryant`, `from_matrix`",
}


def api() -> str:
    """Every public name with its signature and first sentence."""
    rows = []
    for name in sorted(dalembert.__all__, key=lambda n: (n[0].islower(), n.lower())):
        rows.append((f"`{name}`", _kind(getattr(dalembert, name)), _first(name)))
    return table(("name", "kind", "description"), rows)


def _kind(value: object) -> str:
    if inspect.isclass(value):
        return "error" if issubclass(value, Exception) else "class"
    if inspect.ismodule(value):
        return "module"
    return "function" if callable(value) else "expression"


def _first(name: str) -> str:
    value = getattr(dalembert, name)
    if name in NAMED:
        return NAMED[name]
    return (inspect.getdoc(value) or "").partition("\n")[0]


def functions() -> str:
    names = (f"`{n}({', '.join('abc'[:k])})`" for n, (_, k) in FUNCTIONS.items())
    return ", ".join(names)
