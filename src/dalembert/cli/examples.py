"""``dalembert examples``: model files to begin with."""

from __future__ import annotations

import shutil
from importlib import resources
from pathlib import Path

from dalembert.cli.console import DONE, AsJson, emit, tell, wrong_input
from dalembert.errors import FileError


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
        Example to copy, e.g. four_bar.
    output
        Folder to copy to; this one by default.
    force
        Replace a file that is there already.
    """
    known = {path.stem: path for path in sorted(example_folder().glob("*.toml"))}
    if name is None:
        if as_json:
            emit({"ok": True, "examples": {n: _about(p) for n, p in known.items()}})
        else:
            for n, path in known.items():
                tell(f"{n:<24} {_about(path)}")
            tell("\n'dalembert examples NAME' copies one here")
        return DONE
    with wrong_input():
        files = _copied(known, name.removesuffix(".toml"), output or Path(), force)
    if as_json:
        emit({"ok": True, "files": [str(file) for file in files]})
    else:
        tell(f"written {', '.join(map(str, files))}\nnow try: dalembert check {files[0]}")
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


def _copied(known: dict[str, Path], name: str, folder: Path, force: bool) -> list[Path]:
    """The file, and those that it names."""
    from dalembert.atomic import atomic_path
    from dalembert.text import unknown

    if name not in known:
        raise FileError(unknown("example", name, known))
    text = known[name].read_text(encoding="utf-8")
    beside = sorted(known[name].parent.glob("*.csv"))
    sources = [known[name], *(path for path in beside if f'"{path.name}"' in text)]
    targets = [folder / source.name for source in sources]
    for target in targets:
        if target.exists() and not force:
            raise FileError(f"{target}: exists already; use --force to replace it")
    for source, target in zip(sources, targets, strict=True):
        with atomic_path(target) as temporary:
            shutil.copyfile(source, temporary)
    return targets


def _about(path: Path) -> str:
    """The first comment line of the file."""
    first = path.read_text(encoding="utf-8").partition("\n")[0]
    return first.lstrip("# ").rstrip() if first.startswith("#") else ""
