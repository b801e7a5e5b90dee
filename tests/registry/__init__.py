"""Every element, law, curve, formulation, stabilisation and integrator, once.

A case builds a small model with one element in general position, in which *every* number is a
parameter, together with its NumPy twin: the same mechanics written out by hand. Laws are tested
over all cases.
"""

# ruff: noqa: F401, I001 (tests ask here for all of it; cases are registered in this order)
from __future__ import annotations

from registry.builder import AXES, GRAVITY, MOMENTS, Builder, Observer
from registry.cases import CASES, Case, P, Q, case, definite, model_of
from registry.motion_laws import LAWS, PROFILES, TIMES, VALUES, LawCase
from registry.strategies import FORMULATIONS, INTEGRATORS, SOFT, STABILIZATIONS

from thorough import crossed

from registry import joints, curves, rolling, drivers, forces, elastic, friction, touching
import spatial_cases

PLANAR = [n for n, c in CASES.items() if c.dimension == 2]
CONSTRAINED = [n for n, c in CASES.items() if c.residual]
LOADED = [n for n, c in CASES.items() if c.loads]
SPATIAL = [n for n in CASES if n not in PLANAR]
RELATED = [n for n in CONSTRAINED if n.removeprefix("rotational driver ") not in list(LAWS)[1:]]
"""All that are constrained, but a driver with one law: others change its right side only."""
EACH = [n for n in PLANAR if n in RELATED]
IN_TURN = [f for f in FORMULATIONS if f not in ("KKT", "NullSpace svd")]  # svd: for few speeds only
COMBINED = crossed(EACH, FORMULATIONS, 2) + [
    (n, IN_TURN[k % len(IN_TURN)]) for k, n in enumerate(n for n in CASES if n not in EACH)
]
"""Cases with formulations: constraints in the plane each with each; all formulations in turn in
space, for other laws of one driver, and where nothing is constrained, so that all do the same."""
