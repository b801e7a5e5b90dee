"""``dalembert examples``: example model files, scripts and notebooks."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

from dalembert.cli.console import DONE, AsJson, print_json, print_line, wrong_input
from dalembert.errors import FileError
from dalembert.io.example_files import example_folder

MODELS = ("*.toml", "teaching/*.toml")
"""Patterns of model files."""
OTHER_KINDS = ("*.py", "notebooks/*.ipynb", "*.dat")
"""Patterns of examples that are not model files."""
STYLE = "style.py"
"""Plot settings that the examples import; not an example itself."""


def examples(
    name: str | None = None,
    /,
    *,
    output: Path | None = None,
    force: bool = False,
    as_json: AsJson = False,
) -> int:
    """List the example models, or copy one here.

    Parameters
    ----------
    name
        Example to copy, e.g. four_bar, robot_arm.py or start.ipynb.
    output
        Folder to copy to; the current folder by default.
    force
        Replace an existing file.
    """
    available = _examples()
    if name is None:
        if as_json:
            print_json({"ok": True, "examples": {n: about(p) for n, p in available.items()}})
        else:
            for n, path in available.items():
                print_line(f"{n:<26} {about(path)}")
            print_line("\n'dalembert examples NAME' copies one here, with the files it needs")
        return DONE
    with wrong_input():
        files = _copy(available, name.removesuffix(".toml"), output or Path(), force)
    if as_json:
        print_json({"ok": True, "files": [str(path) for path in files]})
    else:
        for path in files:
            print_line(f"written {path}")
        print_line(f"now try: {_next_command(files[0])}")
    return DONE


def _examples() -> dict[str, Path]:
    """Name → file: model files by stem, other examples by file name."""
    folder = example_folder()
    models = {path.stem: path for kind in MODELS for path in sorted(folder.glob(kind))}
    other_files = [p for kind in OTHER_KINDS for p in sorted(folder.glob(kind)) if p.name != STYLE]
    return models | {path.name: path for path in other_files}


def _copy(available: dict[str, Path], name: str, folder: Path, force: bool) -> list[Path]:
    """Copy the example and the files that it refers to; returns the copies."""
    from dalembert.files import atomic_path
    from dalembert.text.wording import unknown

    if name not in available and f"{name}.py" in available:
        name = f"{name}.py"
    if name not in available:
        raise FileError(unknown("example", name, available))
    copies: list[Path] = []
    for source in [available[name], *_dependencies(available[name])]:
        target = folder / source.name
        if target.exists() and not force:
            if copies:  # copied with an earlier example
                continue
            raise FileError(f"{target}: exists already; use --force to replace it")
        copies.append(target)
        with atomic_path(target) as temporary:
            shutil.copyfile(source, temporary)
    return copies


def _dependencies(path: Path) -> list[Path]:
    """Files in the folder of an example that its text refers to."""
    text, folder = path.read_text(encoding="utf-8"), example_folder()
    neighbours = [
        p for kind in ("*.toml", "*.dat", "*.csv") for p in sorted(folder.glob(kind)) if p != path
    ]
    imported = [folder / f"{module}.py" for module in re.findall(r"^import (\w+)$", text, re.M)]
    mentioned = [p for p in neighbours if re.search(rf"[\"'/]{re.escape(p.name)}[\"']", text)]
    return [p for p in (*imported, *mentioned) if p.exists()]


def _next_command(path: Path) -> str:
    """Command that runs an example."""
    verbs = {".py": "python", ".ipynb": "jupyter lab", ".dat": "dalembert run"}
    return f"{verbs.get(path.suffix, 'dalembert check')} {path}"


def about(path: Path) -> str:
    """First line of the description of an example: a comment, a docstring or a heading."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        first = "".join(json.loads(text)["cells"][0]["source"])
        return first.partition("\n")[0].lstrip("# ")
    first = text.partition("\n")[0]
    if path.suffix == ".py":
        return first.strip('" ')
    if path.suffix == ".dat":
        return "Text deck of a spring structure."
    return first.lstrip("# ").rstrip() if first.startswith("#") else ""
