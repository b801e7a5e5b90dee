"""Time integrators: they see ``ẋ = F(t, x, p)`` and never a mechanism."""

from dalembert.integrators.backward_euler import BackwardEuler, Trapezoidal
from dalembert.integrators.bdf import Bdf
from dalembert.integrators.generalized_alpha import HHT, GeneralizedAlpha
from dalembert.integrators.newmark import Newmark
from dalembert.integrators.radau import Radau
from dalembert.integrators.runge_kutta import (
    RK4,
    AdaptiveRungeKutta,
    DormandPrince,
    DormandPrince853,
    Euler,
    ExplicitRungeKutta,
    Heun,
    RKGill,
)
from dalembert.integrators.sundials import Cvodes, Ida

__all__ = [
    "HHT",
    "RK4",
    "AdaptiveRungeKutta",
    "BackwardEuler",
    "Bdf",
    "Cvodes",
    "DormandPrince",
    "DormandPrince853",
    "Euler",
    "ExplicitRungeKutta",
    "GeneralizedAlpha",
    "Heun",
    "Ida",
    "Newmark",
    "RKGill",
    "Radau",
    "Trapezoidal",
]
