"""Warning about bodies that spin fast in contact.

Impulses of a step act in the attitude at its start, in the axes of the body, which turn by ``h ω``
in the step. The direction of a change ``ΔL`` of the angular momentum of a free body is therefore
wrong by half of this turn, an error ``h ω × ΔL/2``. It is zero for a ball that rolls, for example,
and not for one that slides with a spin about the vertical.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.contact_step import APART, ContactStep
from dalembert.elements.spatial.body import Body
from dalembert.elements.spatial.inertia_tensor import tensor
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.symbolic.formulas.expression import Expression

SHARE, LEAST = 0.05, 0.01
"""Sum of the errors relative to the sum of the changes that causes a warning, unless it is below
the other share of the largest angular momentum [-]."""


def spin_warnings(step: ContactStep, record: ContactRecord) -> list[str]:
    """Warning about a run in which the angular momentum of a body changes in a wrong direction."""
    bodies = [body for body in step.model.bodies if isinstance(body, Body) and body.rotates]
    if not bodies or not record.key.size:
        return []
    h = np.diff(record.t)
    local = _values(step, record, [body.spin for body in bodies])
    turns = (h * np.linalg.norm(local[..., :-1], axis=1)).max(axis=1)
    bodies = [body for body, turn in zip(bodies, turns, strict=True) if turn / 2 > SHARE]
    if not bodies:  # no error can exceed half of the turn
        return []
    spin = _values(step, record, [ca.mtimes(body.axes, body.spin) for body in bodies])
    momentum = _values(step, record, [_momentum(body) for body in bodies])
    pressed = _pressed(step, record, [body.name for body in bodies])
    change = np.diff(momentum, axis=-1)
    error = h / 2 * np.linalg.norm(np.cross(spin[..., :-1], change, axis=1), axis=1)
    changes = np.where(pressed, np.linalg.norm(change, axis=1), 0.0).sum(axis=1)
    sums = np.where(pressed, error, 0.0).sum(axis=1)
    sums[sums < LEAST * np.linalg.norm(momentum, axis=1).max(axis=1)] = 0.0
    shares = np.divide(sums, changes, out=np.zeros_like(sums), where=changes > 0)
    worst = int(np.argmax(shares))
    if not shares[worst] > SHARE:
        return []
    turn = float((h * np.linalg.norm(spin[worst, :, :-1], axis=0))[pressed[worst]].max())
    shorter = 0.95 * float(h.max()) * SHARE / float(shares[worst])
    return [
        f"{bodies[worst].name} turns by up to {turn:.2g} rad per step in contact: the changes of "
        f"its angular momentum have directions that are wrong by {shares[worst]:.2g} rad in the "
        f"mean; use step={shorter:.2g} or shorter"
    ]


def _momentum(body: Body) -> ca.SX:
    """Angular momentum of a body about its mass centre, in inertial axes."""
    return ca.mtimes(body.axes, ca.mtimes(tensor(body.inertia.sx), body.spin))


def _values(step: ContactStep, record: ContactRecord, vectors: list[ca.SX]) -> np.ndarray:
    """(b, 3, K+1) vectors at the ends of the steps."""
    function, s = step.model.function(Expression(ca.vertcat(*vectors))), record.ends
    p = np.tile(step.p[:, None], s.t.size)
    forces = s.forces(function.size1_in(4))
    values = np.asarray(function.map(s.t.size)(s.t[None], s.y, s.v, s.a, forces, p))
    return values.reshape(len(vectors), 3, s.t.size)


def _pressed(step: ContactStep, record: ContactRecord, names: list[str]) -> np.ndarray:
    """(b, K) mask of the steps in which a contact of a body presses."""
    mask = np.zeros((len(names), record.loss.size), dtype=bool)
    place = {name: row for row, name in enumerate(names)}
    keys, rows = np.unique(record.key, return_inverse=True)
    for number, source in enumerate(step.sources):
        own = np.flatnonzero(keys // APART == number)
        if not own.size:
            continue
        for k, pair in zip(own, source.bodies(keys[own] % APART), strict=True):
            for name in set(pair) & place.keys():
                mask[place[name], record.step[rows == k]] = True
    return mask
