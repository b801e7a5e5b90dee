"""Recorded parts of steps with contacts, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from dalembert.analysis.nonsmooth.step_state import StepResult
from dalembert.integrators.contact.contacts import among


@dataclass(frozen=True, eq=False)
class StepEntries:
    """Parts of K steps that are recorded; contacts of all steps are concatenated.

    Attributes
    ----------
    multiplier : (m, K) of the joints, times the steps
    count : (K,) numbers of pressing contacts
    owner, key, impulse, offset : element, gap, impulse and velocity offset of each pressing contact
    curved : whether the step had means over its path for the gap of a pressing contact
    kept : whether a pressing contact had its directions at the start of the step
    longest : (K,) longest step that might follow [s]
    loss, friction : (K,) energy dissipated by the contacts, and its part by tangential impulses
    work, fraction : of each pressing contact, as in ``StepResult``
    residual, rounds, converged : (K,) of the solutions of the friction problems
    """

    multiplier: np.ndarray
    count: np.ndarray
    owner: np.ndarray
    key: np.ndarray
    impulse: np.ndarray
    offset: np.ndarray
    curved: np.ndarray
    kept: np.ndarray
    longest: np.ndarray
    loss: np.ndarray
    friction: np.ndarray
    work: np.ndarray
    fraction: np.ndarray
    residual: np.ndarray
    rounds: np.ndarray
    converged: np.ndarray

    @classmethod
    def of(cls, result: StepResult, v: np.ndarray) -> StepEntries:
        """The entry of a step with the speeds ``v`` at its start."""
        impulses, contacts = result.impulses, result.contacts
        pressing = impulses.impulses[:, 0] > 0
        slip = contacts.speeds((v + result.v) / 2)[:, 1:]
        friction = -float((impulses.impulses[:, 1:] * slip).sum())
        return cls(
            result.multiplier[:, None],
            np.array([np.count_nonzero(pressing)]),
            contacts.owner[pressing],
            contacts.key[pressing],
            impulses.impulses[pressing],
            result.offsets[pressing],
            among(contacts.key[pressing], result.curved),
            contacts.kept_mask[pressing],
            np.array([result.longest]),
            np.array([result.loss]),
            np.array([friction]),
            result.work[pressing],
            result.fractions[pressing],
            np.array([impulses.residual]),
            np.array([impulses.rounds]),
            np.array([impulses.converged]),
        )

    @classmethod
    def joined(cls, parts: list[StepEntries], joints: int, components: int) -> StepEntries:
        """Entries of consecutive steps, with a number of joint multipliers and of components of
        impulses."""
        whole, number, flag = np.zeros(0), np.zeros(0, dtype=int), np.zeros(0, dtype=bool)
        table = np.zeros((0, components))
        entries = [*[number] * 3, *[table] * 2, *[flag] * 2, *[whole] * 6, number, flag]
        none = cls(np.zeros((joints, 0)), *entries)
        parts = [none, *parts]
        columns = {f.name: [getattr(part, f.name) for part in parts] for f in fields(cls)}
        multiplier = np.concatenate(columns.pop("multiplier"), axis=1)
        return cls(multiplier, **{name: np.concatenate(c) for name, c in columns.items()})
