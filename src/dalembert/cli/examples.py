"""``dalembert examples``: model files, scripts and notebooks to begin with."""

from __future__ import annotations

import json
import re
import shutil
from importlib import resources
from pathlib import Path

from dalembert.cli.console import DONE, AsJson, emit, tell, wrong_input
from dalembert.errors import FileError

OTHERS = ("*.py", "notebooks/*.ipynb", "*.dat")
"""Examples beside model files."""
STYLE = "style.py"
"""What pictures of examples share; copied along."""


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
        Folder to copy to; this one by default.
    force
        Replace a file that is there already.
    """
    known = _known()
    if name is None:
        if as_json:
            emit({"ok": True, "examples": {n: about(p) for n, p in known.items()}})
        else:
            for n, path in known.items():
                tell(f"{n:<26} {about(path)}")
            tell("\n'dalembert examples NAME' copies one here, with what it needs")
        return DONE
    with wrong_input():
        files = _copied(known, name.removesuffix(".toml"), output or Path(), force)
    if as_json:
        emit({"ok": True, "files": [str(path) for path in files]})
    else:
        for path in files:
            tell(f"written {path}")
        tell(f"now try: {_next(files[0])}")
    return DONE


def example_folder() -> Path:
    """Where the examples lie: in the installed package, or beside ``src`` in a checkout.

    Raises
    ------
    FileError
        They were not installed.
    """
    package = Path(str(resources.files("dalembert")))
    for folder in (package / "examples", package.parents[1] / "examples"):
        if folder.is_dir():
            return folder
    raise FileError("the example files are missing from this installation; reinstall dalembert")


def _known() -> dict[str, Path]:
    """Name → file: model files by their stem, all others by their whole name."""
    folder = example_folder()
    models = {path.stem: path for path in sorted(folder.glob("*.toml"))}
    others = [p for kind in OTHERS for p in sorted(folder.glob(kind)) if p.name != STYLE]
    return models | {path.name: path for path in others}


def _copied(known: dict[str, Path], name: str, folder: Path, force: bool) -> list[Path]:
    """The example and the files beside it that it names."""
    from dalembert.files import atomic_path
    from dalembert.text.wording import unknown

    if name not in known and f"{name}.py" in known:
        name = f"{name}.py"
    if name not in known:
        raise FileError(unknown("example", name, known))
    made: list[Path] = []
    for source in [known[name], *_needed(known[name])]:
        target = folder / source.name
        if target.exists() and not force:
            if made:  # of an earlier example
                continue
            raise FileError(f"{target}: exists already; use --force to replace it")
        made.append(target)
        with atomic_path(target) as temporary:
            shutil.copyfile(source, temporary)
    return made


def _needed(path: Path) -> list[Path]:
    """Files beside an example that its text names."""
    text, folder = path.read_text(encoding="utf-8"), example_folder()
    beside = [
        p for kind in ("*.toml", "*.dat", "*.csv") for p in sorted(folder.glob(kind)) if p != path
    ]
    imported = [folder / f"{found}.py" for found in re.findall(r"^import (\w+)$", text, re.M)]
    named = [p for p in beside if re.search(rf"[\"'/]{re.escape(p.name)}[\"']", text)]
    return [p for p in (*imported, *named) if p.exists()]


def _next(path: Path) -> str:
    """What one does with an example."""
    verbs = {".py": "python", ".ipynb": "jupyter lab", ".dat": "dalembert run"}
    return f"{verbs.get(path.suffix, 'dalembert check')} {path}"


def about(path: Path) -> str:
    """The first line that says what the example is: a comment, a docstring, a heading."""
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
