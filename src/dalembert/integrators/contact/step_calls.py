"""Kinds of calls of machine code, their outcomes, and states of contacts."""

from __future__ import annotations

from enum import IntEnum

from dalembert.integrators.contact.places import Names


class Calls(Names):
    """Kinds of calls, in ``arg[SIZES][CALL]``."""

    STEP = 0
    ON_PATH = 1  # gaps of the contacts of the path, and their means
    ALL = 2  # all contacts, without impulses
    AGAIN = 3  # the last step with other forces
    # scheme of Moreau and Jean
    JOINED = 4  # the last step with more contacts
    PARTED = 5  # the last step again without these
    AT_END = 6  # gaps at the end of the step
    CORRECTION = 7  # of positions


class StepOutcome(IntEnum):
    """Outcome of a call, in ``iw[OUTCOME]``."""

    DONE = 0
    SINGULAR = 1  # inertia
    OUTDATED = 2  # list of pairs
    FULL = 3  # record
    CLOSED = 4  # a gap, at the start of a step or at its end
    UNORDERED = 5  # the order of elimination misses a pair of bodies
    UNSOLVED = 6  # the impulses did not converge, or the speeds are infinite
    MORE = 7  # contacts than memory
    UNCHANGED = 8  # no contact is added


class Modes(Names):
    """Calls of Newton's method, in ``iw[MODE]``."""

    ASSEMBLE = 0  # residual and equations of a step
    SEARCH = 1  # along the step by their solution
    ITERATE = 2  # all steps, with factors of blocks
    SOLVE = 3  # the whole solution


class States(Names):
    """States of contacts near each other at the start of a step, in ``res[STATES]``."""

    LEAVES = 0  # its face
    IDLE = 1
    ACTIVE = 2
    JOINS = 3  # about to be added
