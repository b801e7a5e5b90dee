"""Settings of the machine code that solves contact problems of free bodies: Newton's method,
proximal problems, and interior points."""

from __future__ import annotations

from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.step_places import Shares

SOLUTION_FILES = (
    "newton_pieces.c",
    "block_factors.c",
    "semismooth_newton.c",
    "interior_point.c",
    "contact_solution.c",
)
"""Files of the machine code."""
NEWTON_SHARE = 0.1
"""Tolerance of Newton's method relative to that of the problem; its last step reduces the residual
by far more [-]."""
WEIGHT, INCREASE, DECREASE, WEIGHT_MAX, WEIGHT_MIN = 1e-3, 4.0, 0.3, 1.0, 1e-11
"""Proximal weight: initial value, factors after failure and success, upper and lower limit [-]."""
LAST_DECREASE, LAST_STEPS = 0.8, 8
"""Factor of the weight after success, and upper limit of Newton's steps, of the last problems."""
RESIDUAL_SHARE, TOLERANCE_SHARE = 0.3, 0.3
"""Tolerance of a proximal problem relative to the residual and to the tolerance of the original
problem; the larger one counts [-]."""
FEW_PROXIMAL, MANY_PROXIMAL = 8, 300
"""Upper limits of the proximal problems before interior points or sweeps, and after interior
points."""
FIRST_STEPS, NEWTON_STEPS, INTERIOR_POINTS, POLISHING, SHORT_STEPS = 5, 15, 45, 6, 5
"""Upper limits of Newton's steps until redundant contacts continue with proximal problems, of
Newton's steps, of interior points, of Newton's steps from one of these, and of consecutive short
steps of interior points."""
REDUNDANT, REDUNDANT_STEPS = 1.2, 40
"""Number of pressing contacts of a pair, as the mean of all pairs, above which contacts are
redundant, as those of boxes are, and upper limit of Newton's steps on each of their proximal
problems. Interior points rarely solve them."""
PATIENCE, CHANGE = 40, 1e-3
"""Number of proximal problems of redundant contacts that do not halve the least residual, as they
may repeat a cycle, after which the best impulses change by a pseudorandom share, and largest such
share [-]."""
INTERIOR_STARTS, TO_BOUNDARY, SHORT = (0.1, 1.0), 0.995, 1e-2
"""Distances of the first interior points from the boundary relative to the largest speed, share of
a step to the boundary, and share of a short step [-]."""
INTERIOR_SHARE, INTERIOR_FACTOR, INTERIOR_END = 1e-5, 0.03, 1e-6
"""Residual relative to the largest speed at which Newton's method begins, factor by which it has to
fall until it begins again, and residual at which it begins for the last time [-]."""
REGULARIZATIONS = 1e-6, 1e-4
"""Regularisation of interior points relative to the mobility, and that below ``INTERIOR_END``."""
SOLUTION_COUNTS: dict[int, int] = {
    Counts.MAX_INTERIOR: INTERIOR_POINTS,
    Counts.MAX_POLISHING: POLISHING,
    Counts.MAX_SHORT_STEPS: SHORT_STEPS,
    Counts.FEW_PROXIMAL: FEW_PROXIMAL,
}
"""Limits of the machine code."""
SOLUTION_SHARES = {
    Shares.WEIGHT: WEIGHT,
    Shares.INCREASE: INCREASE,
    Shares.DECREASE: DECREASE,
    Shares.WEIGHT_MAX: WEIGHT_MAX,
    Shares.WEIGHT_MIN: WEIGHT_MIN,
    Shares.RESIDUAL_SHARE: RESIDUAL_SHARE,
    Shares.TOLERANCE_SHARE: TOLERANCE_SHARE,
    Shares.REGULARIZATION: REGULARIZATIONS[0],
    Shares.TO_BOUNDARY: TO_BOUNDARY,
    Shares.FIRST_START: INTERIOR_STARTS[0],
    Shares.INTERIOR_SHARE: INTERIOR_SHARE,
    Shares.INTERIOR_FACTOR: INTERIOR_FACTOR,
    Shares.SHORT: SHORT,
    Shares.INTERIOR_END: INTERIOR_END,
    Shares.LAST_REGULARIZATION: REGULARIZATIONS[1],
    Shares.SECOND_START: INTERIOR_STARTS[1],
    Shares.NEWTON_SHARE: NEWTON_SHARE,
    Shares.LAST_DECREASE: LAST_DECREASE,
    Shares.LAST_ITERATIONS: LAST_STEPS,
    Shares.FIRST_ITERATIONS: FIRST_STEPS,
    Shares.REDUNDANT: REDUNDANT,
    Shares.REDUNDANT_ITERATIONS: REDUNDANT_STEPS,
    Shares.PATIENCE: PATIENCE,
    Shares.CHANGE: CHANGE,
}
"""Parameters of the machine code."""
