"""Live pages that the documentation embeds, written with the site."""

from __future__ import annotations

import re
from pathlib import Path

from dalembert.cli import main

DOCS = Path(__file__).parent
EXAMPLES = DOCS.parent / "examples"
SHOWN = ("four_bar", "n_four_bar", "quick_return_shaper", "truss")
"""Examples that chapters embed, besides the teaching models."""
FIRST = re.compile(r"^```toml\n(# (slider_crank)\.toml\n.*?)^```$", re.DOTALL | re.MULTILINE)
"""Model file of the first mechanism, as ``start.md`` prints it."""


def write(folder: Path) -> None:
    """Write the pages of the first mechanism, of the embedded examples and of teaching models."""
    folder.mkdir(parents=True, exist_ok=True)
    match = FIRST.search((DOCS / "start.md").read_text(encoding="utf-8"))
    assert match is not None, "start.md has no model slider_crank.toml"
    first = folder / f"{match[2]}.toml"
    first.write_text(match[1], encoding="utf-8")
    shown = [EXAMPLES / f"{name}.toml" for name in SHOWN]
    for model in (first, *shown, *sorted((EXAMPLES / "teaching").glob("*.toml"))):
        options = ["--live", "--quiet", "--output", str(folder)]
        assert main(["run", str(model), *options]) == 0, model
        (folder / f"{model.stem}.nc").unlink()
        (folder / f"{model.stem}.report.html").replace(folder / f"{model.stem}.html")
    first.unlink()
