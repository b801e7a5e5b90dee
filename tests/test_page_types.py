"""Scripts of the pages: types checked by TypeScript, imports downward, names unique in a page."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import missing
from report_payload import four_bar

from dalembert.report import scripts
from dalembert.report.scripts import (
    CHARTS,
    IMPORT,
    PAGES,
    RUNS,
    asset,
    joined,
    page_script,
    worker_script,
)

ASSETS = Path(__file__).parents[1] / "src/dalembert/report/assets"
STUDIO = Path(__file__).parents[1] / "src/dalembert/studio/assets"
TYPESCRIPT = "7.0.2"
"""Version of the compiler, installed by npm into the cache of the tests."""
CACHE = Path(__file__).parents[1] / ".pytest_cache" / f"typescript-{TYPESCRIPT}"
DOCS = Path(__file__).parents[1] / "docs"
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


def type_errors(compiler: Path, folder: Path) -> str:
    run = subprocess.run([compiler, "-p", folder], capture_output=True, text=True, check=False)
    return run.stdout


@pytest.mark.parametrize("folder", [ASSETS, STUDIO], ids=["report", "studio"])
def test_scripts_have_types(compiler: Path, folder: Path) -> None:
    assert type_errors(compiler, folder) == ""


@pytest.fixture
def own_assets(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A copy of the scripts, from which pages are made."""
    folder = Path(shutil.copytree(ASSETS, tmp_path / "assets"))
    monkeypatch.setattr(scripts, "asset", lambda name: (folder / name).read_text(encoding="utf-8"))
    page_script.cache_clear()
    yield folder
    page_script.cache_clear()


@pytest.mark.thorough
def test_the_recipe_of_a_card(
    compiler: Path, own_assets: Path, show: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The blocks of docs/extending.md, put where it says, have types and draw."""
    recipe = (DOCS / "extending.md").read_text(encoding="utf-8").split("## A plot of the page")[1]
    (interface,) = re.findall(r"^```ts\n(.*?)^```", recipe, re.DOTALL | re.MULTILINE)
    (chart,) = re.findall(r"^```js\n(.*?)^```", recipe, re.DOTALL | re.MULTILINE)

    def put(name: str, before: str, text: str) -> None:
        old = (own_assets / name).read_text(encoding="utf-8")
        assert old.count(before) == 1
        (own_assets / name).write_text(old.replace(before, text + before), encoding="utf-8")

    (own_assets / "hodograph.js").write_text(chart, encoding="utf-8")
    put("types.d.ts", "export type View =", interface)
    put("types.d.ts", " | DesignView;", " | HodographView")
    monkeypatch.setitem(CHARTS, "hodograph", "hodograph.js")
    assert type_errors(compiler, own_assets) == ""
    turn = np.linspace(0, 2 * np.pi, 300)
    view = {"kind": "hodograph", "title": "Circle", "x": np.cos(turn), "y": np.sin(turn)}
    page = show(four_bar(frames=21) | {"views": [view]}).page
    assert page.inner_text("#view-0 h2") == "Circle"
    assert page.locator("#view-0 .curve").get_attribute("d").count("L") == 299


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


def script_of(kind: str) -> str:
    """Script of a page, a worker or an exported module."""
    if kind in PAGES:
        return page_script(kind, tuple(sorted(set(CHARTS.values()))))
    return worker_script(kind) if kind in RUNS else joined("module.js")


KINDS = (*PAGES, *RUNS, "module")


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_one_scope_without_comments(kind: str) -> None:
    script = script_of(kind).replace(asset("vendor/three.js"), "")
    assert not re.search(r"^(?:import|export) |/\*\*|^ *//", script, re.MULTILINE)
    repeated = [name for name, count in Counter(DECLARATION.findall(script)).items() if count > 1]
    assert repeated == []


@pytest.mark.few(11)
@pytest.mark.parametrize("kind", KINDS)
def test_the_joined_scripts_of_a_page_are_valid(kind: str, tmp_path: Path) -> None:
    """Names of one declaration after the first included."""
    node = shutil.which("node") or missing("node")
    file = tmp_path / "page.mjs"
    file.write_text(script_of(kind), encoding="utf-8")
    subprocess.run([node, "--check", file], check=True)


def test_every_script_is_part_of_a_page() -> None:
    runs = [module for module, _ in RUNS.values()]
    waiting = [*PAGES.values(), *CHARTS.values(), "live_worker.js", *runs, "module.js"]
    reached = set(waiting)
    while waiting:
        for module in set(imports(waiting.pop())) - reached:
            reached.add(module)
            waiting += [module] if module in SCRIPTS else []
    assert sorted(reached & set(SCRIPTS)) == SCRIPTS
