"""Positions and forces of the contacts of a run at an output."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.gap_source import GapSource
from dalembert.analysis.nonsmooth.gaps.model_gaps import APART
from dalembert.elements.contact.collisions import Collisions
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
    bodies = np.full((acting.size, 2), "", dtype=object)
    for number, source in enumerate(gap_sources(model)):
        own = key // APART == number
        if own.any():
            at = Configuration(t, motion.trajectory.y[:, row], motion.parameters)
            places[own], axes = source.points(at, key[own] % APART)
            mean = impulse[own, : axes.shape[2]] / (record.t[step + 1] - record.t[step])
            forces[own] = (axes @ mean[:, :, None])[..., 0]
            bodies[own] = source.bodies(key[own] % APART)
            swapped = own.copy()
            swapped[own] = _swapped(source, bodies[own])
            bodies[swapped], forces[swapped] = bodies[swapped, ::-1], -forces[swapped]
    located = np.isfinite(places).all(axis=1)
    names = np.array(record.names)[record.owner[acting]]
    contacts = ContactForces(names, bodies.astype(str), key, places[:, :d], forces[:, :d])
    return contacts.some(located)


def _swapped(source: GapSource, bodies: np.ndarray) -> np.ndarray:
    """Mask of pairs whose second body precedes the first one in the order of the contacts."""
    shapes = [s for e in source.elements if isinstance(e, Collisions) for s in e.members]
    order = dict.fromkeys(["ground", *(shape.carrier.name for shape in shapes), ""])
    rank = {name: k for k, name in enumerate(order)}
    ranks = np.array([rank[name] for name in bodies.ravel()], dtype=int).reshape(-1, 2)
    mask: np.ndarray = ranks[:, 0] > ranks[:, 1]
    return mask
