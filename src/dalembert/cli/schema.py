"""``dalembert schema``: the JSON Schema of model files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from dalembert.cli.console import DONE, AsJson, emit, tell, wrong_input

JSON = "With --output, tell what was written as JSON; the schema itself always is JSON."


def schema(
    *,
    kind: Literal["mechanism", "structure"] | None = None,
    output: Path | None = None,
    as_json: Annotated[AsJson, Parameter(help=JSON)] = False,
) -> int:
    """Print the JSON Schema of model files, for editors that complete and check them.

    Parameters
    ----------
    kind
        Of mechanisms or structures only; both by default.
    output
        Write it to this file instead.
    """
    from dalembert.files import atomic_path
    from dalembert.io.json_schema import json_schema

    made = json_schema(kind)
    if output is None:
        emit(made)
        return DONE
    with wrong_input(), atomic_path(output) as temporary:
        temporary.write_text(json.dumps(made, indent=2) + "\n", encoding="utf-8")
    if as_json:
        emit({"ok": True, "files": [str(output)]})
    else:
        tell(f"written {output}")
    return DONE
