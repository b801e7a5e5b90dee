"""Every file that the package writes appears whole: it is written inside ``atomic_path``."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "dalembert"
WRITERS = {
    *("write_text", "write_bytes", "to_csv", "to_parquet", "to_netcdf", "to_json", "write_table"),
    *("savefig", "copyfile", "copy2", "touch", "savetxt", "savez", "tofile", "create_file"),
}
"""Methods and functions that write a file, but for ``open`` and ``save`` of a film."""
OPENERS = {"open", "File", "Dataset", "NetCDFFile", "netcdf_file"}
"""Methods and functions that write a file by some of their modes."""
CALL = re.compile(rf"\b({'|'.join(sorted(WRITERS | OPENERS))})\s*\(")
"""A call of one of them; files without any need no syntax tree."""
OTHERS = {
    "files.py": "the one place",
    "design/optimize/evaluation_log.py:open": "a log, which grows by lines; half a line is skipped",
    "results/files/store.py:File": "writes to the temporary path of the same module",
    "results/files/inspection.py:open": "appends the checksum to a file that `store` writes",
    "fmu/archive.py:write_bytes": "sources for the compiler, in a temporary folder",
    "io/exports/parquet.py:write_table": "writes to memory",
    "symbolic/native/llvm.py:write_bytes": "called by `code_cache.build`, inside `atomic_path`",
    "symbolic/native/webassembly.py:write_bytes": "called by `code_cache`, inside `atomic_path`",
    "cli/compare.py:to_csv": "the method of Comparison, which is atomic itself",
    "results/result.py:to_csv": "the method of Result, which is atomic itself",
    "studio/exporting.py:to_csv": "the method of Result, which is atomic itself",
}


def _writes(call: ast.Call) -> str:
    """Name of the function, where the call writes a file but to the path of ``atomic_path``."""
    function = call.func
    name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    if name not in WRITERS | OPENERS or "atomic_path(" in ast.unparse(function):
        return ""
    texts = [
        node.value
        for node in (*call.args[:2], *(k.value for k in call.keywords if k.arg == "mode"))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    ]
    modes = [text for text in texts if len(text) < 4 and set(text) <= set("rwaxbt+")]
    if name in OPENERS:
        return name if any(set(mode) & set("wax+") for mode in modes) else ""
    return name


def _outside(node: ast.AST, inside: bool = False) -> Iterator[str]:
    """Calls that write, without an ``atomic_path`` around them."""
    if isinstance(node, ast.With):
        inside = inside or any("atomic_path(" in ast.unparse(item) for item in node.items)
    if isinstance(node, ast.Call) and not inside and (name := _writes(node)):
        yield name
    for child in ast.iter_child_nodes(node):
        yield from _outside(child, inside)


def test_files_are_written_inside_atomic_path():
    places = set()
    for path in SOURCE.rglob("*.py"):
        file = path.relative_to(SOURCE).as_posix()
        if file in OTHERS:
            places.add(file)
            continue
        text = path.read_text("utf-8")
        if CALL.search(text):
            places |= {f"{file}:{name}" for name in _outside(ast.parse(text))}
    assert places == OTHERS.keys()


def test_the_law_sees_what_writes():
    for text in ("p.open('w')", "open(p, mode='ab')", "h5py.File(p, 'w')", "t.to_csv(p)"):
        assert list(_outside(ast.parse(text))), text
        assert not list(_outside(ast.parse(f"with atomic_path(q) as p:\n    {text}"))), text
    assert not list(_outside(ast.parse("open(p); p.open('rb'); s.open('x.html')")))
