"""Validity range of elastic bodies in batches: the designs with the largest deformations."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.batch.states import States
from dalembert.analysis.elastic_range import coordinates_of, elastic_warnings, strains_of
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory
from dalembert.symbolic.once import once


def elastic_warnings_of_many(states: States) -> list[str]:
    """Warnings of the designs with the largest displacements and strains.

    Parameters
    ----------
    states : of all designs at the outputs; NaN where there is none
    """
    model, known = states.model, np.flatnonzero(np.isfinite(states.x[:, :1, 0]).all(axis=1))
    if not (known.size and states.time.size and (coordinates_of(model) or strains_of(model))):
        return []
    sizes, y = states.evaluate(_sizes(model, states.bodies), known, np.arange(states.time.size))
    largest = np.nanmax(sizes, axis=1, initial=0.0)  # (designs, bodies and beams)
    found = []
    for k in sorted({int(k) for k in np.argmax(largest, axis=0)}):
        none = np.zeros((0, states.time.size))
        of_one = Trajectory(states.time, y[k].T, none, none, none, none)
        told = elastic_warnings(model, of_one, states.p[known[k]])
        found += [f"design {known[k]}: {text}" for text in told]
    return found


@once
def _sizes(model: Model, bodies: ca.Function) -> ca.Function:
    """``(t, x, p) → sizes, y``: of the coordinates of flexible bodies and the strains of beams."""
    t, x, p = bodies.sx_in()
    y = bodies.call([t, x, p])[0]
    bent = [ca.norm_inf(function(y)) for function in coordinates_of(model)]
    strained = [ca.mmax(function(t, y, p)) for _, function in strains_of(model)]
    return ca.Function("sizes", [t, x, p], [ca.vertcat(*bent, *strained), y], {"cse": True})
