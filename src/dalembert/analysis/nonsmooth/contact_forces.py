"""Positions and forces of the contacts of a run at an output."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import APART
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.results.contact_forces import ContactForces
from dalembert.results.nonsmooth_motion import NonsmoothMotion


def contact_forces(motion: NonsmoothMotion, row: int) -> ContactForces:
    """Contacts of the step that ends at or contains the output ``row``.

    Features of bodies are those of the step, their positions those of the output.
    """
    record, model = motion.record, motion.model
    t, d = float(motion.time[row]), max((body.dimension for body in model.bodies), default=2)
    slack = 1e-12 * max(abs(record.t[0]), abs(record.t[-1]))
    step = int(np.searchsorted(record.t, t - slack)) - 1
    acting = np.flatnonzero(record.step == step)
    key, impulse = record.key[acting], record.impulse[acting]
    places = np.full((acting.size, 3), np.nan)
    forces = np.zeros((acting.size, 3))
    for number, source in enumerate(gap_sources(model)):
        own = key // APART == number
        if own.any():
            at = Configuration(t, motion.trajectory.y[:, row], motion.parameters)
            places[own], axes = source.points(at, key[own] % APART)
            mean = impulse[own, : axes.shape[2]] / (record.t[step + 1] - record.t[step])
            forces[own] = (axes @ mean[:, :, None])[..., 0]
    located = np.isfinite(places).all(axis=1)
    names = np.array(record.names)[record.owner[acting]]
    return ContactForces(names[located], key[located], places[located, :d], forces[located, :d])
