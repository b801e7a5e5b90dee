"""Registry of integrators by name, used by files, tables and comparisons."""

from __future__ import annotations

from dalembert.integrators.automatic import AutomaticIntegrator
from dalembert.integrators.bdf.bdf import BDF
from dalembert.integrators.newmark.family import HHT, GeneralizedAlpha, Newmark
from dalembert.integrators.runge_kutta.explicit import (
    RK4,
    DormandPrince,
    DormandPrince853,
    Euler,
    Heun,
    RKGill,
)
from dalembert.integrators.runge_kutta.implicit import BackwardEuler, Radau, Trapezoidal
from dalembert.integrators.sundials import CVODES, IDA

INTEGRATORS: dict[str, type] = {
    "AutomaticIntegrator": AutomaticIntegrator,
    "Euler": Euler,
    "Heun": Heun,
    "RK4": RK4,
    "RKGill": RKGill,
    "DormandPrince": DormandPrince,
    "DormandPrince853": DormandPrince853,
    "BackwardEuler": BackwardEuler,
    "Trapezoidal": Trapezoidal,
    "Newmark": Newmark,
    "HHT": HHT,
    "GeneralizedAlpha": GeneralizedAlpha,
    "Radau": Radau,
    "BDF": BDF,
    "CVODES": CVODES,
    "IDA": IDA,
}
