"""On what it was measured, and with which versions."""

from __future__ import annotations

import os
import platform
from datetime import date
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("dalembert", "casadi", "numpy", "scipy", "exudyn", "mujoco", "pin", "sympy")
MORE = ("scikit-fem", "llvmlite", "pypardiso", "pyamg")


def facts(rounds: int) -> list[str]:
    """Processor, versions, and how numbers were made."""
    found = [f"{name} {number}" for name in (*PACKAGES, *MORE) if (number := _version(name))]
    load = (
        f", load average {os.getloadavg()[0]:.1f} at the end" if hasattr(os, "getloadavg") else ""
    )
    return [
        f"{_processor()}, {os.cpu_count()} processors{load}; {platform.system()}, Python "
        f"{platform.python_version()}; {date.today().isoformat()}",
        ", ".join(found),
        f"medians of {rounds} runs in turns, ± half the distance of the quartiles; one process, "
        "without building and compiling where nothing else is said",
    ]


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            for line in lines:
                if line.startswith("model name"):
                    return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
