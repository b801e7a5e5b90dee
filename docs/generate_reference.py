"""Generated parts of the documentation.

    python docs/generate_reference.py            rewrites them
    python docs/generate_reference.py --check    reports whether they are up to date

A generated part is between ``<!-- generated: NAME -->`` and ``<!-- end: NAME -->``; the text
around it is written by hand. Element tables come from the registry of elements, other tables from
the classes and the schema of model files, names from ``dalembert.__all__``.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path

from reference.elements import records
from reference.gallery import gallery
from reference.names import api, functions
from reference.sections import FIXED, section

from dalembert.elements.registry import (
    BLOCKS,
    CONTACT_LAWS,
    CONTACT_PAIRS,
    CURVES,
    FRICTIONS,
    LAWS,
    PLANAR,
    SHAPES,
    SPATIAL,
)
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.io.decisions import design_tables
from dalembert.io.strategies import (
    ANALYSES,
    COORDINATES,
    FORMULATIONS,
    INTEGRATORS,
    RESPONSES,
    STABILIZATIONS,
    STRATEGIES_OF,
)

DOCS = Path(__file__).parent
ROOT = DOCS.parent

PARTS: dict[str, Callable[[], str]] = {
    **{name: (lambda pair=pair: section(*pair)) for name, pair in FIXED.items()},
    "bodies": lambda: records(PLANAR.sections["bodies"]),
    "beams": lambda: records(PLANAR.sections["beams"]),
    "joints": lambda: records(PLANAR.sections["joints"]),
    "drivers": lambda: records(PLANAR.sections["drivers"]),
    "forces": lambda: records(PLANAR.sections["forces"]),
    **{
        f"spatial_{name}": (lambda name=name: records(SPATIAL.sections[name], "####"))
        for name in SPATIAL.sections
    },
    "blocks": lambda: records(BLOCKS),
    "laws": lambda: records(LAWS),
    "curves": lambda: records(CURVES),
    "shapes": lambda: records(SHAPES[2], "####"),
    "spatial_shapes": lambda: records(SHAPES[3], "####"),
    "contact_pairs": lambda: records(CONTACT_PAIRS, "####"),
    "contact_laws": lambda: records(CONTACT_LAWS, "####"),
    "frictions": lambda: records(FRICTIONS, "####"),
    "analyses": lambda: records(ANALYSES),
    "coordinates": lambda: records(COORDINATES),
    "formulations": lambda: records(FORMULATIONS),
    "stabilizations": lambda: records(STABILIZATIONS),
    "integrators": lambda: records(INTEGRATORS),
    "contact_schemes": lambda: records(STRATEGIES_OF[ContactScheme] | STRATEGIES_OF[ContactSolver]),
    "responses": lambda: records(RESPONSES),
    "distributions": lambda: records(
        {n: design_tables.distribution(n) for n in design_tables.DISTRIBUTIONS}, "###"
    ),
    "functions": functions,
    "api": api,
    "gallery": gallery,
}
BLOCK = re.compile(r"<!-- generated: (\w+) -->\n.*?<!-- end: \1 -->", re.DOTALL)


def renewed(text: str) -> str:
    """A page with new generated parts."""
    return BLOCK.sub(
        lambda m: f"<!-- generated: {m[1]} -->\n\n{PARTS[m[1]]()}\n\n<!-- end: {m[1]} -->", text
    )


def stale(write: bool = False) -> list[Path]:
    """Pages with generated parts that are out of date."""
    outdated = []
    for page in sorted(DOCS.glob("*.md")):
        old = page.read_text(encoding="utf-8")
        new = renewed(old)
        if new != old:
            outdated.append(page)
            if write:
                page.write_text(new, encoding="utf-8")
    return outdated


def main(arguments: list[str]) -> int:
    check = "--check" in arguments
    pages = stale(write=not check)
    for page in pages:
        print(f"{'out of date' if check else 'renewed'}: {page.relative_to(ROOT)}")
    return int(check and bool(pages))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
