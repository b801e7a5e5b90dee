"""Optional packages, imported when a feature first needs them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from dalembert.errors import UnsupportedError

INSTALL = {
    "OCP": "dalembert[cad]",
    "SALib": "dalembert[study]",
    "anywidget": "dalembert[notebook]",
    "cma": "dalembert[design]",
    "coacd": "dalembert[mesh]",
    "distributed": "dalembert[cluster]",
    "ezc3d": "dalembert[c3d]",
    "ezdxf": "dalembert[sketch]",
    "jax": "jax",
    "meshio": "dalembert[mesh]",
    "nlopt": "dalembert[nlopt]",
    "openmdao": "dalembert[mdo]",
    "gymnasium": "dalembert[control]",
    "openturns": "dalembert[reliability]",
    "pyamg": "dalembert[sparse]",
    "pyarrow": "dalembert[study]",
    "pymoo": "dalembert[design]",
    "sklearn": "dalembert[study]",
    "starlette": "dalembert[studio]",
    "torch": "torch",
    "trimesh": "dalembert[mesh]",
    "uvicorn": "dalembert[studio]",
    "websockets": "dalembert[studio]",
    "ziglang": "dalembert[fmu]",
}
"""Package → what to install for it."""


def optional_package(module: str, feature: str, alternative: str = "") -> Any:
    """A module of an optional package.

    Parameters
    ----------
    module : name of the module, such as ``pymoo.core.problem``
    feature : what needs it, for the message
    alternative : what works without the package, for the message

    Raises
    ------
    UnsupportedError
        The package is not installed; the message states the command that installs it.
    """
    try:
        return import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        other = f", or {alternative}" if alternative else ""
        target = INSTALL[package]
        quoted = f"'{target}'" if "[" in target else target
        raise UnsupportedError(
            f"{feature} needs {package}, which is not installed: pip install {quoted}{other}"
        ) from None
