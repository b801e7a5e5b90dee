"""``dalembert cache``: the machine code cached on disk."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from dalembert.cli.console import DONE, AsJson, print_json, print_line


def cache(
    *,
    clear: Annotated[bool, Parameter(negative=())] = False,
    as_json: AsJson = False,
) -> int:
    """Show location, number and size of the cached compiled functions, or delete them.

    Parameters
    ----------
    clear
        Delete them; they are compiled again when needed.
    """
    from dalembert.symbolic.native.code_cache import cache_folder, cache_size, clear_cache

    folder, (count, size) = cache_folder(), cache_size()
    if clear:
        count = clear_cache()
    if as_json:
        print_json(
            {"ok": True, "folder": str(folder), "functions": count, "bytes": size, "clear": clear}
        )
    else:
        print_line(
            f"{count} compiled functions, {size / 1e6:.1f} MB, {'deleted from' if clear else 'in'}"
        )
        print_line(f"  {folder}")
    return DONE
