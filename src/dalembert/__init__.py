"""dalembert: analysis and design optimisation of constrained mechanical systems.

>>> import dalembert as da
>>> from dalembert import planar

The public names stand in ``__init__.pyi``; each is imported when it is first used.
"""

from __future__ import annotations

import ast
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

__version__ = "0.1.0"


def _listed() -> dict[str, tuple[str, str]]:
    """Public name → module and name there."""
    stub = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    return {
        str(alias.asname): (str(line.module), alias.name)
        for line in ast.parse(stub).body
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
    }


_PUBLIC = _listed()
__all__ = list(_PUBLIC)


def __getattr__(name: str) -> object:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, original = _PUBLIC[name]
    found = vars(import_module(module)).get(original)
    if found is None:  # not made by the module, but a package in it
        found = import_module(f"{module}.{original}")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Front(ModuleType):
    """A function is not hidden by the package it comes from, as ``sensitivity`` would be."""

    def __setattr__(self, name: str, value: object) -> None:
        home, _ = _PUBLIC.get(name, (__name__, name))
        if home == __name__ or not isinstance(value, ModuleType):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Front
