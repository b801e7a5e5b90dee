"""``dalembert schema``: the JSON Schema of model files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from dalembert.cli.console import DONE, AsJson, print_json, print_line, wrong_input

JSON = "With --output, report the written file as JSON; the schema itself is always JSON."


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
        Only mechanisms or only structures; both by default.
    output
        Write it to this file instead.
    """
    from dalembert.files import atomic_path
    from dalembert.io.documents import json_schema

    document = json_schema(kind)
    if output is None:
        print_json(document)
        return DONE
    with wrong_input(), atomic_path(output) as temporary:
        temporary.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    if as_json:
        print_json({"ok": True, "files": [str(output)]})
    else:
        print_line(f"written {output}")
    return DONE
