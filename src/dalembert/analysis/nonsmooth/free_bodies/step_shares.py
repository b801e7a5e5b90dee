"""Parameters of steps in machine code, by their places."""

from __future__ import annotations

from dalembert.analysis.nonsmooth.advance import AHEAD
from dalembert.analysis.nonsmooth.contact_step import JAMMED
from dalembert.analysis.nonsmooth.gaps import corners_over_faces
from dalembert.analysis.nonsmooth.middle_directions import TURNS
from dalembert.integrators.contact.approach import SLOW, SLOWEST
from dalembert.integrators.contact.mean_slip import SLIDES, STOPS
from dalembert.integrators.contact.schemes import CLOSING, ROUNDING
from dalembert.integrators.contact.solution_settings import SOLUTION_SHARES
from dalembert.integrators.contact.step_places import Shares

ROUGH = 1e-3
"""Tolerance of the impulses that determine which contacts press, relative to the largest speed of a
contact: the conditions of these contacts differ, and solutions take fewer iterations than those
with the tolerance of the step [-]."""
STEP_SHARES = {
    **SOLUTION_SHARES,
    Shares.REACH: 2 * AHEAD,
    Shares.CLOSING: CLOSING,
    Shares.SLOW: SLOW,
    Shares.ROUNDING: ROUNDING,
    Shares.JAMMED: JAMMED,
    Shares.SLOWEST: SLOWEST,
    Shares.TURNS: TURNS,
    Shares.CORNER_SLACK: corners_over_faces.SLACK,
    Shares.LATEST: corners_over_faces.LATEST,
    Shares.AT_REST: corners_over_faces.ROUNDING,
    Shares.ROUGH: ROUGH,
    Shares.SLIDES: SLIDES,
    Shares.STOPS: STOPS,
}
"""Parameters of the solution and of the steps."""
