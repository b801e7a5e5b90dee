"""Derivatives of the instants at which contacts with static friction break away.

Contacts with static friction slip with ``μ < μ_s`` from the instant ``t*`` of their limit load.
Before it, they would accelerate the bodies by ``a_s`` against the motion that begins, with speeds
``u``, if they slipped in its directions with ``μ_s``. The limit load is that of

    f = uᵀ M a_s = 0,      dt* = −df/ḟ

in which forces of redundant contacts that balance each other do no work. Accelerations jump from
``a⁻`` to ``a⁺``, so that

    dv⁺ = dv⁻ + (a⁻ − a⁺) dt*

(jump of the sensitivities: Hiskens and Pai 2000), to the order of the step. Contacts on connected
bodies that break away in one step do so together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.impact_groups import connected
from dalembert.sensitivity.nonsmooth.linear_map import MapAt
from dalembert.sensitivity.nonsmooth.triplets import by_rows

LATEST = 3.0
"""Upper limit of the time until a load that grows evenly breaks contacts away, in steps [-]."""
STILL = 1e-6
"""Upper limit of the change of speeds in a step without motion, relative to that without contacts
[-]."""


@dataclass(frozen=True, eq=False)
class BreakAways:
    """Contribution of contacts that break away after a step to the changes of its end.

    Attributes
    ----------
    limits : map of the last step in which they stick, if they slip with static friction
    loads : (n_v, groups) derivatives of ``f`` by the changes of the speeds in it, ``M u/h``
    jumps : (n_x, groups) derivatives of the state at the end of the step by the instants
    rates : (groups,) ``ḟ``
    """

    limits: MapAt
    loads: np.ndarray
    jumps: np.ndarray
    rates: np.ndarray

    @property
    def count(self) -> int:
        """Number of instants."""
        return self.rates.size

    @property
    def _speeds(self) -> slice:
        """Speeds among the entries of the state."""
        return slice(self.jumps.shape[0] - self.loads.shape[0], self.jumps.shape[0])

    def push(self, dq: np.ndarray) -> np.ndarray:
        """Change of the state at the end."""
        change = self.limits.change(dq)[: self.loads.shape[0]] - dq[self._speeds]
        return self.jumps @ (-(self.loads.T @ change) / self.rates[:, None])

    def pull(self, weights: np.ndarray) -> np.ndarray:
        """Weights of ``q``."""
        own = self.loads @ (-(self.jumps.T @ weights) / self.rates[:, None])
        z_bar = np.zeros((self.limits.z.size, weights.shape[1]))
        z_bar[: own.shape[0]] = own
        pulled = self.limits.weights(z_bar)
        pulled[self._speeds] -= own
        return pulled


def break_aways(steps: ContactSteps, k: int, step_map: MapAt) -> BreakAways | None:
    """Contacts that break away after step ``k``; None without any.

    Raises
    ------
    UnsupportedError
        The load of a contact does not grow evenly until it breaks away.
    """
    keys, contacts = steps.breaks.get(k), step_map.contacts
    if keys is None or contacts is None:
        return None
    (t, h), end, v = steps.span(k), steps.x[:, k + 1], steps.x[steps.size :]
    lasting = steps.active(k).some(np.isin(steps.active(k).keys, steps.active(k + 1).keys))
    stuck, alone = steps.accelerations(end, t + h, h, lasting)
    labels, moved = connected(steps, k, contacts)
    broken, rows, modes, jumps = np.isin(contacts.keys, keys), [], [], []
    for label in np.unique(labels[broken]):
        mode = (v[:, k + 2] - v[:, k + 1]) * (moved[labels == label].sum(axis=0) > 0)
        if np.abs(mode).max() > STILL * h * np.abs(alone).max():
            rows.append(np.flatnonzero(broken & (labels == label)))
            own = contacts.keys[rows[-1]]
            slipping = steps.acceleration(end, t + h, h, lasting, own)
            modes.append(mode / np.linalg.norm(mode))
            jumps.append(np.concatenate([np.zeros(steps.size), stuck - slipping]))
    if not modes:
        return None
    moving = contacts.keys[np.concatenate(rows)]
    even = k > 0 and np.isin(moving, steps.active(k - 1).keys).all()
    if even:
        slips = _slips(steps, k + 1, moving), np.array(modes)
        limits, loads, force = _limit_load(steps, k, *slips)
        growth = force - _limit_load(steps, k - 1, *slips)[2]
        even = (growth > 0).all() and (-force <= LATEST * growth).all() and (force <= growth).all()
    if not even:
        raise UnsupportedError(
            f"a contact with static friction breaks away at t = {t + h:.9g} s, and its load does "
            "not grow evenly in the two steps before, as in an impact: this instant has no "
            "derivative; take shorter steps, or give static_friction equal to friction"
        )
    return BreakAways(limits, loads, np.array(jumps).T, growth / h)


def _slips(steps: ContactSteps, k: int, keys: np.ndarray) -> dict[int, np.ndarray]:
    """Directions in which contacts slip in step ``k``, by their keys; zero without friction."""
    active, linear = steps.active(k), 1 + sum(steps.step.groups[:1])
    own = np.isin(active.keys, keys)
    push = active.impulses[own, 1:linear]
    length = np.linalg.norm(push, axis=1, keepdims=True)
    directions = -push / np.where(length > 0, length, 1.0)
    return dict(zip(active.keys[own].tolist(), directions, strict=True))


def _limit_load(
    steps: ContactSteps, k: int, slips: dict[int, np.ndarray], modes: np.ndarray
) -> tuple[MapAt, np.ndarray, np.ndarray]:
    """Map of step ``k`` if some contacts slip with static friction; derivatives (n_v, groups) of
    ``f`` of each motion (groups, n_v) that begins by the change of the speeds; and ``f``.

    Contacts with means over a path are those of the first solution of the step, to its order.
    """
    (t, h), (y, v), active = steps.span(k), steps.split(k), steps.active(k)
    still = np.zeros(sum(steps.step.groups[:1]))
    limits = np.array([slips.get(int(key), still) for key in active.keys])
    active = replace(active, limits=limits, curved=np.zeros_like(active.curved))
    limit = steps.maps.step(steps.x[:, k], steps.x[steps.size :, k + 1], t, h, active)
    smooth = limit.z[: steps.maps.smooth]
    by_z = steps.maps.equations.step(smooth, y, v, t, steps.p, h)[1][0]
    loads = np.asarray(by_rows(by_z)[: v.size, : v.size].T @ modes.T) / h
    return limit, loads, loads.T @ (limit.z[: v.size] - v)
