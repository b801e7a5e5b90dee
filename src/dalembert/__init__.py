"""dalembert: analysis and design optimisation of constrained mechanical systems.

>>> import dalembert as da
>>> from dalembert import planar

The public names are listed in ``__init__.pyi``; each is imported on first use.
"""

from __future__ import annotations

import ast
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

__version__ = "0.1.0"


def _public_names() -> dict[str, tuple[str, str]]:
    """Public name → module and name in it."""
    stub = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    return {
        str(alias.asname): (str(line.module), alias.name)
        for line in ast.parse(stub).body
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
    }


_PUBLIC = _public_names()
__all__ = list(_PUBLIC)


def __getattr__(name: str) -> object:
    if name.startswith("_"):  # inquiries of tools, without a search for similar names
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name not in _PUBLIC:
        wording = import_module("dalembert.text.wording")
        raise AttributeError(wording.no_attribute(__name__, name, __all__))
    module, original = _PUBLIC[name]
    value = vars(import_module(module)).get(original)
    if value is None:  # a package, not a name in the module
        value = import_module(f"{module}.{original}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Front(ModuleType):
    """Module whose public functions are not shadowed by packages, such as ``sensitivity``."""

    def __setattr__(self, name: str, value: object) -> None:
        module, _ = _PUBLIC.get(name, (__name__, name))
        if module == __name__ or not isinstance(value, ModuleType):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Front
