"""Scripts of the pages: types checked by TypeScript, imports downward, names unique in a page."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from browser import missing

from dalembert.report.scripts import IMPORT, PAGES, asset, page_script

ASSETS = Path(__file__).parents[1] / "src/dalembert/report/assets"
TYPESCRIPT = "7.0.2"
"""Version of the compiler, installed by npm into the cache of the tests."""
CACHE = Path(__file__).parents[1] / ".pytest_cache" / f"typescript-{TYPESCRIPT}"
SCRIPTS = sorted(path.name for path in ASSETS.glob("*.js"))
DECLARATION = re.compile(r"^(?:async )?(?:function|class|const|let) (\w+)", re.MULTILINE)


@pytest.fixture(scope="module")
def compiler() -> Path:
    """Path of ``tsc``; skip, or under CI=true fail, without npm."""
    program = CACHE / "node_modules/.bin" / ("tsc.cmd" if os.name == "nt" else "tsc")
    if not program.exists():
        npm = shutil.which("npm")
        if npm is None:
            missing("npm")
        command = [npm, "install", "--silent", "--no-audit", "--no-fund", "--prefix", str(CACHE)]
        if subprocess.run([*command, f"typescript@{TYPESCRIPT}"], check=False).returncode:
            missing("TypeScript")
    return program


def test_scripts_have_types(compiler: Path) -> None:
    run = subprocess.run([compiler, "-p", ASSETS], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout


def imports(name: str) -> list[str]:
    return IMPORT.findall((ASSETS / name).read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", SCRIPTS)
def test_imports_have_no_cycles(name: str) -> None:
    reached, waiting = set(), imports(name)
    while waiting:
        module = waiting.pop()
        if module not in reached and module in SCRIPTS:
            reached.add(module)
            waiting += imports(module)
    assert name not in reached


@pytest.mark.parametrize("kind", PAGES)
def test_a_page_is_one_scope_without_comments(kind: str) -> None:
    script = page_script(kind).replace(asset("vendor/three.js"), "")
    assert not re.search(r"^(?:import|export) |/\*\*|^ *//", script, re.MULTILINE)
    repeated = [name for name, count in Counter(DECLARATION.findall(script)).items() if count > 1]
    assert repeated == []


def test_every_script_is_part_of_a_page() -> None:
    reached, waiting = set(PAGES.values()), list(PAGES.values())
    while waiting:
        for module in set(imports(waiting.pop())) - reached:
            reached.add(module)
            waiting += [module] if module in SCRIPTS else []
    assert sorted(reached & set(SCRIPTS)) == SCRIPTS
