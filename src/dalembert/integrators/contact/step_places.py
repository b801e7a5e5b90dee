"""Numbers of steps of free bodies in machine code: the place and the meaning of each.

They are entries of arrays in ``places``. Shares of lengths, speeds and times have no unit.
"""

from __future__ import annotations

from dalembert.integrators.contact.places import Places


class Limits(Places):
    """``arg[LIMITS]``: of a step of free bodies."""

    LENGTH = 0  # of the step [s]
    TOLERANCE = 1  # of the impulses [-]
    ROUNDING = 2  # penetration that counts as zero [m]
    REACH = 3  # of the list of pairs [m]
    PATH_WEIGHT = 4  # of a position in the means over the path [-]
    LEAST_TRAVEL = 5  # of an impact within the step [m]
    LEAST_TURN = 6  # change of a gap by its turn that counts as zero [m]
    CLEARANCE = 7  # of gaps that turn [m]
    LONGEST = 8  # step that might follow [s]
    LEAST_GAP = 9  # lower limit of gaps in the conditions [m]
    LEAD = 10  # length of the step over that to the positions ahead [-]
    THETA = 11  # of the scheme [-]
    GAMMA = 12  # prediction of gaps, in steps [-]
    PROJECTS = 13  # 1 if positions are corrected, else 0
    LEAST_PENETRATION = 14  # lower limit of the reference of a correction [m]
    MISSED_ENERGY = 15  # of an impact that counts as missed, by the kinetic energy [-]


class Shares(Places):
    """``arg[SHARES]``: parameters of the solution (``solution_settings``), then of the steps."""

    WEIGHT = 0  # initial proximal weight
    INCREASE = 1  # factor of the weight after failure
    DECREASE = 2  # after success
    WEIGHT_MAX = 3
    WEIGHT_MIN = 4
    RESIDUAL_SHARE = 5  # tolerance of a proximal problem relative to the residual
    TOLERANCE_SHARE = 6  # and to the tolerance of the original problem
    REGULARIZATION = 7  # of interior points
    TO_BOUNDARY = 8  # share of a step to the boundary
    FIRST_START = 9  # distance of the first interior point from the boundary
    INTERIOR_SHARE = 10  # residual at which Newton's method begins
    INTERIOR_FACTOR = 11  # by which it has to fall until it begins again
    SHORT = 12  # share of a short step
    INTERIOR_END = 13  # residual at which Newton's method begins for the last time
    LAST_REGULARIZATION = 14  # below that residual
    SECOND_START = 15  # as FIRST_START, from impulses that are zero
    NEWTON_SHARE = 16  # tolerance of Newton's method relative to that of the problem
    LAST_DECREASE = 17  # as DECREASE, of the last proximal problems
    LAST_ITERATIONS = 18  # of Newton's method in these
    FIRST_ITERATIONS = 19  # of Newton's method before proximal problems of redundant contacts
    REDUNDANT = 20  # pressing contacts by their pairs of bodies above which they are redundant
    REDUNDANT_ITERATIONS = 21  # of Newton's method in proximal problems of such contacts
    REACH = 22  # of contacts, by the distance at the largest speed
    CLOSING = 23  # of a gap by gradual approach
    SLOW = 24  # speed of an impact by the change of speed by forces
    ROUNDING = 25  # of the work of all contacts
    JAMMED = 26  # residual of blocked contacts by the largest speed
    SLOWEST = 27  # speed of an impact by the gap over the length of the step
    TURNS = 28  # clearance of a gap by its turn
    CORNER_SLACK = (
        29  # steps by which a corner may come later to the end of a face than to the face
    )
    LATEST = 30  # steps within which a gap closes
    AT_REST = 31  # closing of a gap that counts as rest, by the size of the face
    ROUGH = 32  # tolerance of impulses that determine which contacts press
    SLIDES = 33  # slip of a sliding contact by the change of speed by forces
    STOPS = 34  # change of the slip of one that stops
    PATIENCE = 35  # proximal problems that do not halve the residual before impulses are changed
    CHANGE = 36  # of these impulses, relative to them


class Sizes(Places):
    """``arg[SIZES]``: of the contacts of a step, and the kind of the call."""

    LAST_IMPULSES = 0  # initial impulses
    FEATURES = 1  # of all hulls
    NUMBERED = 2  # balls and walls
    OFFSET = 3  # of the keys of hulls
    SLOTS = 4  # of the table of keys
    HULLS = 5  # whether there are any
    CALL = 6  # class Calls
    PATH = 7  # contacts with means over the path
    BEFORE = 8  # contacts of the last completed step
    # scheme of Moreau and Jean
    STORED = 9  # contacts
    ADDED = 10  # those about to be added
    MISSES = 11  # whether shapes may have an impact that the step misses
    OPENS = 12  # whether contacts may be added
    FINAL = 13  # whether those about to be added are final
    OTHERS = 14  # contacts of other features that are closed at the end


class RecordColumns(Places):
    """``res[RECORD]``: numbers of a step in the record."""

    DEPTH = 0  # smallest gap at the start [m]
    LOSS = 1  # dissipation [J]
    FRICTION = 2  # that by friction [J]
    RESIDUAL = 3  # of the impulses [m/s]
    ROUNDS = 4  # proximal problems
    PRESSING = 5  # contacts that press


class Descriptions(Places):
    """Columns of ``arg[DESCRIPTIONS]``: what a contact is between."""

    KIND = (
        0  # 0: wall and corner or ball, 1: face and corner, 2: corners, 3: edges, 4: edge, corner
    )
    SHAPE = 1  # first one
    FEATURE = 2  # of the first shape
    OTHER_SHAPE = 3
    OTHER_FEATURE = 4
    PAIR = 5  # listed pair


class ShapePlaces(Places):
    """Columns of ``arg[PLACES]``: first entries of a shape in other arrays; -1 for none."""

    FORM = 0  # in FORMS
    CORNERS = 1  # in CORNERS
    AXES = 2  # in AXES
    FEATURES = 3  # number of its first feature
    NUMBER = 4  # among balls and walls


class Forms(Places):
    """Head of a record in ``arg[FORMS]``: numbers of a form, then places within its record."""

    CORNERS = 0
    EDGES = 1
    GROUPS = 2  # of parallel edges
    LOOPS = 3
    FACES = 4  # all loops, or none
    EDGE_CORNERS = 5  # two of each edge
    GROUP_STARTS = 6  # first edges of the groups
    GROUP_EDGES = 7  # edges of the groups
    LOOP_STARTS = 8  # first corners of the loops
    LOOP_CORNERS = 9  # corners of the loops
    LOOP_EDGES = 10  # edges along these
