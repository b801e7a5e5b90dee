"""What people find beside the code is in step with it."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import dalembert
from dalembert import packages

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_versions_are_in_step() -> None:
    assert dalembert.__version__ == PROJECT["version"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r"^version: (.+)$", citation, re.M)[1] == PROJECT["version"]
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    released = re.findall(r"^## \[?(\d+\.\d+\.\d+)", changes, re.M)
    assert not released or released[0] == PROJECT["version"]


def test_the_licence_is_the_same_everywhere() -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"license: {PROJECT['license']}" in citation


def test_three_systems_are_tested() -> None:
    workflow = (ROOT / ".github/workflows/tests.yml").read_text(encoding="utf-8")
    assert all(f"{system}-latest" in workflow for system in ("ubuntu", "macos", "windows"))


@pytest.mark.parametrize(("package", "target"), packages.INSTALL.items())
def test_the_extra_of_an_optional_package_installs_it(package: str, target: str) -> None:
    names = {"sklearn": "scikit-learn", "OCP": "cadquery-ocp-novtk"}
    name = names.get(package, package)
    if "[" not in target:
        assert target == name
        return
    extra = target.removeprefix("dalembert[").removesuffix("]")
    assert any(re.match(rf"{name}\b", line) for line in PROJECT["optional-dependencies"][extra])
