"""DXF drawings of positions, read back by ezdxf."""

from __future__ import annotations

from pathlib import Path

import ezdxf
import numpy as np
import pytest
from registry import CASES, model_of

import dalembert as da

EXAMPLES = Path(__file__).parents[1] / "examples"


def test_bodies_pins_and_traces_of_a_motion(tmp_path):
    model = da.load_model(EXAMPLES / "four_bar.toml").build()
    motion = da.solve_dynamics(model, 0.5, step=0.01)
    path = da.export(motion, tmp_path / "bar.dxf", time=0.25, trace=["coupler.end"]).files[0]
    document = ezdxf.readfile(path)
    assert not document.audit().errors and document.header["$INSUNITS"] == 4
    space, at = document.modelspace(), motion.at([0.25])
    (crank,) = space.query('LINE[layer=="crank"]')
    ends = np.array([crank.dxf.start, crank.dxf.end])[:, :2] / 1000
    expected = np.array([at[f"crank.{end}.position"].values[0] for end in ("start", "end")])
    gap = min(np.abs(ends - expected).max(), np.abs(ends[::-1] - expected).max())
    assert gap < 1e-9
    assert len(space.query('CIRCLE[layer=="ground"]')) == 2
    assert len(space.query('LWPOLYLINE[layer=="construction_traces"]')) == 1


@pytest.mark.few(12)
@pytest.mark.parametrize("name", CASES)
def test_every_planar_case_is_drawn_and_spatial_ones_name_a_body(name, tmp_path):
    model = model_of(name)
    spatial = [body.name for body in model.bodies if body.dimension == 3]
    if spatial:
        with pytest.raises(da.UnsupportedError, match=f"{spatial[0]!r} is a spatial body"):
            da.export(model, tmp_path / "x.dxf")
        return
    path = da.export(model, tmp_path / "x.dxf", unit="m").files[0]
    assert not ezdxf.readfile(path).audit().errors
