"""dalembert: analysis and design optimisation of constrained mechanical systems.

>>> import dalembert as da
>>> from dalembert import planar
"""

from dalembert import structures
from dalembert.analysis import (
    ArcLength,
    Buckling,
    Dynamics,
    Equilibrium,
    Event,
    InverseDynamics,
    Kinematics,
    Linearization,
    Modal,
    NonlinearStatics,
    Rayleigh,
    Statics,
    Transient,
    linearize,
    solve_assembly,
    solve_buckling,
    solve_dynamics,
    solve_equilibrium,
    solve_inverse_dynamics,
    solve_kinematics,
    solve_load_path,
    solve_modes,
    solve_statics,
    solve_transient,
)
from dalembert.analysis.comparison.compare import compare
from dalembert.design import Limit, Optimum, optimize
from dalembert.elements import laws, planar
from dalembert.elements.curves import FormulaCurve, SplineCurve, u
from dalembert.elements.laws import (
    CycloidalRise,
    Formula,
    Harmonic,
    HarmonicRise,
    Polynomial,
    Polynomial345Rise,
    Polynomial4567Rise,
    Table,
)
from dalembert.errors import (
    AnalysisError,
    AssemblyError,
    DalembertError,
    ExpressionError,
    FileError,
    ModelError,
    SingularityError,
    UnsupportedError,
)
from dalembert.formulations import (
    AugmentedLagrangian,
    Baumgarte,
    Dae,
    EnergyProjection,
    Kkt,
    NullSpace,
    Penalty,
    Projection,
    RangeSpace,
    Stabilization,
    VelocityPartitioning,
)
from dalembert.integrators import (
    HHT,
    RK4,
    BackwardEuler,
    Bdf,
    Cvodes,
    DormandPrince,
    DormandPrince853,
    Euler,
    GeneralizedAlpha,
    Heun,
    Ida,
    Newmark,
    Radau,
    RKGill,
    Trapezoidal,
)
from dalembert.model.coordinates import AbsoluteCoordinates
from dalembert.model.joint_coordinates import JointCoordinates
from dalembert.model.model import Model
from dalembert.model.system import System
from dalembert.responses import (
    At,
    AtEvent,
    Final,
    Integral,
    Maximum,
    Mean,
    Minimum,
    Response,
    Rms,
    Total,
    at,
    at_event,
    evaluate,
    event_time,
    final,
    integral,
    maximum,
    mean,
    minimum,
    rms,
    total,
)
from dalembert.results.comparison.result import Comparison
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome, Status
from dalembert.results.tornado import tornado
from dalembert.sensitivity import (
    Adjoint,
    Certificate,
    Direct,
    FiniteDifference,
    StepStudy,
    eigenvalue_slopes,
    hessian_product,
    sensitivity,
    step_study,
)
from dalembert.structures.structure import Structure
from dalembert.symbolic.compiled import clear_cache
from dalembert.symbolic.expression import Expression, t
from dalembert.symbolic.functions import (
    absolute,
    acos,
    asin,
    atan,
    atan2,
    cos,
    cosh,
    exp,
    floor,
    hypot,
    log,
    sign,
    sin,
    sinh,
    smooth_abs,
    sqrt,
    tan,
    tanh,
    where,
)
from dalembert.symbolic.parameter import Parameter

__version__ = "0.1.0"


def load_model(path) -> System | Structure:
    """Read a mechanism or structure from a TOML or JSON model file; ``build()`` it to analyse it.

    Raises
    ------
    FileError, ModelError
        With file, place, value and cure.
    """
    from dalembert.io import load

    return load(path)


def load_results(path):
    """Read a result file written by ``save`` as an ``xarray.Dataset``.

    Raises
    ------
    FileError
        Missing file, or not a result file.
    """
    from dalembert.results.store import load_dataset

    return load_dataset(path)


__all__ = [
    "HHT",
    "RK4",
    "AbsoluteCoordinates",
    "Adjoint",
    "AnalysisError",
    "ArcLength",
    "AssemblyError",
    "At",
    "AtEvent",
    "AugmentedLagrangian",
    "BackwardEuler",
    "Baumgarte",
    "Bdf",
    "Buckling",
    "Certificate",
    "Comparison",
    "Cvodes",
    "CycloidalRise",
    "Dae",
    "DalembertError",
    "Direct",
    "DormandPrince",
    "DormandPrince853",
    "Dynamics",
    "EnergyProjection",
    "Equilibrium",
    "Euler",
    "Event",
    "Expression",
    "ExpressionError",
    "FileError",
    "Final",
    "FiniteDifference",
    "Formula",
    "FormulaCurve",
    "GeneralizedAlpha",
    "Harmonic",
    "HarmonicRise",
    "Heun",
    "Ida",
    "Integral",
    "InverseDynamics",
    "JointCoordinates",
    "Kinematics",
    "Kkt",
    "Limit",
    "Linearization",
    "Maximum",
    "Mean",
    "Minimum",
    "Modal",
    "Model",
    "ModelError",
    "Motion",
    "Newmark",
    "NonlinearStatics",
    "NullSpace",
    "Optimum",
    "Outcome",
    "Parameter",
    "Penalty",
    "Polynomial",
    "Polynomial345Rise",
    "Polynomial4567Rise",
    "Projection",
    "RKGill",
    "Radau",
    "RangeSpace",
    "Rayleigh",
    "Response",
    "Rms",
    "SingularityError",
    "SplineCurve",
    "Stabilization",
    "Statics",
    "Status",
    "StepStudy",
    "Structure",
    "System",
    "Table",
    "Total",
    "Transient",
    "Trapezoidal",
    "UnsupportedError",
    "VelocityPartitioning",
    "absolute",
    "acos",
    "asin",
    "at",
    "at_event",
    "atan",
    "atan2",
    "clear_cache",
    "compare",
    "cos",
    "cosh",
    "eigenvalue_slopes",
    "evaluate",
    "event_time",
    "exp",
    "final",
    "floor",
    "hessian_product",
    "hypot",
    "integral",
    "laws",
    "linearize",
    "load_model",
    "load_results",
    "log",
    "maximum",
    "mean",
    "minimum",
    "optimize",
    "planar",
    "rms",
    "sensitivity",
    "sign",
    "sin",
    "sinh",
    "smooth_abs",
    "solve_assembly",
    "solve_buckling",
    "solve_dynamics",
    "solve_equilibrium",
    "solve_inverse_dynamics",
    "solve_kinematics",
    "solve_load_path",
    "solve_modes",
    "solve_statics",
    "solve_transient",
    "sqrt",
    "step_study",
    "structures",
    "t",
    "tan",
    "tanh",
    "tornado",
    "total",
    "u",
    "where",
]
