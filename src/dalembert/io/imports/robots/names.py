"""Names of a model file from names of another format."""

from __future__ import annotations

import keyword
import re
from functools import cache

from dalembert.elements.spatial.body import Body
from dalembert.model.system import System
from dalembert.symbolic.formulas.functions import FORMULA_FUNCTIONS

LONGEST = 100
"""Upper limit of the length of a name."""


class Names:
    """Unique valid names, similar to the original ones.

    Parameters
    ----------
    reserved : names that are in use already
    """

    def __init__(self, reserved: set[str]):
        self.used = set(reserved)

    @classmethod
    def of_parts(cls) -> Names:
        """Names of bodies, joints, forces and inputs."""
        return cls({*System.reserved, *System.meanings, *FORMULA_FUNCTIONS})

    @classmethod
    def of_frames(cls) -> Names:
        """Names of frames of a body, which are not names of its measures."""
        return cls(_of_body())

    def add(self, original: str, ending: str = "") -> str:
        """A name for an original one, which is used from now on.

        Parameters
        ----------
        ending : for names that are used by another kind of part
        """
        name = _identifier(original)
        if name in self.used and ending:
            name = f"{name}_{ending}"
        base, number = name, 1
        while name in self.used:
            number += 1
            name = f"{base}_{number}"
        self.used.add(name)
        return name


@cache
def _of_body() -> set[str]:
    """Names of the attributes and measures of a body."""
    body = Body("body", mass=1.0, inertia=(1.0, 1.0, 1.0))
    return {*dir(body), *body.measures()}


def _identifier(text: str) -> str:
    """Letters, digits and underscores, beginning with a letter."""
    name = re.sub(r"\W+", "_", text)[:LONGEST].strip("_") or "part"
    if name[0].isdigit() or not name.isidentifier():
        name = f"n{name}"
    if not name.isidentifier():
        name = "".join(c if f"n{c}".isidentifier() else "_" for c in name)
    return f"{name}_" if keyword.iskeyword(name) else name
