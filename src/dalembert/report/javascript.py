"""Exported modules as JavaScript: an ES module, its types and an example page.

The ES module contains the WebAssembly code and the scripts that call it, and makes no request. All
its functions take and return SI units.
"""

from __future__ import annotations

import html
import json
from collections.abc import Mapping
from typing import Any

from dalembert.report.scripts import RUNS, asset, joined
from dalembert.text.wording import visible


def javascript_files(data: Mapping[str, Any], name: str) -> dict[str, str]:
    """File → text of the ES module, its types and an example page.

    Parameters
    ----------
    data : of the module, see ``Module.data``
    name : of the files, without suffix
    """
    module = _module(data)
    page = asset("export/page.html").replace("{{title}}", html.escape(visible(data["name"])))
    page = page.replace("{{file}}", html.escape(name)).replace("{{module}}", module)
    return {f"{name}.js": module, f"{name}.d.ts": _types(data), f"{name}.html": page}


def _module(data: Mapping[str, Any]) -> str:
    """Text of the ES module."""
    live = {key: value for key, value in data["live"].items() if key != "exact"}
    constants = dict(data) | {"live": json.loads(data["live"]["exact"]) | live}
    script, run = RUNS[constants["live"]["kind"]]
    parts = (
        f"// {_line(data['name'])}: simulate(parameters), evaluate(response, parameters) and",
        "// gradient(response, parameters), with all mechanics as WebAssembly; SI units.",
        joined("module.js", script),
        f"const DATA = {_plain(constants)};\n",
        asset("export/functions.js").replace("{{RUN}}", run),
    )
    return "\n".join(parts)


def _plain(value: Any) -> str:
    """JSON that is safe inside a script element."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c")


def _types(data: Mapping[str, Any]) -> str:
    """Text of the declarations."""
    parameters = [
        f"  /** {_about(row)} */\n  {_key(row['name'])}: number;" for row in data["parameters"]
    ]
    measures = [
        f"  /** {_unit(unit)} */\n  {_key(measure)}: Float64Array;"
        for measure, unit, _ in data["measures"]
    ]
    labels = " | ".join(_key(row["label"]) for row in data["responses"]) or "never"
    text = asset("export/types.d.ts")
    replaced = {
        "NAME": _line(data["name"]),
        "PARAMETERS": "\n".join(parameters),
        "MEASURES": "\n".join(measures),
        "RESPONSES": labels,
    }
    for word, inserted in replaced.items():
        text = text.replace(f"{{{{{word}}}}}", inserted)
    return text


def _about(row: Mapping[str, Any]) -> str:
    """Description, value, unit and bounds of a parameter."""
    unit = _unit(row["unit"])
    bounds = [
        f"{word} {row[key]:g}"
        for key, word in (("lower", "at least"), ("upper", "at most"))
        if row[key] is not None
    ]
    first = f"{row['description']}: " if row["description"] else ""
    return _line(f"{first}{row['value']:g} {unit}{''.join(f', {bound}' for bound in bounds)}")


def _unit(unit: str) -> str:
    return f"[{_line(unit)}]" if unit and unit != "1" else "[-]"


def _line(text: str) -> str:
    """A text inside a comment of one line."""
    return visible(text).replace("*/", "* /").replace("\n", " ").replace("<", "‹")


def _key(name: str) -> str:
    """A name as a property or a literal type."""
    return _plain(name)
