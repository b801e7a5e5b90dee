"""Registry of optimisation methods by name."""

from __future__ import annotations

from dalembert.design.methods.base import Optimizer
from dalembert.design.methods.branch_and_bound import BranchAndBound
from dalembert.design.methods.cma_es import CMAES
from dalembert.design.methods.differential_evolution import DifferentialEvolution
from dalembert.design.methods.enumeration import Enumeration
from dalembert.design.methods.ipopt import Ipopt
from dalembert.design.methods.least_squares import LeastSquares
from dalembert.design.methods.moving_asymptotes import MMA
from dalembert.design.methods.multistart import Multistart
from dalembert.design.methods.nlopt_ccsa import CCSAQ
from dalembert.design.methods.slsqp import SLSQP
from dalembert.design.methods.trust_constr import TrustConstr
from dalembert.errors import AnalysisError
from dalembert.text.wording import unknown

OPTIMIZERS: dict[str, type[Optimizer]] = {
    "slsqp": SLSQP,
    "trust-constr": TrustConstr,
    "ipopt": Ipopt,
    "least-squares": LeastSquares,
    "mma": MMA,
    "ccsaq": CCSAQ,
    "differential-evolution": DifferentialEvolution,
    "cma-es": CMAES,
    "multistart": Multistart,
    "branch-and-bound": BranchAndBound,
    "enumeration": Enumeration,
}


def make_optimizer(method: str | Optimizer, discrete: bool) -> Optimizer:
    """Optimiser of a name or object, wrapped in branch and bound if variables are discrete.

    Raises
    ------
    AnalysisError
        The name is unknown.
    """
    if isinstance(method, str):
        if method not in OPTIMIZERS:
            raise AnalysisError(unknown("method", method, OPTIMIZERS))
        method = OPTIMIZERS[method]()
    if not isinstance(method, Optimizer):
        raise AnalysisError(
            f"method is {method!r:.60}; give a name or an object such as da.Ipopt()"
        )
    if discrete and not method.is_global and not isinstance(method, BranchAndBound):
        return BranchAndBound(method)
    return method
