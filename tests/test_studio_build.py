"""A four-bar from nothing: drawn, optimised and saved in a browser."""

from __future__ import annotations

import itertools
import time

import numpy as np
from studio_build import FREE, build
from studio_desk import Desk
from studio_runs import Studio

import dalembert as da
from dalembert.errors import DalembertError


def test_a_four_bar_is_drawn_optimised_and_saved(
    desk: tuple[Desk, Studio],
) -> None:
    visit, studio = desk
    path = studio.folder / "four_bar.toml"
    begin = time.monotonic()
    build(visit, path)
    assert time.monotonic() - begin < 120  # two minutes
    model = da.load_model(path).build()
    assert model.diagnosis.degrees_of_freedom == 1
    names = [f"{bar}_length" for bar in FREE]
    bounds = [model.parameters[name].bounds for name in names]
    saved = [model.parameters[name].value for name in names]

    def highest(design: tuple[float, ...]) -> float:
        """Maximum of the angle of the rocker; infinite where the linkage does not turn."""
        values = dict(zip(names, design, strict=True))
        try:
            motion = da.solve_kinematics(model, 3.0, outputs=151, parameters=values)
        except DalembertError:
            return np.inf
        return float(motion["bar3.angle"].max()) if motion.status.success else np.inf

    grid = itertools.product(*(np.linspace(*ends, 5) for ends in bounds))
    assert highest(tuple(saved)) <= min(map(highest, grid)) + 1e-3
    for _ in range(12):
        if not visit.js("studio.file.undo"):
            break
        visit.press("Control+z")
    assert "bodies" not in visit.text
