"""Steps of free bodies with balls, hulls and walls: one call of machine code per step."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ROUNDS, ContactStep
from dalembert.analysis.nonsmooth.free_bodies.free_body_motion import FreeBodyMotion
from dalembert.analysis.nonsmooth.free_bodies.pair_lists import GROWTH, PairLists
from dalembert.analysis.nonsmooth.free_bodies.step_arrays import (
    contact_arrays,
    contact_inputs,
    integers,
    shape_inputs,
    step_outputs,
)
from dalembert.analysis.nonsmooth.free_bodies.step_shares import STEP_SHARES
from dalembert.analysis.nonsmooth.gaps.hulls.compiled_features import GEOMETRY
from dalembert.analysis.nonsmooth.gaps.shape_velocities import TWIST
from dalembert.integrators.contact.approach import SLOW
from dalembert.integrators.contact.compiled_newton import (
    BLOCK_REGULARIZATION,
    JUMPS,
    MEMORY,
    OVERSHOOT,
)
from dalembert.integrators.contact.contact_laws import FIRST
from dalembert.integrators.contact.machine_code import Loop, machine_code
from dalembert.integrators.contact.places import Counts, Inputs, Outputs, Settings, Status
from dalembert.integrators.contact.solution_settings import (
    MANY_PROXIMAL,
    NEWTON_STEPS,
    SOLUTION_COUNTS,
    SOLUTION_FILES,
)
from dalembert.integrators.contact.step_places import Limits, RecordColumns, Shares, Sizes

FILES = (
    *SOLUTION_FILES,
    "free_bodies.c",
    *GEOMETRY,
    "feature_gaps.c",
    "last_impulses.c",
    "leaving_corners.c",
    "shape_contacts.c",
    "free_body_step.c",
)
"""Files of the machine code of steps by all schemes."""
CHUNK, RECORDS = 512, 16_384
"""Steps between transfers of the record, and least number of its contacts."""
CONSTANT = (
    Counts.COMPONENTS,
    Counts.GROUPS,
    Counts.CONTACT_SPEEDS,
    Counts.BLOCK_SIZE,
    Counts.DIMENSION,
)
"""Counts that are constants of the compiled code."""


class FreeBodySteps(PairLists):
    """Arrays of the machine code of anticipated impacts, and its calls.

    A subclass for another scheme names the files of its step, and appends arrays.

    Parameters
    ----------
    step : ContactStep
    motion : functions of the step

    Attributes
    ----------
    v, force, inertia, displacement : (n,) of the step; entries of ``A``
    corners, references, normals, velocities : of the shapes
    ahead : the same in the middle of the step
    limits : by ``Limits``
    lists : number of lists of pairs so far
    """

    files: ClassVar[tuple[str, ...]] = ("anticipated_step.c",)

    def __init__(self, step: ContactStep, motion: FreeBodyMotion):
        self._motion, self._shapes = motion, motion.shapes
        self._neighbours = motion.shapes.neighbours()
        n, shapes, widest = motion.first[-1], motion.shapes.count, motion.widest
        walls = shapes - motion.shapes.hulls
        self.width = 1 + sum(step.groups)
        self.v, self.force, self.displacement = (np.zeros(n) for _ in range(3))
        self.inertia = np.zeros(motion.columns.size)
        self.corners = np.zeros((int(motion.shapes.corner_starts[-1]), 3))
        self.references, self.normals = np.zeros((shapes, 3)), np.zeros((walls, 3))
        self.velocities = np.zeros((shapes, TWIST, widest))
        geometry = self.corners, self.references, self.normals, self.velocities
        self.ahead = list(map(np.zeros_like, geometry))
        self.limits = Limits.numbers(self._scheme_limits(step))
        used = [0, 1, *range(FIRST, FIRST + len(step.groups))]
        self.radii, self.body, self._reserved = motion.radii(step.p), motion.body.copy(), 0
        self._laws = np.ascontiguousarray(motion.laws(step.p)[used].T)
        self._settings = Settings.numbers(
            {Settings.REGULARIZATION: BLOCK_REGULARIZATION, Settings.OVERSHOOT: OVERSHOOT}
        )
        self._shares = Shares.numbers(STEP_SHARES)
        self._groups = np.cumsum([1, *step.groups]).astype(np.int32)
        self._loop: Loop | None = None
        self._pressed, self._kept = np.zeros(0, np.int64), np.zeros(0, np.int32)
        self._impulses, self._offsets = np.zeros((2, 0, self.width))
        self._old = np.full((shapes, 3), np.inf), np.full((walls, 3), np.inf)
        self._pairs = np.zeros((3, 0), np.int32)
        self._last = np.zeros(0, np.int64), np.zeros((0, self.width))
        self.arms, self._centers = np.zeros(shapes), np.zeros((shapes, 3))
        self._shares_of_path, self.lists = np.ones(n), 0
        self._keys, self._described, self._gaps = contact_arrays(0)
        none = np.zeros((0, self.width * 2 * motion.widest)), np.zeros((0, 3))
        self._path = *contact_arrays(0), *none
        self._before = contact_arrays(0)[:2]
        self._sizes = np.zeros(Sizes.size(), dtype=np.int64)
        self._sizes[Sizes.FEATURES] = motion.shapes.features
        self._sizes[Sizes.OFFSET] = motion.shapes.offset
        self._sizes[Sizes.NUMBERED] = motion.shapes.numbered
        self._sizes[Sizes.HULLS] = not motion.shapes.only_balls
        bodies = motion.first.size - 1
        self._order = {
            Inputs.BLOCK_OF_SPEED: integers(n),
            Inputs.PLACE_IN_BLOCK: integers(n),
            Inputs.FACTOR_STARTS: integers(bodies + 1),
            Inputs.FACTOR_ROWS: integers(1),
            Inputs.BLOCK_MEMBERS: np.full((bodies, widest), -1, dtype=np.int32),
        }
        self._inverses = np.zeros(bodies * widest**2), np.full(self.inertia.size, np.nan)
        counts = {
            Counts.COMPONENTS: self.width,
            Counts.GROUPS: len(step.groups),
            Counts.SPEEDS: n,
            Counts.UNKNOWNS: n,
            Counts.CONTACT_SPEEDS: 2 * widest,
            Counts.BLOCKS: bodies,
            Counts.BLOCK_SIZE: widest,
            Counts.MAX_ITERATIONS: NEWTON_STEPS,
            Counts.MERITS: MEMORY,
            Counts.MAX_JUMPS: JUMPS,
            Counts.SHAPES: shapes,
            Counts.BALLS_AND_HULLS: motion.shapes.hulls,
            Counts.BODIES: bodies,
            Counts.DIMENSION: motion.shapes.dimension,
            Counts.INERTIA_ENTRIES: self.inertia.size,
            Counts.MAX_PROXIMAL: min(MANY_PROXIMAL, step.solver.max_iterations),
            Counts.MAX_OFFSETS: ROUNDS,
            **SOLUTION_COUNTS,
        }
        constants = tuple((place, int(counts[place])) for place in CONSTANT)
        self._code = machine_code(*FILES, *self.files, constants=constants)
        self.counts = np.zeros(Counts.size(), dtype=np.int64)
        self.counts[list(counts)] = list(counts.values())
        self.numbers = np.zeros((CHUNK, RecordColumns.size()))
        motion.orderings.forget()
        if self.available:
            self._allocate(1, 1, 1)
            self._renew_order()

    def _scheme_limits(self, step: ContactStep) -> dict[int, float]:
        """Limits of the steps; others change from call to call."""
        return {
            Limits.TOLERANCE: step.solver.tolerance,
            Limits.ROUNDING: step.rounding,
            Limits.REACH: -1.0,  # there is no list of pairs
            Limits.LEAST_TRAVEL: step.least_travel,
            Limits.LEAST_TURN: step.rounding,
            Limits.CLEARANCE: step.clearance,
            Limits.LONGEST: step.longest,
            Limits.LEAD: 1 / self._motion.lead,
            Limits.THETA: step.scheme.theta,
        }

    @property
    def available(self) -> bool:
        """Whether there is machine code."""
        return self._code is not None

    def set_lengths(self, h: float, longest: float, rest: float) -> None:
        """Lengths of a step and of the longest one that may follow; impacts exceed the change of
        speed by forces in a step of the length ``rest`` [s]."""
        self.limits[Limits.LENGTH], self.limits[Limits.LONGEST] = h, longest
        self._shares[Shares.SLOW] = SLOW * max(rest / h, 1.0)

    def reserve_record(self, contacts: int) -> None:
        """Room in the record for a number of contacts that are appended after each step."""
        self._reserved = contacts
        if self._pressed.size < RECORDS + 16 * contacts:
            self._allocate(self._pairs.shape[1], self._contacts, self._entries)
        else:
            self.counts[Counts.MAX_RECORDED] = self._pressed.size - contacts

    def _reserve(self, contacts: int) -> None:
        contacts = int(GROWTH * max(contacts, self._contacts)) + 1
        self._allocate(self._pairs.shape[1], contacts, self._entries)

    def _allocate(self, pairs: int, contacts: int, entries: int) -> None:
        """Arrays for numbers of listed pairs, of contacts and of matrix entries."""
        k, widest, old = self.width, self._motion.widest, self._pairs
        self._contacts, self._entries = contacts, entries
        self._pairs = np.zeros((3, pairs), dtype=np.int32)
        self._pairs[:, : old.shape[1]] = old
        last, self._last = self._last, (np.zeros(contacts, np.int64), np.zeros((contacts, k)))
        for own, old_last in zip(self._last, last, strict=True):
            own[: old_last.shape[0]] = old_last
        means = np.zeros((contacts, k * 2 * widest)), np.zeros((contacts, 3))
        path, before = (*contact_arrays(contacts), *means), contact_arrays(contacts)[:2]
        for own, old_part in zip((*path, *before), (*self._path, *self._before), strict=True):
            own[: old_part.shape[0]] = old_part
        records = max(RECORDS + 32 * self._reserved, 4 * contacts, self._pressed.size)
        recorded = np.zeros(records, np.int64), *np.zeros((2, records, k)), integers(records)
        used = self.counts[Counts.RECORDED_CONTACTS]
        for own, old_part in zip(recorded, self._recorded, strict=True):
            own[:used] = old_part[:used]
        self._pressed, self._impulses, self._offsets, self._kept = recorded
        self._keys, self._described, self._gaps = contact_arrays(contacts)
        self._path, self._before, self._status = path, before, np.zeros(Status.size())
        inputs = {
            **contact_inputs(contacts, k, int(self.counts[Counts.GROUPS]), widest),
            **shape_inputs(self._shapes),
            **self._lasting_inputs(),
        }
        self._sizes[Sizes.SLOTS] = inputs[Inputs.KEY_TABLE].size
        outputs = step_outputs(contacts, k, widest, self.v.size, entries)
        self._solved, self._pair_of = outputs[Outputs.IMPULSE], outputs[Outputs.PAIRS]
        self._speeds = outputs[Outputs.VELOCITY_BEFORE], outputs[Outputs.VELOCITY_FREE]
        outputs.update(self._lasting_outputs(contacts))
        blocks, size = self.counts[[Counts.BLOCKS, Counts.BLOCK_SIZE]]
        work = 12 * k**2 + 3 * k * (k + 1) + 2 * k + 4 * k * widest + (2 * widest) ** 2
        work = int(max(work, blocks * size + size**2))
        self.counts[Counts.WORK], self.counts[Counts.MAX_CONTACTS] = work, contacts
        self.counts[Counts.MAX_RECORDED] = records - self._reserved
        assert self._code is not None
        memory = work + contacts * k + MEMORY + contacts + 2 + entries
        arrays = Inputs.arranged(inputs), Outputs.arranged(outputs)
        self._loop = Loop(self._code, *arrays, list(self.counts), memory)
        self.counts = self._loop.counts

    def _lasting_inputs(self) -> dict[int, np.ndarray]:
        """Inputs that the steps share with the time loop, or that last from step to step."""
        motion, ahead = self._motion, self.ahead
        return {
            Inputs.SETTINGS: self._settings,
            Inputs.GROUP_STARTS: self._groups,
            Inputs.INERTIA: self.inertia,
            Inputs.INERTIA_ROWS: motion.starts,
            Inputs.INERTIA_COLUMNS: motion.columns,
            **self._order,
            Inputs.SPEEDS: self.v,
            Inputs.FORCES: self.force,
            Inputs.REFERENCES: self.references,
            Inputs.NORMALS: self.normals,
            Inputs.RADII: self.radii,
            Inputs.SHAPE_VELOCITIES: self.velocities,
            Inputs.LAWS: self._laws,
            Inputs.BODY_OF_SHAPE: self.body,
            Inputs.BODY_STARTS: motion.first,
            Inputs.FIRST_SHAPE: self._pairs[0],
            Inputs.SECOND_SHAPE: self._pairs[1],
            Inputs.LAW_OF_PAIR: self._pairs[2],
            Inputs.LISTED_CENTERS: self._old[0],
            Inputs.LISTED_NORMALS: self._old[1],
            Inputs.LIMITS: self.limits,
            Inputs.SHARES: self._shares,
            Inputs.CORNERS: self.corners,
            Inputs.KEYS: self._keys,
            Inputs.LAST_KEYS: self._last[0],
            Inputs.GAPS: self._gaps,
            Inputs.SIZES: self._sizes,
            Inputs.CENTERS: self._centers,
            Inputs.ARMS: self.arms,
            Inputs.DESCRIPTIONS: self._described,
            Inputs.PATH_SHARES: self._shares_of_path,
            Inputs.PATH_DESCRIPTIONS: self._path[1],
            Inputs.PATH_KEYS: self._path[0],
            Inputs.PATH_GAPS: self._path[2],
            Inputs.PATH_MEANS: self._path[3],
            Inputs.PATH_NORMALS: self._path[4],
            Inputs.KEYS_BEFORE: self._before[0],
            Inputs.DESCRIPTIONS_BEFORE: self._before[1],
            Inputs.CORNERS_AHEAD: ahead[0],
            Inputs.REFERENCES_AHEAD: ahead[1],
            Inputs.NORMALS_AHEAD: ahead[2],
            Inputs.VELOCITIES_AHEAD: ahead[3],
        }

    def _lasting_outputs(self, contacts: int) -> dict[int, np.ndarray]:
        """Outputs that the steps share with the time loop, or that last from step to step; of
        other schemes also further ones for a number of contacts."""
        return {
            Outputs.STATUS: self._status,
            Outputs.INVERSES: self._inverses[0],
            Outputs.LAST_INERTIA: self._inverses[1],
            Outputs.DISPLACEMENT: self.displacement,
            Outputs.LAST_IMPULSES: self._last[1],
            Outputs.RECORD: self.numbers,
            Outputs.RECORDED_KEYS: self._pressed,
            Outputs.RECORDED_IMPULSES: self._impulses,
            Outputs.RECORDED_OFFSETS: self._offsets,
            Outputs.RECORDED_DIRECTIONS: self._kept,
        }
