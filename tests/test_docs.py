"""The documentation is true: its code runs, its models build, its links lead somewhere."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import traceback
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot
import pandas
import pytest
import scipy.integrate
import scipy.optimize
import scipy.stats
import xarray

import dalembert
from dalembert.cli import main
from dalembert.cli.app import COMMANDS
from dalembert.elements import registry
from dalembert.io import load_model_file
from dalembert.io.decisions.tasks import check_tasks

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")),
    *sorted(DOCS.glob("*.md")),
]
FENCE = re.compile(r"^```(\S*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"\[(?:[^\]\\]|\\.)*\]\(([^)\s]+)\)")
IMPORTED = matplotlib.pyplot, pandas, scipy.integrate, scipy.optimize, scipy.stats, xarray
"""What nearly every script asks for: here once, and not by each of them (``failure_of``)."""
ELEMENTS = [
    name
    for table in (*registry.PLANAR.sections.values(), registry.LAWS, registry.CURVES)
    for name in table
]


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its text, and the line of the page on which the text begins."""

    language: str
    text: str
    line: int


def blocks(page: Path, language: str) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    computed = [Block(m[1], m[2], text.count("\n", 0, m.start()) + 2) for m in FENCE.finditer(text)]
    return [b for b in computed if b.language == language]


def models(page: Path) -> dict[str, str]:
    """File name → text of the blocks that claim to be a model; the first line names the file."""
    results = {}
    for block in blocks(page, "toml"):
        if re.search(r"^format\s*=", block.text, re.MULTILINE):
            name = block.text.partition("\n")[0].lstrip("# ").strip()
            assert name.endswith(".toml"), f"{page.name}:{block.line}: begin with '# NAME.toml'"
            results[name] = block.text
    return results


def prose(page: Path) -> str:
    """The page without fenced blocks."""
    return FENCE.sub("", page.read_text(encoding="utf-8"))


LONG = {
    "python": [
        *("extending.md", "flexible.md", "fmu.md", "gradients.md", "nonsmooth.md"),
        *("structures.md", "synthesis.md", "trajectories.md"),
    ],
    "sh": ["live.md", "pages.md"],
}
"""Pages by the language of blocks that take more than one and a half seconds."""


def having(language: str) -> list:
    """Pages with blocks of a language; the long ones are thorough."""
    return [
        pytest.param(
            p, id=p.name, marks=[pytest.mark.thorough] * (p.name in LONG.get(language, ()))
        )
        for p in PAGES
        if blocks(p, language)
    ]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder beside the examples, as a reader would have it."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    return tmp_path


def write_models(page: Path, folder: Path) -> None:
    for name, text in models(page).items():
        (folder / name).write_text(text, encoding="utf-8")


def failure_of(script: Path) -> str:
    """What a script tells when it fails, run in a process of its own.

    A process that begins with what this one has imported starts sooner; additions to registries
    come before the tables that are made from them, and so need an empty one.
    """
    if "elements.registry" in script.read_text(encoding="utf-8"):
        done = subprocess.run(
            [sys.executable, script], capture_output=True, text=True, check=False, env=os.environ
        )
        return f"ended with {done.returncode}: {done.stderr}" if done.returncode else ""
    process = multiprocessing.get_context("fork").Process(target=run_here, args=(script,))
    process.start()
    process.join()
    text = script.with_suffix(".txt").read_text(encoding="utf-8")
    return f"ended with {process.exitcode}: {text}" if process.exitcode else ""


def run_here(script: Path) -> None:
    """Run a script in this process; what it tells stands beside it."""
    with script.with_suffix(".txt").open("w", encoding="utf-8") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        sys.stdout = sys.stderr = file
        try:
            runpy.run_path(str(script), run_name="__main__")
        except BaseException:
            traceback.print_exc(file=file)
            raise


@pytest.mark.parametrize("page", having("python"))
def test_python_runs_as_printed(page, folder):
    write_models(page, folder)
    lines: list[str] = []
    for block in blocks(page, "python"):  # on the lines of the page, so that tracebacks point there
        lines += [""] * (block.line - 1 - len(lines)) + block.text.splitlines()
    script = folder / f"{page.stem}_blocks.py"
    script.write_text("\n".join(lines) + "\n", encoding="utf-8")
    failure = failure_of(script)
    assert not failure, failure


@pytest.mark.parametrize("page", [p for p in having("toml") if models(p.values[0])])
def test_models_load_and_build(page, folder):
    write_models(page, folder)
    for name in models(page):
        file = load_model_file(folder / name)
        check_tasks(file, file.model())


@pytest.mark.parametrize("page", having("sh"))
def test_commands_run(page, folder, capsys):
    write_models(page, folder)
    for block in blocks(page, "sh"):
        for line in block.text.splitlines():
            words = shlex.split(line, comments=True)
            if words[:1] == ["dalembert"]:
                assert main(words[1:]) == 0, f"{line}\n{capsys.readouterr().err}"


def test_commands_that_are_named_exist():
    code = [text for page in PAGES for text in re.findall(r"`([^`\n]+)`", prose(page))]
    assert set(re.findall(r"dalembert ([a-z]+)\b", "\n".join(code))) <= set(COMMANDS)
    features = (DOCS / "index.md").read_text(encoding="utf-8")
    assert set(COMMANDS) <= set(re.findall(r"\w+", features))


def anchors(page: Path) -> set[str]:
    """Names that headings get, as GitHub and MyST make them."""
    headings = re.findall(r"^#+ (.*)$", prose(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_links_lead_somewhere(page):
    for target in LINK.findall(prose(page)):
        if target.startswith(("https://", "http://", "mailto:")):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        assert there.exists(), f"{target}: there is no such file"
        assert not anchor or anchor in anchors(there), f"{target}: there is no such heading"


def test_every_page_is_linked():
    text = prose(DOCS / "index.md")
    pages = {p.name for p in DOCS.glob("*.md")} - {"contents.md"}
    assert pages - {"index.md"} <= set(LINK.findall(text))
    trees = blocks(DOCS / "contents.md", "{toctree}")
    listed = [name for tree in trees for name in tree.text.split()]
    assert {p.removesuffix(".md") for p in pages} <= set(listed)


@pytest.mark.parametrize("page", ["theory.md", "architecture.md", "extending.md"])
def test_source_files_that_are_named_exist(page):
    source, last = ROOT / "src" / "dalembert", Path()
    for name in re.findall(r"`([\w/.]+\.py|[\w/]+/)`", prose(DOCS / page)):
        if name.endswith("rope.py"):  # the example of a new file
            continue
        expected = [source / name, ROOT / name, last / name]
        path = next((p for p in expected if p.exists()), None)
        if path is None:
            path = next(source.rglob(name), None)
        assert path, name
        last = path.parent


def test_contributing_is_short():
    assert len((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()) <= 60


def test_generated_parts_are_up_to_date(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    generator = importlib.import_module("generate_reference")
    stale = [page.name for page in generator.stale()]
    assert not stale, f"run: python docs/generate_reference.py (out of date: {', '.join(stale)})"
    used = {name for p in PAGES for name in generator.BLOCK.findall(p.read_text(encoding="utf-8"))}
    assert used == set(generator.PARTS)


def test_a_page_has_signatures_parameters_and_examples(monkeypatch):
    monkeypatch.syspath_prepend(DOCS)
    pages = importlib.import_module("api_pages")
    text = pages.page("dalembert.planar", dalembert.planar)
    assert text.count("\n**Examples**\n\n```pycon\n>>> ") == len(dalembert.planar.__all__)
    assert "## `planar.Cable`\n\n```python\nplanar.Cable(\n    name: str," in text
    assert "\n- `clearance`: radius of the hole minus that of the journal or ball [m]\n" in text
    text = pages.page("dalembert", dalembert)
    assert "\n- `AnalysisError`: The run fails at the starting design" in text


@pytest.mark.thorough
def test_embedded_pages_are_live(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(DOCS)
    importlib.import_module("live_pages").write(tmp_path)
    written = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    assert all('id="worker"' in text for text in written.values()), list(written)
    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    embedded = re.findall(r'<iframe src="_static/live/([^"]+)"', text)
    assert embedded and set(embedded) <= set(written)


def test_every_public_name_is_told():
    text = "\n".join(p.read_text(encoding="utf-8") for p in PAGES)
    words = set(re.findall(r"\w+", text))
    assert set(dalembert.__all__) <= words
    assert set(dalembert.laws.__all__) - {"Law"} <= words


def test_every_element_is_described():
    assert set(ELEMENTS) <= set(re.findall(r"\w+", prose(DOCS / "elements.md")))
