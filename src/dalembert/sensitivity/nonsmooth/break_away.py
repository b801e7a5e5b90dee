"""Derivatives of the instants at which contacts with static friction break away.

A contact that sticks up to ``f = |T| − μ_s N = 0`` slips with ``μ < μ_s`` afterwards. The instant
moves by ``dt* = −df/ḟ``, and accelerations jump from ``a⁻`` to ``a⁺``, so that

    dv⁺ = dv⁻ + (a⁻ − a⁺) dt*

(jump of the sensitivities: Hiskens and Pai 2000), to the order of the step. Contacts on connected
bodies that break away in one step do so together, by the sum of their ``f``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contact_laws import FIRST
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.impact_groups import connected
from dalembert.sensitivity.nonsmooth.linear_map import MapAt

LATEST = 3.0
"""Upper limit of the time until a load that grows evenly breaks a contact away, in steps [-]."""


@dataclass(frozen=True, eq=False)
class BreakAways:
    """Contribution of contacts that break away after a step to the changes of its end.

    Attributes
    ----------
    step_map : of the last step in which they stick
    groups : rows of the contacts of each instant
    loads : (n, k) derivatives of ``f`` by the impulses
    jumps : (n_x, groups) derivatives of the state at the end of the step by the instants
    rates : (groups,) changes of ``f`` per time, for impulses of a step [N]
    """

    step_map: MapAt
    groups: list[np.ndarray]
    loads: np.ndarray
    jumps: np.ndarray
    rates: np.ndarray

    def push(self, dq: np.ndarray) -> np.ndarray:
        """Change of the state at the end."""
        change, columns = self.step_map.change(dq)[self._first :], dq.shape[1]
        impulses = change.reshape(*self.loads.shape, columns)
        assert self.step_map.contacts is not None
        laws = self.step_map.contacts.gaps.push(dq)[0].laws[:, FIRST - 1]
        excess = (self.loads[..., None] * impulses).sum(axis=1) - self._normal[:, None] * laws
        instants = [-excess[rows].sum(axis=0) for rows in self.groups]
        return self.jumps @ (np.array(instants) / self.rates[:, None])

    def pull(self, weights: np.ndarray) -> np.ndarray:
        """Weights of ``q``."""
        assert self.step_map.contacts is not None
        gaps, columns = self.step_map.contacts.gaps, weights.shape[1]
        excess = np.zeros((self.loads.shape[0], columns))
        instants = (self.jumps.T @ weights) / self.rates[:, None]
        for rows, instant in zip(self.groups, instants, strict=True):
            excess[rows] -= instant
        z_bar, own = np.zeros((self.step_map.z.size, columns)), gaps.values.like(columns)
        z_bar[self._first :] = (self.loads[..., None] * excess[:, None]).reshape(-1, columns)
        own.laws[:, FIRST - 1] = -self._normal[:, None] * excess
        still = np.zeros((gaps.directions.shape[1], columns))
        return np.asarray(self.step_map.weights(z_bar) + gaps.pull(own, still))

    @property
    def _first(self) -> int:
        """Number of the first impulse among the unknowns."""
        return self.step_map.by_q.shape[0]

    @property
    def _normal(self) -> np.ndarray:
        """(n,) normal impulses."""
        impulses: np.ndarray = self.step_map.z[self._first :].reshape(self.loads.shape)[:, 0]
        return impulses


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
    (t, h), active = steps.span(k), steps.active(k)
    broken = np.isin(contacts.keys, keys)
    linear = 1 + sum(steps.step.groups[:1])
    loads, earlier = np.zeros(active.impulses.shape), np.zeros(active.keys.size)
    slip = active.impulses[broken, 1:linear]
    length = np.linalg.norm(slip, axis=1)
    static = contacts.gaps.values.laws[:, FIRST - 1]
    loads[broken, 1:linear] = slip / np.where(length > 0, length, 1.0)[:, None]
    loads[broken, 0] = -static[broken]
    excess = (loads * active.impulses).sum(axis=1)
    before = steps.active(k - 1)
    same = np.isin(active.keys, before.keys) & broken
    earlier[same] = (loads[same] * before.impulses[np.isin(before.keys, active.keys[same])]).sum(1)
    labels = connected(steps, k, contacts)[0]
    groups = [np.flatnonzero(broken & (labels == label)) for label in np.unique(labels[broken])]
    growth = np.array([(excess - earlier)[rows].sum() for rows in groups])
    remaining = np.array([-excess[rows].sum() for rows in groups])
    even = same[broken].all() and (growth > 0).all()
    if not (even and (remaining <= LATEST * growth).all() and (remaining >= -growth).all()):
        raise UnsupportedError(
            f"a contact with static friction breaks away at t = {t + h:.9g} s, and its load does "
            "not grow evenly in the two steps before, as in an impact: this instant has no "
            "derivative; take shorter steps, or give static_friction equal to friction"
        )
    end, lasting = steps.x[:, k + 1], active.some(np.isin(active.keys, steps.active(k + 1).keys))
    stuck = steps.acceleration(end, t + h, h, lasting)
    jumps = []
    for rows in groups:
        slipping = steps.acceleration(end, t + h, h, lasting, contacts.keys[rows])
        jumps.append(np.concatenate([np.zeros(steps.size), stuck - slipping]))
    return BreakAways(step_map, groups, loads, np.array(jumps).T, growth / h)
