"""Model files that were opened or saved last, stored in the folder of the user's state."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

from dalembert.errors import FileError
from dalembert.files import atomic_path
from dalembert.studio.journal import journal_folder

LIMIT = 12
"""Number of files that are remembered."""
NAME = "recent_files.txt"


def recent_files(folder: Path | None = None) -> list[Path]:
    """Files that exist, the last one first.

    Parameters
    ----------
    folder : of the list; that of the user by default
    """
    with suppress(OSError, ValueError):
        text = _file(folder).read_text(encoding="utf-8")
        paths = json.loads(text)
        if isinstance(paths, list):
            named = [Path(path) for path in paths[:LIMIT] if isinstance(path, str)]
            return [path for path in named if _is_file(path)]
    return []


def remember(path: Path, folder: Path | None = None) -> None:
    """Put a file first; without effect where the folder cannot be written."""
    others = [other for other in recent_files(folder) if other != path]
    with suppress(OSError, ValueError, FileError):
        _file(folder).parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        with atomic_path(_file(folder)) as temporary:
            temporary.write_text(json.dumps([str(p) for p in (path, *others)][:LIMIT]), "utf-8")


def _file(folder: Path | None) -> Path:
    return (journal_folder() if folder is None else folder) / NAME


def _is_file(path: Path) -> bool:
    with suppress(OSError, ValueError):
        return path.is_file()
    return False
