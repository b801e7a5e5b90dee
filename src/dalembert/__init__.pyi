"""The public names and where they come from: each stands here, once.

Editors and type checkers read this file; ``__init__.py`` imports a name when it is first used.
"""

from dalembert import structures as structures
from dalembert.analysis.assembly import solve_assembly as solve_assembly
from dalembert.analysis.comparison.compare import compare as compare
from dalembert.analysis.dynamics.dynamics import Dynamics as Dynamics
from dalembert.analysis.dynamics.solve import (
    solve_dynamics as solve_dynamics,
    solve_transient as solve_transient,
)
from dalembert.analysis.equilibrium.equilibrium import (
    Equilibrium as Equilibrium,
    solve_equilibrium as solve_equilibrium,
)
from dalembert.analysis.equilibrium.load_path import (
    ArcLength as ArcLength,
    solve_load_path as solve_load_path,
)
from dalembert.analysis.equilibrium.statics import (
    Statics as Statics,
    solve_statics as solve_statics,
)
from dalembert.analysis.events import Event as Event
from dalembert.analysis.explore import explore as explore
from dalembert.analysis.frequency.frequency_response import FrequencyResponse as FrequencyResponse
from dalembert.analysis.frequency.random_response import RandomResponse as RandomResponse
from dalembert.analysis.frequency.solve import frequency_response as frequency_response
from dalembert.analysis.kinematics.inverse_dynamics import (
    InverseDynamics as InverseDynamics,
    solve_inverse_dynamics as solve_inverse_dynamics,
)
from dalembert.analysis.kinematics.kinematics import (
    Kinematics as Kinematics,
    solve_kinematics as solve_kinematics,
)
from dalembert.analysis.modes.buckling import (
    Buckling as Buckling,
    solve_buckling as solve_buckling,
)
from dalembert.analysis.modes.modal import Modal as Modal
from dalembert.analysis.modes.solve import linearize as linearize, solve_modes as solve_modes
from dalembert.analysis.nonsmooth.nonsmooth import (
    Nonsmooth as Nonsmooth,
    solve_nonsmooth as solve_nonsmooth,
)
from dalembert.analysis.rayleigh import Rayleigh as Rayleigh
from dalembert.analysis.stepping.stepper import Stepper as Stepper
from dalembert.analysis.stepping.stepper_state import StepperState as StepperState
from dalembert.design.case import Case as Case
from dalembert.design.ecosystem.functions import DesignFunctions as DesignFunctions
from dalembert.design.ecosystem.gymnasium_environment import (
    gymnasium_environment as gymnasium_environment,
)
from dalembert.design.ecosystem.openmdao_component import openmdao_component as openmdao_component
from dalembert.design.ecosystem.openmdao_implicit import (
    openmdao_implicit_component as openmdao_implicit_component,
)
from dalembert.design.ecosystem.pymoo_problem import pymoo_problem as pymoo_problem
from dalembert.design.identification.experiment import Experiment as Experiment
from dalembert.design.identification.identification_result import (
    IdentificationResult as IdentificationResult,
)
from dalembert.design.identification.identify import identify as identify
from dalembert.design.inverse.input_history import (
    InputHistory as InputHistory,
    input_history as input_history,
)
from dalembert.design.inverse.inversion_result import InversionResult as InversionResult
from dalembert.design.inverse.invert import invert as invert
from dalembert.design.limit import Limit as Limit
from dalembert.design.methods.branch_and_bound import BranchAndBound as BranchAndBound
from dalembert.design.methods.cma_es import CMAES as CMAES
from dalembert.design.methods.differential_evolution import (
    DifferentialEvolution as DifferentialEvolution,
)
from dalembert.design.methods.enumeration import Enumeration as Enumeration
from dalembert.design.methods.ipopt import Ipopt as Ipopt
from dalembert.design.methods.least_squares import LeastSquares as LeastSquares
from dalembert.design.methods.moving_asymptotes import MMA as MMA
from dalembert.design.methods.multistart import Multistart as Multistart
from dalembert.design.methods.nlopt_ccsa import CCSAQ as CCSAQ
from dalembert.design.methods.slsqp import SLSQP as SLSQP
from dalembert.design.methods.trust_constr import TrustConstr as TrustConstr
from dalembert.design.optimize.optimization import optimize as optimize
from dalembert.design.optimize.optimization_result import OptimizationResult as OptimizationResult
from dalembert.design.pareto.pareto import pareto as pareto
from dalembert.design.pareto.pareto_result import ParetoResult as ParetoResult
from dalembert.design.quantity import SumOfSquares as SumOfSquares, combined as combined
from dalembert.design.reliability.distributions import (
    Gumbel as Gumbel,
    Lognormal as Lognormal,
    Normal as Normal,
    Truncated as Truncated,
    Uniform as Uniform,
    Weibull as Weibull,
)
from dalembert.design.reliability.optimize_reliable import optimize_reliable as optimize_reliable
from dalembert.design.reliability.reliability import reliability as reliability
from dalembert.design.reliability.reliability_result import ReliabilityResult as ReliabilityResult
from dalembert.design.reliability.reliable_optimization_result import (
    ReliableOptimizationResult as ReliableOptimizationResult,
)
from dalembert.design.robust import Robust as Robust, robust as robust
from dalembert.design.studies.design_table import DesignTable as DesignTable
from dalembert.design.studies.indices import (
    morris_indices as morris_indices,
    sobol_indices as sobol_indices,
)
from dalembert.design.studies.surfaces import (
    Surface as Surface,
    gaussian_process as gaussian_process,
    response_surface as response_surface,
)
from dalembert.design.studies.sweep import sweep as sweep
from dalembert.design.studies.sweep_result import SweepResult as SweepResult
from dalembert.design.synthesis.burmester import burmester_dyads as burmester_dyads
from dalembert.design.synthesis.cam import FlatFaceCam as FlatFaceCam, RollerCam as RollerCam
from dalembert.design.synthesis.chains import (
    INVERSIONS as INVERSIONS,
    geared_five_bar as geared_five_bar,
    linkage_from_chain as linkage_from_chain,
    six_bar as six_bar,
)
from dalembert.design.synthesis.dead_centre import dead_centre_four_bar as dead_centre_four_bar
from dalembert.design.synthesis.four_bar import FourBar as FourBar
from dalembert.design.synthesis.pose_linkages import pose_linkages as pose_linkages
from dalembert.design.synthesis.precision_points import (
    five_point_four_bars as five_point_four_bars,
)
from dalembert.design.synthesis.slider_crank import SliderCrank as SliderCrank
from dalembert.design.synthesis.swinging_cam import (
    SwingingFlatCam as SwingingFlatCam,
    SwingingRollerCam as SwingingRollerCam,
)
from dalembert.design.synthesis.synthesis_result import (
    Solution as Solution,
    SynthesisResult as SynthesisResult,
)
from dalembert.design.synthesis.synthesize import synthesize as synthesize
from dalembert.design.synthesis.synthesize_mechanism import (
    synthesize_mechanism as synthesize_mechanism,
)
from dalembert.design.synthesis.target import Target as Target
from dalembert.design.tolerance.tolerance import tolerance as tolerance
from dalembert.design.tolerance.tolerance_result import ToleranceResult as ToleranceResult
from dalembert.design.trajectory.collocation import DirectCollocation as DirectCollocation
from dalembert.design.trajectory.control import Control as Control
from dalembert.design.trajectory.optimize_trajectory import (
    optimize_trajectory as optimize_trajectory,
)
from dalembert.design.trajectory.shooting import MultipleShooting as MultipleShooting
from dalembert.design.trajectory.trajectory_result import TrajectoryResult as TrajectoryResult
from dalembert.design.variables import Catalogue as Catalogue, Integer as Integer
from dalembert.elements import (
    blocks as blocks,
    curves as curves,
    laws as laws,
    planar as planar,
    rotation as rotation,
    spatial as spatial,
)
from dalembert.elements.curves import (
    FormulaCurve as FormulaCurve,
    SplineCurve as SplineCurve,
)
from dalembert.elements.laws.base import (
    Formula as Formula,
    Harmonic as Harmonic,
    Polynomial as Polynomial,
)
from dalembert.elements.laws.rise import (
    CycloidalRise as CycloidalRise,
    HarmonicRise as HarmonicRise,
    Polynomial345Rise as Polynomial345Rise,
    Polynomial4567Rise as Polynomial4567Rise,
)
from dalembert.elements.laws.table import Table as Table
from dalembert.errors import (
    AnalysisError as AnalysisError,
    AssemblyError as AssemblyError,
    BudgetError as BudgetError,
    DalembertError as DalembertError,
    ExpressionError as ExpressionError,
    FileError as FileError,
    ModelError as ModelError,
    SingularityError as SingularityError,
    UnknownNameError as UnknownNameError,
    UnsupportedError as UnsupportedError,
)
from dalembert.fmu.export import FMU as FMU, export_fmu as export_fmu
from dalembert.formulations.augmented_lagrangian import AugmentedLagrangian as AugmentedLagrangian
from dalembert.formulations.automatic_formulation import (
    AutomaticFormulation as AutomaticFormulation,
)
from dalembert.formulations.dae import DAE as DAE
from dalembert.formulations.energy_projection import EnergyProjection as EnergyProjection
from dalembert.formulations.kkt import KKT as KKT
from dalembert.formulations.null_space import NullSpace as NullSpace
from dalembert.formulations.penalty import Penalty as Penalty
from dalembert.formulations.range_space import RangeSpace as RangeSpace
from dalembert.formulations.stabilization import (
    Baumgarte as Baumgarte,
    Projection as Projection,
    Stabilization as Stabilization,
)
from dalembert.formulations.velocity_partitioning import (
    VelocityPartitioning as VelocityPartitioning,
)
from dalembert.integrators.automatic import AutomaticIntegrator as AutomaticIntegrator
from dalembert.integrators.bdf.bdf import BDF as BDF
from dalembert.integrators.contact.contact_solver import ContactSolver as ContactSolver
from dalembert.integrators.contact.schemes import (
    AnticipatedImpacts as AnticipatedImpacts,
    MoreauJean as MoreauJean,
)
from dalembert.integrators.newmark.family import (
    HHT as HHT,
    GeneralizedAlpha as GeneralizedAlpha,
    Newmark as Newmark,
)
from dalembert.integrators.runge_kutta.explicit import (
    RK4 as RK4,
    DormandPrince as DormandPrince,
    DormandPrince853 as DormandPrince853,
    Euler as Euler,
    Heun as Heun,
    RKGill as RKGill,
)
from dalembert.integrators.runge_kutta.implicit import (
    BackwardEuler as BackwardEuler,
    Radau as Radau,
    Trapezoidal as Trapezoidal,
)
from dalembert.integrators.sundials import CVODES as CVODES, IDA as IDA
from dalembert.io.exports.export import export as export
from dalembert.io.imports.imported import Imported as Imported
from dalembert.io.imports.registry import import_model as import_model
from dalembert.io.model_file import load_model as load_model
from dalembert.io.omission import Omission as Omission
from dalembert.model.assembled.model import StructuralModel as StructuralModel
from dalembert.model.graph.coordinates import AbsoluteCoordinates as AbsoluteCoordinates
from dalembert.model.graph.model import Model as Model
from dalembert.model.graph.registry import AutomaticCoordinates as AutomaticCoordinates
from dalembert.model.graph.tree.joint_coordinates import JointCoordinates as JointCoordinates
from dalembert.model.structure import Structure as Structure
from dalembert.model.system import System as System
from dalembert.responses.base import Response as Response
from dalembert.responses.evaluation import evaluate as evaluate
from dalembert.responses.events import (
    AtEvent as AtEvent,
    at_event as at_event,
    event_time as event_time,
)
from dalembert.responses.extremes import (
    Maximum as Maximum,
    Minimum as Minimum,
    maximum as maximum,
    minimum as minimum,
)
from dalembert.responses.integrals import (
    RMS as RMS,
    Integral as Integral,
    Mean as Mean,
    Total as Total,
    integral as integral,
    mean as mean,
    rms as rms,
    total as total,
)
from dalembert.responses.peaks import Peak as Peak, peak as peak
from dalembert.responses.random_rms import RandomRMS as RandomRMS, random_rms as random_rms
from dalembert.responses.values import At as At, Final as Final, at as at, final as final
from dalembert.results.batch.batch import Batch as Batch
from dalembert.results.comparison.result import Comparison as Comparison
from dalembert.results.files.assembly_report import assembly_report as assembly_report
from dalembert.results.files.store import load_results as load_results
from dalembert.results.harmonic import HarmonicResponse as HarmonicResponse
from dalembert.results.module import Module as Module
from dalembert.results.motion import Motion as Motion
from dalembert.results.pictures.tornado import tornado as tornado
from dalembert.results.random_vibration import RandomVibration as RandomVibration
from dalembert.results.state_space import StateSpace as StateSpace
from dalembert.results.status import Outcome as Outcome, Status as Status
from dalembert.sensitivity.checks.certificate import Certificate as Certificate
from dalembert.sensitivity.checks.finite_difference import FiniteDifference as FiniteDifference
from dalembert.sensitivity.checks.step_study import StepStudy as StepStudy, step_study as step_study
from dalembert.sensitivity.gradient import sensitivity as sensitivity
from dalembert.sensitivity.methods import Adjoint as Adjoint, Direct as Direct
from dalembert.sensitivity.second_order import hessian_product as hessian_product
from dalembert.sensitivity.structural.eigenvalue_slopes import (
    eigenvalue_slopes as eigenvalue_slopes,
)
from dalembert.symbolic.formulas.expression import Expression as Expression, t as t
from dalembert.symbolic.formulas.functions import (
    absolute as absolute,
    acos as acos,
    asin as asin,
    atan as atan,
    atan2 as atan2,
    cos as cos,
    cosh as cosh,
    exp as exp,
    floor as floor,
    hypot as hypot,
    log as log,
    sign as sign,
    sin as sin,
    sinh as sinh,
    smooth_abs as smooth_abs,
    sqrt as sqrt,
    tan as tan,
    tanh as tanh,
    where as where,
)
from dalembert.symbolic.formulas.inputs import Input as Input
from dalembert.symbolic.formulas.interpolation import Interpolation as Interpolation
from dalembert.symbolic.formulas.parameter import Parameter as Parameter
from dalembert.symbolic.native.code_cache import clear_cache as clear_cache

__version__: str
