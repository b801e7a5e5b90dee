"""Scripts of the studio without a browser."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

from browser import missing

HERE = Path(__file__).parent
ASSETS = HERE.parent / "src/dalembert/studio/assets"


def drawn_by(script: str, folder: Path, *arguments: str) -> Any:
    """What a script prints that draws with the scripts of the studio."""
    node = shutil.which("node") or missing("node")
    shutil.copytree(ASSETS, folder / "assets", ignore=shutil.ignore_patterns("*.png", "vendor"))
    (folder / "assets" / "package.json").write_text('{"type": "module"}')
    command = [str(node), str(HERE / script), (folder / "assets").as_uri(), *arguments]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
