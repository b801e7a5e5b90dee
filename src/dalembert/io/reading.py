"""Parsing of model files to plain data, with checks of text, syntax and size.

Names of older model files are replaced by the present ones.
"""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

from dalembert.errors import FileError
from dalembert.files import read_text
from dalembert.io.messages import key_path
from dalembert.text.wording import plain_text

MAX_DEPTH = 40
"""Upper limit of nested tables."""
MAX_KEY_PARTS = 1000
"""Upper limit of the parts of a dotted key."""

# The TOML reader takes quadratic time on keys with thousands of dots.
_KEY = re.compile(r"[^\n=,{}#]+")


def read_document(path: str | Path) -> dict[str, Any]:
    """The table in a TOML or JSON file.

    Raises
    ------
    FileError
        Not a readable text file, too large, or not TOML or JSON (with line and column).
    ModelError
        A text contains hidden characters; states its location.
    """
    return parse_document(Path(path), read_text(path))


def parse_document(path: Path, text: str) -> dict[str, Any]:
    """The table in a TOML or JSON text; ``path`` selects the format and is named in messages.

    Raises
    ------
    FileError, ModelError
        As ``read_document``.
    """
    if not text.strip():
        raise FileError(f"{path}: the file is empty; 'dalembert examples' writes complete ones")
    if path.suffix.lower() == ".json":
        data = _parse_json(path, text)
    else:
        data = _parse_toml(path, text)
    if not isinstance(data, dict):
        raise FileError(
            f"{path}: the file must hold a table (an object), got {type(data).__name__}"
        )
    if _depth(data) > MAX_DEPTH:
        raise FileError(f"{path}: tables are nested more than {MAX_DEPTH} deep")
    _refuse_hidden(path, data)
    return data


def _parse_toml(path: Path, text: str) -> object:
    for match in _KEY.finditer(text):
        if match[0].count(".") > MAX_KEY_PARTS:
            line = text.count("\n", 0, match.start()) + 1
            raise FileError(f"{path}: line {line}: a key has more than {MAX_KEY_PARTS} parts")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        fix = "a key may appear only once in a table" if "overwrite" in str(error) else ""
        fix = fix or ('texts need quotes, e.g. "l1/2"' if "Invalid value" in str(error) else "")
        raise FileError(f"{path}: not valid TOML: {error}{'; ' + fix if fix else ''}") from None
    except (RecursionError, ValueError) as error:
        raise FileError(f"{path}: cannot be read as TOML: {_reason(error)}") from None


def _parse_json(path: Path, text: str) -> object:
    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        table: dict[str, Any] = {}
        for key, value in pairs:
            if key in table:
                raise FileError(
                    f"{path}: the key {key!r} appears twice in one object; keep one of them"
                )
            table[key] = value
        return table

    try:
        return json.loads(text, object_pairs_hook=unique)
    except json.JSONDecodeError as error:
        raise FileError(
            f"{path}: not valid JSON: {error.msg} (at line {error.lineno}, column {error.colno})"
        ) from None
    except (RecursionError, ValueError) as error:
        raise FileError(f"{path}: cannot be read as JSON: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    return "nested too deep" if isinstance(error, RecursionError) else str(error)


def _depth(data: dict | list) -> int:
    """Maximum nesting depth, computed without recursion."""
    level, depth = [data], 0
    while level and depth <= MAX_DEPTH:
        depth += 1
        level = [
            child
            for item in level
            for child in (item.values() if isinstance(item, dict) else item)
            if isinstance(child, (dict, list))
        ]
    return depth


def _refuse_hidden(path: Path, data: dict | list) -> None:
    """Refuse names and texts with hidden characters."""
    pending: list[tuple[tuple[str | int, ...], dict | list]] = [((), data)]
    while pending:
        keys, item = pending.pop()
        for key, child in item.items() if isinstance(item, dict) else enumerate(item):
            where = (*keys, key)
            for text in (key, child):
                if isinstance(text, str) and not text.isprintable():
                    plain_text(text, f"{path}: {key_path(*where)}")
            if isinstance(child, (dict, list)):
                pending.append((where, child))


_NODE = re.compile(r"\b(\w+)\.mesh_nodes(\d+)\b")


def with_present_names(data: dict[str, Any]) -> dict[str, Any]:
    """The data of a model file with ``mesh.mesh_nodes3`` of older files as ``mesh_nodes[3]``."""
    meshes = data.get("meshes")
    return _renamed(data, meshes) if isinstance(meshes, dict) else data


def _renamed(entry: Any, meshes: dict[str, Any]) -> Any:
    if isinstance(entry, dict):
        return {_renamed(key, meshes): _renamed(value, meshes) for key, value in entry.items()}
    if isinstance(entry, list):
        return [_renamed(value, meshes) for value in entry]
    if not isinstance(entry, str):
        return entry
    return _NODE.sub(lambda m: f"{m[1]}_nodes[{m[2]}]" if m[1] in meshes else m[0], entry)
