"""The folder tree is the architecture: imports run downward, files stay small, import is quick."""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import grimp
import pytest

ROOT = Path(__file__).parents[1]
SOURCES = sorted((ROOT / "src" / "dalembert").rglob("*.py"))


def test_imports_run_downward_only():
    done = subprocess.run(
        [Path(sys.executable).parent / "lint-imports", "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_no_import_cycles():
    graph = grimp.build_graph("dalembert", cache_dir=None)
    done: set[str] = set()

    def visit(module: str, path: tuple[str, ...]) -> None:
        assert module not in path, " → ".join((*path[path.index(module) :], module))
        if module not in done:
            for imported in graph.find_modules_directly_imported_by(module):
                visit(imported, (*path, module))
            done.add(module)

    for module in graph.modules:
        visit(module, ())


def test_style():
    done = subprocess.run(
        [sys.executable, "-m", "ruff", "check", "src", "tests", "examples", "benchmarks"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.thorough
def test_types():
    done = subprocess.run(
        [sys.executable, "-m", "mypy"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT / "src")))
def test_every_module_says_what_it_is(path):
    text = path.read_text(encoding="utf-8")
    assert text.startswith('"""'), "a module begins with a docstring"
    assert len(text.splitlines()) <= 320, "a file this long holds more than one concept"


def run(code: str, environment: dict[str, str] | None = None) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | (environment or {}),
    )
    return done.stdout.strip()


def test_heavy_libraries_are_imported_lazily():
    """None with the package; with its names only what they need, which files need more of."""
    heavy = (
        "xarray",
        "pandas",
        "matplotlib",
        "pydantic",
        "scipy.linalg",
        "scipy.optimize",
        "scipy.sparse",
        "scipy.spatial",
        "llvmlite",
        "pycparser",
    )
    loaded = "print([m for m in {} if m in sys.modules])"
    first, then = ("casadi", "numpy", *heavy), heavy
    assert run(f"import sys, dalembert; {loaded.format(first)}") == "[]"
    names = "(n for n, (m, _) in dalembert._PUBLIC.items() if not m.startswith('dalembert.io'))"
    touch = f"[getattr(dalembert, name) for name in {names}]"
    assert run(f"import sys, dalembert; {touch}; {loaded.format(then)}") == "[]"


def test_commands_import_what_they_need():
    """Help shows without any mathematics; a run is written and drawn without tables and plots."""
    called = (
        "from dalembert.cli.app import main; main({}); "
        "import sys; print([m for m in {} if m in sys.modules], "
        "sum(m.startswith('dalembert') for m in sys.modules) > 520)"
    )
    assert run(called.format(["--version"], ("casadi", "numpy"))).splitlines()[-1] == "[] False"
    heavy = (
        "xarray",
        "pandas",
        "matplotlib",
        "scipy.optimize",
        "scipy.spatial",
        "dalembert.design.optimize.problem",
        "dalembert.design.synthesis.synthesize",
        "dalembert.sensitivity.gradient",
        "dalembert.analysis.comparison.compare",
    )
    with TemporaryDirectory() as folder:
        example = str(Path(__file__).parents[1] / "examples" / "four_bar.toml")
        arguments = ["run", example, "--output", folder, "--quiet"]
        without_cache = {"DALEMBERT_CACHE": str(Path(folder) / "cache")}
        assert run(called.format(arguments, heavy), without_cache) == "[] False"
        assert (Path(folder) / "four_bar.nc").stat().st_size > 0


def test_public_names():
    """Each is there whatever was imported before, and packages do not hide functions."""
    optimization = "dalembert.design.optimize.optimization"
    for before in ("dalembert", "dalembert.sensitivity.gradient", optimization):
        code = (
            f"import dalembert as da, {before}; print(callable(da.sensitivity), "
            "set(da.__all__) - set(dir(da)), da.structures.__name__)"
        )
        assert run(code) == "True set() dalembert.structures", before
    assert not hasattr(__import__("dalembert"), "no_such_name")
