"""Small pictures of the examples for the studio: ``python docs/example_pictures.py``."""

from __future__ import annotations

import warnings
from pathlib import Path

import matplotlib as mpl
from PIL import Image

mpl.use("Agg")

import dalembert as da
from dalembert.errors import DalembertError
from dalembert.io.example_files import example_folder
from dalembert.io.model_file import load_model_file
from dalembert.results.pictures.animation import write_still
from dalembert.studio.pictures import result_of

FOLDER = Path(__file__).parents[1] / "src" / "dalembert" / "studio" / "assets" / "examples"
SIZE = (240, 160)
"""Width and height [pixels]."""
SHARE = 0.15
"""Instant as a fraction of the motion."""


def draw(path: Path) -> None:
    """Write the picture of one example."""
    file = load_model_file(path)
    model = file.model()
    target = FOLDER / f"{path.stem}.png"
    try:
        write_still(result_of(file, model).page(), target, SHARE, dpi=75, plain=True)
    except DalembertError:  # modes of a mechanism
        motion = da.solve_dynamics(model, 1e-3, step=1e-3)
        write_still(motion.page(), target, dpi=75, plain=True)
    image = Image.open(target).convert("RGBA")
    image = image.crop(image.getbbox() or (0, 0, *image.size))
    image.thumbnail(SIZE, Image.Resampling.LANCZOS)
    image.quantize(32).save(target, optimize=True)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    warnings.simplefilter("ignore")
    for example in sorted(example_folder().glob("*.toml")):
        draw(example)
