"""Free bodies that sleep: islands of bodies at rest take no part in the steps until they wake."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import FreeBodyMotion
from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import FreeBodySteps
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.step_places import RecordColumns

AWAKE = -1
"""Island of a body that does not sleep."""
BALANCED = 0.1
"""Upper limit of accelerations at rest, relative to the speed over the time of the rule [-]."""
SAME_FORCE = 1e-9
"""Change of the force on a sleeping body that does not wake it, relative to the force [-]."""

NO_SLEEP = (
    "sleep_after needs free rigid bodies with balls, hulls and fixed walls, Newton's law of "
    "impact, AnticipatedImpacts(), and no force laws, static friction or states; leave it out"
)
"""Message where bodies cannot sleep."""


@dataclass(frozen=True, eq=False)
class SleepRule:
    """When islands of bodies sleep.

    Attributes
    ----------
    speed : upper limit of the speed of all points of a body that counts as rest [m/s]
    time : time at rest after which an island sleeps [s]
    """

    speed: float
    time: float

    @classmethod
    def of(cls, analysis: Any) -> SleepRule | None:
        """Rule of an analysis with the fields of ``Nonsmooth``; None if bodies never sleep."""
        if analysis.sleep_after is None:
            return None
        return cls(analysis.sleep_speed, analysis.sleep_after)


class SleepingBodies:
    """Islands of sleeping bodies, and the contacts between these.

    An island is a set of free bodies that press on each other, or nearly touch. It sleeps once all
    of its bodies have been at rest for a time. Its speeds are then zero, its bodies are as immobile
    as the ground, and its contacts keep their last impulses. It wakes where another body presses on
    it, in the same step, which is repeated, or where the forces on its bodies change.

    Parameters
    ----------
    rule : SleepRule; None: bodies never sleep
    motion : functions of the step
    steps : arrays and machine code of a step

    Attributes
    ----------
    all_asleep : whether all bodies sleep
    count : sum of the sleeping bodies over all steps
    """

    def __init__(self, rule: SleepRule | None, motion: FreeBodyMotion, steps: FreeBodySteps):
        self._rule, self._motion, self._steps = rule, motion, steps
        bodies = motion.first.size - 1
        self._owner = np.repeat(np.arange(bodies), np.diff(motion.first))
        self._island, self._rest = np.full(bodies, AWAKE), np.zeros(bodies)
        self._force, self._fresh = np.zeros(self._owner.size), np.zeros(self._owner.size, bool)
        self._asleep, self._any_asleep = np.zeros(self._owner.size, dtype=bool), False
        self._contacts = np.zeros((2, 0), dtype=np.int64)  # bodies and keys
        self._impulses, self._offsets = np.zeros((2, 0, steps.width))
        self._stored = self._island, self._rest
        self._next, self.count, self.all_asleep = 0, 0, False
        self._speeds = np.zeros(self._owner.size)
        shaped = motion.body >= 0
        self._shapes = np.flatnonzero(shaped)
        reach = np.zeros(motion.body.size)
        reach[: motion.shapes.hulls] = steps.radii
        self._radii, self._column = reach[shaped], motion.body[shaped]

    def begin(self, speeds: np.ndarray) -> None:
        """Continue with other speeds; islands that move wake."""
        if self._rule is None or not self._any_asleep:
            return
        moving = np.unique(self._island[self._fastest(speeds) > self._rule.speed])
        self._wake(moving[moving != AWAKE])
        speeds[self._asleep] = 0.0

    def restore(self) -> None:
        """The islands before the last step, which is repeated."""
        island, rest = self._stored
        self._wake(np.unique(self._island[(self._island != AWAKE) & (island == AWAKE)]))
        self._rest = rest

    def remove_forces(self) -> bool:
        """Remove the forces on sleeping bodies, and wake those on which they changed; whether there
        are any of the latter."""
        if not self._any_asleep:
            return False
        force, asleep = self._steps.force, self._asleep
        self._force[self._fresh] = force[self._fresh]
        self._fresh[:] = False
        change = np.abs(force - self._force) > SAME_FORCE * np.abs(self._force[asleep]).max()
        changed = change & asleep
        wakes = bool(changed.any())
        if wakes:
            self._wake(np.unique(self._island[self._owner[changed]]))
        force[self._asleep] = 0.0
        return wakes

    def wakes(self) -> bool:
        """Wake the islands on which other bodies press in the last step; whether there are any."""
        if not self._any_asleep or self.all_asleep:
            return False
        bodies = self._motion.body[self._steps.pressing_shapes()]
        islands = np.where(bodies >= 0, self._island[bodies], AWAKE)
        other = (islands == AWAKE) & (bodies >= 0)
        pressed = np.unique(islands[:, other.any(axis=0)])
        pressed = pressed[pressed != AWAKE]
        self._wake(pressed)
        return bool(pressed.size)

    def record(self) -> None:
        """Append the contacts of sleeping bodies to the record of the last step."""
        if not self._any_asleep:
            return
        self.count += int((self._island != AWAKE).sum())
        self._steps.append(self._contacts[1], self._impulses, self._offsets)

    def sleep(self, h: float) -> None:
        """Islands whose bodies have been at rest for long enough sleep after the last step.

        Parameters
        ----------
        h : length of the step [s]
        """
        steps, rule = self._steps, self._rule
        if rule is None or self.all_asleep:
            return
        self._stored = self._island.copy(), self._rest
        slow, change = self._fastest(steps.v) <= rule.speed, steps.v - self._speeds
        self._rest, self._speeds[:] = np.where(slow, self._rest + h, 0.0), steps.v
        ready = (self._rest >= rule.time) & (self._island == AWAKE)
        if not ready.any():
            return
        ready &= self._fastest(change) <= BALANCED * rule.speed * h / rule.time
        label = self._labels(rule.speed * rule.time)
        asleep = self._island != AWAKE
        restless = np.zeros(self._island.size, dtype=bool)
        np.logical_or.at(restless, label, ~(ready | asleep))
        new = ready & ~restless[label]
        if not new.any():
            return
        self._island = np.where(new | asleep, self._next + label, AWAKE)
        self._next += self._island.size
        self._asleep = self._island[self._owner] != AWAKE
        self._fresh |= new[self._owner]
        steps.numbers[steps.counts[Counts.RECORDED_STEPS] - 1, RecordColumns.LOSS] += (
            self._kinetic_energy(new)
        )
        steps.v[new[self._owner]] = 0.0
        self._keep(new)
        self._apply()
        steps.reorder()

    def _labels(self, reach: float) -> np.ndarray:
        """Numbers that are the same for bodies of one island, and for those within reach [m]."""
        near = self._motion.body[self._steps.near_shapes(reach)]
        near = near[:, (near >= 0).all(axis=0)]
        asleep = np.flatnonzero(self._island != AWAKE)
        _, first, inverse = np.unique(self._island[asleep], return_index=True, return_inverse=True)
        edges = np.concatenate([near, np.stack([asleep, asleep[first[inverse]]])], axis=1)
        size = self._island.size
        graph = scipy.sparse.coo_array((np.ones(edges.shape[1]), edges), shape=(size, size))
        label: np.ndarray = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
        return label

    def _keep(self, new: np.ndarray) -> None:
        """Keep the contacts of bodies that begin to sleep."""
        bodies = self._motion.body[self._steps.pressing_shapes()]
        keys, impulses, offsets = self._steps.last_recorded()
        own = new[bodies].any(axis=0, where=bodies >= 0)
        added = np.stack([bodies.max(axis=0), keys])[:, own]
        self._contacts = np.concatenate([self._contacts, added], axis=1)
        self._impulses = np.concatenate([self._impulses, impulses[own]])
        self._offsets = np.concatenate([self._offsets, offsets[own]])

    def _wake(self, islands: np.ndarray) -> None:
        """Wake islands; their contacts start from their last impulses."""
        if not islands.size:
            return
        woken = np.isin(self._island, islands)
        self._island, self._rest = self._island.copy(), np.where(woken, 0.0, self._rest)
        self._island[woken] = AWAKE
        own = woken[self._contacts[0]]
        self._steps.warm_more(self._contacts[1, own], self._impulses[own])
        self._contacts = self._contacts[:, ~own]
        self._impulses, self._offsets = self._impulses[~own], self._offsets[~own]
        self._asleep = self._island[self._owner] != AWAKE
        self._apply()

    def _apply(self) -> None:
        """Bodies of the shapes in machine code, and room for the contacts of sleeping bodies."""
        body, self.all_asleep = self._motion.body, bool(self._asleep.all())
        self._any_asleep = bool(self._asleep.any())
        asleep = (body >= 0) & (self._island[body] != AWAKE)
        self._steps.body[:] = np.where(asleep, -1, body)
        self._steps.reserve_record(self._contacts.shape[1])

    def _fastest(self, v: np.ndarray) -> np.ndarray:
        """(bodies,) upper limits of the speeds of the points of the bodies [m/s]."""
        motion, steps, bodies = self._motion, self._steps, self._island.size
        speeds = np.zeros((bodies, motion.widest))
        speeds[self._owner, np.arange(v.size) - motion.first[self._owner]] = v
        twist = np.einsum(
            "sab,sb->sa", steps.velocities[self._shapes], speeds[self._column], optimize=False
        )
        linear, angular = (np.sqrt((twist[:, k : k + 3] ** 2).sum(axis=1)) for k in (0, 3))
        points = linear + angular * (steps.arms[self._shapes] + self._radii)
        fastest = np.full(bodies, np.inf)  # of bodies without shapes
        fastest[self._column] = 0.0
        np.maximum.at(fastest, self._column, points)
        return fastest

    def _kinetic_energy(self, bodies: np.ndarray) -> float:
        """Kinetic energy of some bodies [J]."""
        motion, v = self._motion, self._steps.v * bodies[self._owner]
        entries = self._steps.inertia, motion.columns, motion.starts
        matrix = scipy.sparse.csr_array(entries, shape=(v.size, v.size))
        return 0.5 * float(v @ (matrix @ v))
