"""Former public names and their successors, for the messages about unknown names."""

from __future__ import annotations

from collections.abc import Iterable

RENAMED: dict[str, str] = {
    # elements of the plane
    "Moment": "Torque",
    "RotationalSpring": "TorsionSpring",
    "Translational": "Prismatic",
    # strategies and responses
    "Bdf": "BDF",
    "Ccsaq": "CCSAQ",
    "CmaEs": "CMAES",
    "Cvodes": "CVODES",
    "Dae": "DAE",
    "Ida": "IDA",
    "Kkt": "KKT",
    "Mma": "MMA",
    "Rms": "RMS",
    "Slsqp": "SLSQP",
    # design tasks
    "Design": "DesignTable",
    "Front": "ParetoResult",
    "History": "InputHistory",
    "Identification": "IdentificationResult",
    "Inversion": "InversionResult",
    "OptimalTrajectory": "TrajectoryResult",
    "Optimum": "OptimizationResult",
    "Reliability": "ReliabilityResult",
    "ReliableOptimum": "ReliableOptimizationResult",
    "Study": "SweepResult",
    "Synthesis": "SynthesisResult",
    "Toleranced": "ToleranceResult",
    # analyses
    "Linearization": "Modal",
    "NonlinearStatics": "Equilibrium",
    "Transient": "Dynamics",
    # functions and variables
    "history": "input_history",
    "table": "Interpolation",
    "u": "curves.u",
    # methods and attributes of results
    "allotted": "allocated",
    # keywords, methods and keys of files
    "allot": "allocate",
    "apart": "minimum_distance",
    "given": "inputs",
    "least_crank": "minimum_crank_ratio",
    "least_radius": "minimum_radius",
    "rescued": "ipopt_fallback",
}
"""Former name → present name; each is unique among the names of its place."""


def successor(name: object, known: Iterable[str]) -> str | None:
    """The present name of a former one, if it is known where the former one was used."""
    new = RENAMED.get(name) if isinstance(name, str) else None
    return new if new and new.partition(".")[0] in known else None
