"""``dalembert cache``: the machine code that is kept on disk."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from dalembert.cli.console import DONE, AsJson, emit, tell


def cache(
    *,
    clear: Annotated[bool, Parameter(negative=())] = False,
    as_json: AsJson = False,
) -> int:
    """Show where compiled functions are kept, how many and how large; or delete them.

    Parameters
    ----------
    clear
        Delete them; they are made again when needed.
    """
    from dalembert.symbolic.native.code_cache import cache_folder, cache_size, clear_cache

    folder, (count, size) = cache_folder(), cache_size()
    if clear:
        count = clear_cache()
    if as_json:
        emit({"ok": True, "folder": str(folder), "functions": count, "bytes": size, "clear": clear})
    else:
        tell(
            f"{count} compiled functions, {size / 1e6:.1f} MB, {'deleted from' if clear else 'in'}"
        )
        tell(f"  {folder}")
    return DONE
