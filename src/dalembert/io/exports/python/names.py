"""Names of the variables and modules of a script."""

from __future__ import annotations

import builtins
import keyword
import re
import unicodedata

MODULES = {
    "math": "import math",
    "np": "import numpy as np",
    "Path": "from pathlib import Path",
    "da": "import dalembert as da",
    **{
        name: f"from dalembert import {name}"
        for name in ("blocks", "curves", "laws", "planar", "rotation", "spatial", "structures")
    },
}
"""Name in a script → its import."""
TAKEN = {*MODULES, *keyword.kwlist, *dir(builtins), "HERE", "system", "model", "build", "analyse"}
_USE = re.compile(rf"(?<![\w.\"])({'|'.join(MODULES)})(?=[.(])")


class Variables:
    """Variables of named things; a name that is taken gets an ending."""

    def __init__(self) -> None:
        self.names: dict[tuple[str, str], str] = {}
        self.used: set[str] = set()
        """Variables that are read."""

    def assign(self, kind: str, name: str, ending: str) -> str:
        """The variable of a new thing.

        Parameters
        ----------
        kind : ``value`` or ``part``, whose names are separate
        name : in the file; a point of the ground is ``ground.name``
        ending : of the variable where its name is taken
        """
        short = name.removeprefix("ground.")
        plain = re.sub(r"\W", "_", unicodedata.normalize("NFKC", short))
        plain = plain if plain.isidentifier() else f"_{plain}"
        taken = TAKEN | set(self.names.values())
        free = plain if plain not in taken else f"{plain}_{ending}"
        number = 2
        while free in taken:
            free, number = f"{plain}_{ending}{number}", number + 1
        self.names[kind, name] = free
        return free

    def read(self, kind: str, name: str) -> str:
        """The variable of a thing that exists.

        Raises
        ------
        KeyError
            There is none.
        """
        variable = self.names[kind, name]
        self.used.add(variable)
        return variable


def imports(text: str) -> list[str]:
    """Import lines of the modules that a script uses, in three groups."""
    used = {match[1] for match in _USE.finditer(text)} | {"da"}
    own = [MODULES[name] for name in MODULES if name in used and "dalembert" in MODULES[name]]
    parts = ", ".join(line.rpartition(" ")[2] for line in own[1:])
    groups = [
        [MODULES[name] for name in ("math", "Path") if name in used],
        [MODULES["np"]] if "np" in used else [],
        [own[0], *([f"from dalembert import {parts}"] if parts else [])],
    ]
    return "\n\n".join("\n".join(group) for group in groups if group).split("\n")
