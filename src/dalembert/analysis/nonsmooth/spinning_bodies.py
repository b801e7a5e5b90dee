"""Warning about bodies that spin fast in contact.

Impulses ``P`` of a step have the levers ``ρ`` about the mass centre at its start, which change with
the attitude by ``Δρ``. The change of the angular momentum is therefore wrong by ``½ Σ Δρ × P``,
which is zero for a ball about its middle, and by ``((1−θ) h ω)²/2`` of a torque normal to the spin.

These errors drive the nutation of a body that rolls or spins in contact, which grows by about
``exp(½ Σ (h ω)²)`` over the steps, of first order in the step.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.contact_step import APART, ContactStep
from dalembert.elements.spatial.body import Body
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.symbolic.formulas.expression import Expression

SHARE, LEAST = 0.05, 1e-4
"""Sums of the errors, relative to the sum of the torques, that cause a warning, and below which
levers do not change [-]."""
GROWTH = 1.0
"""Sum ``Σ (h ω)²`` over the steps in contact that causes a warning [-]."""
SAMPLES = 200
"""Upper limit of the number of steps whose errors are evaluated for a body."""


def spin_warnings(step: ContactStep, record: ContactRecord) -> list[str]:
    """Warning about a run in which the angular momentum of a body changes by wrong torques."""
    bodies = [body for body in step.model.bodies if isinstance(body, Body) and body.rotates]
    if not bodies or not record.key.size:
        return []
    h = np.diff(record.t)
    spins = _values(step, record, [body.spin for body in bodies])[..., :-1]
    turns = h * np.linalg.norm(spins, axis=1)
    fast = np.flatnonzero((turns**2).sum(axis=1) > GROWTH)
    fast = np.union1d(fast, np.flatnonzero(turns.max(axis=1) / 2 > SHARE))  # bounds the errors
    if not fast.size:
        return []
    names = [bodies[k].name for k in fast]
    centers = _values(step, record, [bodies[k].origin for k in fast])
    levers, turned, torques, pressed = _torques(step, record, names, centers, turns[fast])
    errors = np.stack([levers, levers + turned * (1 - step.scheme.theta) ** 2 / 2])
    levers, shares = np.divide(errors, torques, out=np.zeros_like(errors), where=torques > 0)
    repeats = np.unique(record.step).size / max(int(pressed.any(axis=0).sum()), 1)
    growth = repeats * np.where(pressed, turns[fast] ** 2, 0.0).sum(axis=1)
    growth[levers < LEAST] = 0.0
    excess = np.maximum(shares / SHARE, growth / GROWTH)
    worst = int(np.argmax(excess))
    if not excess[worst] > 1:
        return []
    turn = float(turns[fast[worst], pressed[worst]].max())
    shorter = 0.95 * float(h.max()) / float(excess[worst])
    return [
        f"{names[worst]} turns by up to {turn:.2g} rad per step in contact: torques are wrong by "
        f"{100 * shares[worst]:.2g} % in the mean, and nutation grows by a factor of about "
        f"{np.exp(min(growth[worst], 200) / 2):.2g}; use step={shorter:.2g} or shorter"
    ]


def _torques(
    step: ContactStep,
    record: ContactRecord,
    names: list[str],
    centers: np.ndarray,
    turns: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(b,) sums of the errors by levers, of the torques times ``(h ω)²``, and of the torques over
    some steps, and (b, K) mask of those of these steps in which contacts of a body press."""
    levers, turned, torques = np.zeros((3, len(names)))
    pressed = np.zeros((len(names), record.loss.size), dtype=bool)
    used = np.unique(record.step)
    if used.size > SAMPLES:
        used = used[np.linspace(0, used.size - 1, SAMPLES).astype(int)]
    for k in used:
        rows = slice(*np.searchsorted(record.step, [k, k + 1]))
        bodies, points, push = _acting(step, record, int(k), rows)
        for b, name in enumerate(names):
            side = (bodies == name) @ [-1.0, 1.0]
            if not side.any():
                continue
            arms = points - centers[b, :, k : k + 2].T[:, None]
            own = np.cross(arms, side[:, None] * push).sum(axis=1)
            pressed[b, k] = True
            size = np.linalg.norm(own[0])
            levers[b] += np.linalg.norm(own[1] - own[0]) / 2
            turned[b] += turns[b, k] ** 2 * size
            torques[b] += size
    return levers, turned, torques, pressed


def _acting(
    step: ContactStep, record: ContactRecord, k: int, rows: slice
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(n, 2) bodies of the contacts of a step, (2, n, 3) their points at its start and at its end,
    and (n, 3) impulses on the second bodies."""
    keys, impulses = record.key[rows], record.impulse[rows]
    bodies = np.full((keys.size, 2), "", dtype=object)
    points, push = np.zeros((2, keys.size, 3)), np.zeros((keys.size, 3))
    for number, source in enumerate(step.sources):
        own = keys // APART == number
        if not own.any():
            continue
        bodies[own] = source.bodies(keys[own] % APART)
        for end in (1, 0):
            at = step.at(float(record.t[k + end]), record.ends.y[:, k + end])
            points[end, own], axes = source.points(at, keys[own] % APART)
        push[own] = (axes @ impulses[own, : axes.shape[2], None])[..., 0]
    unknown = ~np.isfinite(points).all(axis=(0, 2))
    points[:, unknown], push[unknown] = 0.0, 0.0
    return bodies, points, push


def _values(step: ContactStep, record: ContactRecord, vectors: list[ca.SX]) -> np.ndarray:
    """(b, 3, K+1) vectors at the ends of the steps."""
    function, s = step.model.function(Expression(ca.vertcat(*vectors))), record.ends
    p = np.tile(step.p[:, None], s.t.size)
    forces = s.forces(function.size1_in(4))
    values = np.asarray(function.map(s.t.size)(s.t[None], s.y, s.v, s.a, forces, p))
    return values.reshape(len(vectors), 3, s.t.size)
