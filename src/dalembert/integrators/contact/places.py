"""Arrays of the loops over contacts in machine code: the place and the meaning of each.

The C text in ``sources`` names the places, as in ``arg[MOBILITY]``, ``iw[CONTACTS]`` or
``arg[LIMITS][TOLERANCE]``; ``place_names`` puts the numbers in. ``W`` are the directions of the
contacts, ``X = W M⁻¹`` their responses. Sparse matrices are compressed by rows. Contacts have the
same number of components each: the normal one, then groups of tangential ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np


class Names:
    """Numbers by names in upper case."""

    @classmethod
    def table(cls) -> dict[str, int]:
        """Number of each name."""
        return {name: number for name, number in vars(cls).items() if name.isupper()}


class Places(Names):
    """Places in an array."""

    @classmethod
    @cache
    def size(cls) -> int:
        """Number of places."""
        return max(cls.table().values()) + 1

    @classmethod
    def numbers(cls, values: Mapping[int, float]) -> np.ndarray:
        """Array with some values at their places, and zeros at the others."""
        array = np.zeros(cls.size())
        array[list(values)] = list(values.values())
        return array

    @classmethod
    def listed(cls, counts: Mapping[int, int]) -> list[int]:
        """Some counts at their places, and zeros at the others."""
        return [counts.get(place, 0) for place in range(cls.size())]

    @classmethod
    def arranged(cls, arrays: Mapping[int, np.ndarray]) -> list[np.ndarray]:
        """Arrays in the order of their places up to the last one, and one zero at the others."""
        none = np.zeros(1)
        return [arrays.get(place, none) for place in range(max(arrays) + 1)]


class Inputs(Places):
    """``arg``: arrays that are read; steps of free bodies change some of them, too."""

    # problem
    DIRECTIONS = 0  # entries of W
    RESPONSES = 1  # entries of X
    VELOCITY = 2  # relative velocities without impulses, with the offsets of the laws of impact
    FRICTION = 3  # coefficients of friction of each group of each contact
    MINIMUM = 4  # lower limits of normal impulses
    MOBILITY = 5  # change of a component of velocity by its own impulse
    WEIGHTS = 6  # of the components in the residual
    SHIFT = 7  # addition to the diagonal of W X^T: compliance or proximal term
    SETTINGS = 8  # class Settings
    DIRECTION_ROWS = 9  # starts of the rows of W
    DIRECTION_COLUMNS = 10  # columns of the entries of W
    RESPONSE_ROWS = 11  # starts of the rows of X
    RESPONSE_COLUMNS = 12  # columns of the entries of X
    GROUP_STARTS = 13  # first component of each group, and the end of the last
    # equations of free bodies, by blocks
    INERTIA = 14  # entries of A, the matrix of the step
    INERTIA_ROWS = 15  # starts of its rows
    INERTIA_COLUMNS = 16  # columns of its entries
    BLOCK_OF_SPEED = 17  # block of each speed, in the order of elimination
    PLACE_IN_BLOCK = 18  # of each speed
    FACTOR_STARTS = 19  # starts of the columns of L, by blocks
    FACTOR_ROWS = 20  # rows of the blocks of L
    BLOCK_MEMBERS = 21  # speeds of each block; -1 for padding
    # state and shapes
    SPEEDS = 22  # of the bodies; at the start, then at the end
    FORCES = 23  # of the bodies
    REFERENCES = 24  # reference points of the bodies, for each shape
    NORMALS = 25  # of the walls
    RADII = 26  # of the balls and hulls
    SHAPE_VELOCITIES = 27  # (6, size of a block) velocities of each shape by the speeds of its body
    LAWS = 28  # coefficients of restitution in normal and tangential direction, and of friction
    BODY_OF_SHAPE = 29  # -1 for the ground
    BODY_STARTS = 30  # first speed of each body, and the end
    FIRST_SHAPE = 31  # of each listed pair
    SECOND_SHAPE = 32
    LAW_OF_PAIR = 33
    LISTED_CENTERS = 34  # centres of the shapes when the pairs were listed
    LISTED_NORMALS = 35  # normals of the walls then
    LIMITS = 36  # class Limits
    SHARES = 37  # class Shares
    PLACES = 38  # class ShapePlaces, of each shape
    FORMS = 39  # class Forms, of each form, then its lists
    CORNERS = 40  # of all shapes; a ball has its centre and a wall a point
    AXES = 41  # of all hulls
    FEATURES = 42  # memory for the features of one pair of hulls
    KEYS = 43  # of the contacts
    LAST_KEYS = 44  # of the contacts with initial impulses
    GAPS = 45  # of the contacts
    KEY_TABLE = 46  # places of LAST_KEYS by the remainders of the keys
    SIZES = 47  # class Sizes
    CENTERS = 48  # of the shapes
    ARMS = 49  # largest distances of corners from the reference points
    HULL_WORK = 50  # memory of the search for features
    DESCRIPTIONS = 51  # class Descriptions, of each contact
    PATH_SHARES = 52  # of each speed in the velocity at a position on the path
    PATH_DESCRIPTIONS = 53  # of the contacts with means over the path
    PATH_KEYS = 54
    PATH_MEANS = 55  # means of their rows of W
    PATH_GAPS = 56
    PATH_NORMALS = 57  # at the start of the path
    KEYS_BEFORE = 58  # of the contacts of the last completed step
    DESCRIPTIONS_BEFORE = 59
    CORNERS_AHEAD = 60  # in the middle of the step, as the four arrays below
    REFERENCES_AHEAD = 61
    NORMALS_AHEAD = 62
    VELOCITIES_AHEAD = 63
    AXES_AHEAD = 64
    # scheme of Moreau and Jean
    MASS = 65  # entries of the mass matrix where the shapes are


class Outputs(Places):
    """``res``: arrays that are written, among them the memory from call to call."""

    IMPULSE = 0  # of the contacts; on entry the initial guess
    # Newton's method
    SYSTEM = 1  # matrix of a step, A + sum of W^T gain W, then its factors
    RIGHT_SIDE = 2
    FREE_STEP = 3  # change of the impulses without a change of the bodies' speeds
    GAIN = 4  # change of the impulses by the velocities, a square matrix for each contact
    VELOCITY = 5  # relative velocities with impulses
    STEP = 6  # change of the impulses
    CHANGE = 7  # change of the velocities by it; for interior points, the residual of the slack
    TRIAL = 8  # impulses of a trial; before the search, whether a contact is in the equations
    TRIAL_VELOCITY = 9
    SPEED_CHANGES = 10  # of the bodies, by impulses
    STATUS = 11  # class Status
    CONSTANT = 12  # the matrix without contacts
    SOLUTION = 13  # of the linear equations
    COLUMN_STARTS = 14  # first column of each contact in COLUMNS, and the end
    COLUMNS = 15  # speeds on which each contact acts
    LOCAL_COLUMNS = 16  # of the entries of W, among the columns of the contact
    ENTRY_STARTS = 17  # first entry of each contact in ENTRIES
    ENTRIES = 18  # of each contact in the matrix
    # steps of free bodies
    FREE_SPEEDS = 19  # of the bodies at the end without impulses, then with these
    INVERSES = 20  # of the blocks of A
    LAST_INERTIA = 21  # entries of A that these belong to
    GAPS = 22  # of the contacts in the conditions of the scheme
    PAIRS = 23  # listed pair of each contact
    VELOCITY_BEFORE = 24  # of the contacts, at the start
    VELOCITY_FREE = 25  # at the end without impulses
    OFFSETS = 26  # of the velocities, by the law of impact
    NEXT_OFFSETS = 27
    DISPLACEMENT = 28  # of the step
    LAST_IMPULSES = 29  # initial impulses, of LAST_KEYS
    RECORD = 30  # class RecordColumns, of each step
    RECORDED_KEYS = 31  # of the pressing contacts of all steps
    RECORDED_IMPULSES = 32
    RECORDED_OFFSETS = 33
    PROXIMAL = 34  # velocities without proximal terms; centre, best impulses, last move
    BEST_IMPULSE = 35  # those with the smallest residual
    PRIMAL = 36  # interior points: x = (mu P_N, P_T)
    SLACK = 37  # s = (u_N/mu + |u_T|, u_T)
    PRIMAL_STEP = 38
    SLACK_STEP = 39
    SCALED = 40  # variables in the scaling of Nesterov and Todd
    SCALING_ROOT = 41
    SCALING_AXIS = 42
    SCALING = 43  # scale of each contact
    CONTACT_INVERSE = 44  # (1 + gain shift)^-1 of each contact
    START_DIRECTIONS = 45  # whether a contact has its directions at the start
    RECORDED_DIRECTIONS = 46  # the same of the pressing contacts of all steps
    BODY_CHANGES = 47  # the largest change of a normal speed by forces, by the bodies' first speeds
    VELOCITY_APPLIED = 48  # VELOCITY_FREE, by the last forces of the step
    FIRST_SPEEDS = 49  # FREE_SPEEDS, by the first forces of the step
    LEAVING = 50  # whether a corner leaves its face before it would touch it
    SLIDING = 51  # whether the mean of the slip counts
    # scheme of Moreau and Jean: all contacts near each other at the start
    STORED_DIRECTIONS = 52  # W
    STORED_ROWS = 53
    STORED_COLUMNS = 54
    STORED_BEFORE = 55  # VELOCITY_BEFORE
    STORED_FREE = 56  # VELOCITY_FREE
    STORED_GAPS = 57
    STORED_KEYS = 58
    STORED_DESCRIPTIONS = 59
    STORED_START = 60  # START_DIRECTIONS
    STORED_NORMALS = 61  # from the shape with the lower number
    STATES = 62  # class States
    END_SPEEDS = 63  # of the bodies
    MASS_INVERSES = 64  # of the blocks of the mass matrix
    LAST_MASS = 65  # entries of the mass matrix that these belong to
    OTHER_KEYS = 66  # of contacts of other features that are closed at the end
    OTHER_DESCRIPTIONS = 67


class Counts(Places):
    """``iw``: sizes of the problem, upper limits, and results that are counted."""

    CONTACTS = 0
    COMPONENTS = 1  # of a contact
    GROUPS = 2  # of tangential components
    SPEEDS = 3  # of the bodies
    ENTRIES = 4  # of the matrix of a step
    UNKNOWNS = 5  # of its equations
    MODE = 6  # class Modes, of a call of Newton's method
    OUTCOME = 6  # class StepOutcome, of a call of a step
    CONTACT_SPEEDS = 7  # upper limit of the speeds on which a contact acts
    BLOCKS = 8  # of the matrix
    BLOCK_SIZE = 9
    MAX_ITERATIONS = 10  # of Newton's method
    MERITS = 11  # stored merits
    MAX_JUMPS = 12  # whole steps without a decrease
    WORK = 13  # memory of elimination
    SHAPES = 14
    BALLS_AND_HULLS = 15  # shapes before the walls
    BODIES = 16
    PAIRS = 17  # listed ones
    DIMENSION = 18
    MAX_CONTACTS = 19  # memory
    RECORDED_STEPS = 20
    RECORDED_CONTACTS = 21
    MAX_RECORDED = 22  # memory for recorded contacts
    INERTIA_ENTRIES = 23
    MAX_PROXIMAL = 24  # proximal problems after interior points
    MAX_OFFSETS = 25  # changes of the offsets within a step
    MAX_INTERIOR = 26  # interior points
    MAX_POLISHING = 27  # iterations of Newton's method from one of these
    MAX_SHORT_STEPS = 28  # consecutive ones, of interior points
    FEW_PROXIMAL = 29  # proximal problems before interior points


class Settings(Places):
    """``arg[SETTINGS]``: of Newton's method."""

    TOLERANCE = 0  # of the residual [m/s]
    REGULARIZATION = 1  # relative to the mobility [-]
    OVERSHOOT = 2  # beyond a change of piece [-]
    RELATIVE_TOLERANCE = 3  # of the whole solution [-]
    SCALE = 4  # lower limit of the reference speed [m/s]


class Status(Places):
    """``res[STATUS]``: results of the solution and of a step."""

    MERIT = 0  # squared
    RESIDUAL = 1  # of the impulses [m/s]
    DESCENDS = 2  # whether the line search found a decrease
    ROUNDS = 3  # proximal problems of a whole solution
    DEEPEST = 4  # smallest gap where the shapes are [m]
    FORCED = 5  # the largest change of a normal speed by forces [m/s]
    EXCHANGED = 6  # work of the impulses by the changes of velocity that they cause
    PUSHES = 7  # sum of the magnitudes of the impulses
    REACH = 8  # that the list of pairs needs for a step [m]
