"""Model files that can be opened: recent ones, those of a folder, and the examples."""

from __future__ import annotations

from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from dalembert.errors import DalembertError, FileError
from dalembert.files import read_text
from dalembert.io.example_files import example_folder
from dalembert.io.reading import parse_document
from dalembert.studio.recent_files import recent_files

MAX_FILES = 500
"""Upper limit of the listed files of a folder."""


def listed_files(folder: Path, state: Path | None = None) -> dict[str, Any]:
    """Recent files, model files of a folder, and the examples with their descriptions.

    Parameters
    ----------
    folder : whose files are listed
    state : folder of the list of recent files; that of the user by default
    """
    beside = sorted(str(path) for path in folder.glob("*.toml"))[:MAX_FILES]
    recent = [str(path) for path in recent_files(state)]
    examples = example_texts()
    return {"folder": str(folder), "files": beside, "recent": recent, "examples": examples}


@cache
def example_texts() -> list[dict[str, str]]:
    """Name, title and description of the examples; none where they are not installed."""
    listed: list[dict[str, str]] = []
    try:
        folder = example_folder()
    except FileError:
        return listed
    for path in sorted(folder.glob("*.toml")):
        with suppress(DalembertError):
            data = parse_document(path, read_text(path))
            texts = {key: str(data.get(key, "")) for key in ("name", "description")}
            listed.append({"example": path.stem} | texts)
    return listed
